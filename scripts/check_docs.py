#!/usr/bin/env python3
"""Runs the commands in the documentation, so that what people copy works.

    scripts/check_docs.py DAPPLE_PROGRAM [FILE.md ...]

In a Markdown file, a block that opens with ```sh and is preceded by the comment <!-- tested --> is run by bash, line by
line as written, in a temporary folder where `dapple` is on the path and `scenes` is the project's folder. All blocks of
one file share the folder. A block preceded by <!-- tested: fails N --> must end with exit status N. Without files: README,
CONTRIBUTING and all of docs, and docs/integrators.md must be what `dapple integrators --markdown` prints.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"<!-- tested(?:: fails (\d+))? -->\s*```sh\n(.*?)```", re.DOTALL)
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
        findings += found
    for finding in findings:
        print(finding)
    print(f"{count} blocks of commands run, {len(findings)} failed")
    return 1 if findings or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
