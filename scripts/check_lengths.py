#!/usr/bin/env python3
"""Checks that source files stay under 400 lines; exceptions, each with its reason, are in length_exceptions.txt.

An exception that is no longer needed is a finding, too. Exit status 1 when there is any.
"""
import pathlib
import subprocess
import sys

LIMIT = 400
SUFFIXES = {".h", ".cpp", ".py", ".cmake"}
FOLDERS = ("src", "apps", "tests", "bench", "scripts", "cmake", "python")


def read_exceptions(path):
    exceptions = {}
    for line in path.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            name, _, reason = line.partition(" ")
            exceptions[name] = reason.strip()
    return exceptions


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    exceptions = read_exceptions(root / "scripts" / "length_exceptions.txt")
    files = subprocess.run(["git", "-C", str(root), "ls-files", *FOLDERS], capture_output=True, text=True, check=True)
    findings = [f"exception without a reason: {name}" for name, reason in exceptions.items() if not reason]
    for name in files.stdout.splitlines():
        path = root / name
        if path.suffix not in SUFFIXES or not path.exists():
            continue
        lines = path.read_text(errors="replace").count("\n")
        if lines > LIMIT and name not in exceptions:
            findings.append(f"{name}: {lines} lines, more than {LIMIT}")
        if lines <= LIMIT and name in exceptions:
            findings.append(f"{name}: {lines} lines, needs no exception any more")
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
