#!/usr/bin/env python3
"""Runs the commands in the documentation, so that what people copy works.

    scripts/check_docs.py DAPPLE_PROGRAM [FILE.md ...]

In a Markdown file, a block that opens with ```sh and is preceded by the comment <!-- tested --> is run by bash, line by
line as written, in a temporary folder where `dapple` is on the path and `scenes` is the project's folder. All blocks of
one file share the folder. A block preceded by <!-- tested: fails N --> must end with exit status N. Paths in backquotes
must exist, from the project's folder or from src/dapple; `world/compile` is any file that begins so, and words in CAPITALS
stand for anything. Without files: README, CONTRIBUTING and all of docs, and docs/integrators.md must be what `dapple
integrators --markdown` prints.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"<!-- tested(?:: fails (\d+))? -->\s*```sh\n(.*?)```", re.DOTALL)
QUOTED = re.compile(r"`([^`\n]+)`")
PATH = re.compile(r"[\w.*-]+(/[\w.*-]+)+/?")
PLACEHOLDER = re.compile(r"[A-Z]{2,}")
SECONDS = 240


def run_file(path, program, root):
    """Number of blocks run, and the findings."""
    findings = []
    text = path.read_text()
    blocks = list(BLOCK.finditer(text))
    with tempfile.TemporaryDirectory(prefix="dapple-docs-") as folder:
        os.symlink(root / "scenes", pathlib.Path(folder) / "scenes")
        environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}")
        for block in blocks:
            expected = int(block.group(1) or 0)
            line = text.count("\n", 0, block.start()) + 1
            result = subprocess.run(["bash", "-euo", "pipefail", "-c", block.group(2)], cwd=folder, env=environment,
                                    capture_output=True, text=True, timeout=SECONDS, stdin=subprocess.DEVNULL)
            if result.returncode != expected:
                findings.append(f"{path.relative_to(root)}:{line}: exit status {result.returncode}, not {expected}\n"
                                f"{block.group(2)}{result.stdout}{result.stderr}")
    return len(blocks), findings


def path_findings(path, root):
    """Paths in backquotes that are not there. Those of no folder of ours are somebody else's."""
    findings = []
    bases = [root, root / "src" / "dapple"]
    ours = {folder.name for base in bases for folder in base.iterdir() if folder.is_dir()} - {"build", "out"}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        for word in (word for quoted in QUOTED.findall(line) for word in quoted.split()):
            parts = word.rstrip("/").split("/")
            if not PATH.fullmatch(word) or parts[0] not in ours:
                continue
            pattern = "/".join("*" if PLACEHOLDER.fullmatch(part) else part for part in parts)
            if not any(next(base.glob(pattern + "*"), None) for base in bases):
                findings.append(f"{path.relative_to(root)}:{number}: there is no {word}")
    return findings


def generated_findings(program, root):
    path = root / "docs" / "integrators.md"
    printed = subprocess.run([program, "integrators", "--markdown"], capture_output=True, text=True, check=True).stdout
    if path.exists() and path.read_text() == printed:
        return []
    return ["docs/integrators.md is out of date: dapple integrators --markdown > docs/integrators.md"]


def main():
    if len(sys.argv) < 2:
        print(__doc__)
        return 2
    root = pathlib.Path(__file__).resolve().parent.parent
    program = pathlib.Path(sys.argv[1]).resolve()
    files = [pathlib.Path(name).resolve() for name in sys.argv[2:]]
    files = files or [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
    count, findings = 0, generated_findings(program, root) if len(sys.argv) == 2 else []
    for path in files:
        blocks, found = run_file(path, program, root)
        count += blocks
        findings += found + path_findings(path, root)
    for finding in findings:
        print(finding)
    print(f"{count} blocks of commands run, {len(findings)} findings")
    return 1 if findings or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
