#!/usr/bin/env python3
"""Checks that every room includes only the rooms that its CMakeLists.txt names, and hides its libraries.

    scripts/check_edges.py [SOURCE_FOLDER]

A room is a folder of src/dapple; `dapple_room(NAME USES ... LIBRARIES ...)` in its CMakeLists.txt lists what it may
use. Also checked: the table has no cycle, the libraries that are hidden in one room (Embree, oneTBB, OpenImageIO,
spdlog) are included nowhere else, and the command line includes only the rooms that it links. Exit status 1 when
anything is wrong; each finding is one line.
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)
SOURCES = (".h", ".cpp")
# Library header prefix -> the rooms that may include it. Imath and fmt are part of public headers.
HIDDEN = {
    "embree": {"world"},
    "tbb/": {"base"},
    "oneapi/": {"base"},
    "OpenImageIO/": {"image"},
    "spdlog/": {"base"},
    "zlib.h": {"formats", "image"},
    "CLI/": {"cli"},
}


def room_edges(root):
    """Room name -> set of room names it may use, from the CMakeLists.txt files."""
    edges = {}
    for listing in sorted((root / "src" / "dapple").glob("*/CMakeLists.txt")):
        text = listing.read_text()
        call = re.search(r"dapple_room\(\s*(\w+)([^)]*)\)", text)
        if not call:
            continue
        uses = re.search(r"USES((?:\s+[a-z_]+)*)", call.group(2))
        edges[call.group(1)] = set(uses.group(1).split()) if uses else set()
    return edges


def cycles(edges):
    """Findings for rooms that reach themselves, or name rooms that do not exist."""
    findings = []
    for room, used in edges.items():
        for unknown in sorted(used - edges.keys()):
            findings.append(f"src/dapple/{room}/CMakeLists.txt: uses '{unknown}', which is no room")
    seen = {}

    def visit(room, trail):
        if seen.get(room) == "done":
            return
        if room in trail:
            findings.append("cycle of rooms: " + " -> ".join(trail[trail.index(room):] + [room]))
            return
        for used in sorted(edges.get(room, ())):
            visit(used, trail + [room])
        seen[room] = "done"

    for room in sorted(edges):
        visit(room, [])
    return findings


def include_findings(root, folder, name, allowed, rooms):
    findings = []
    for path in sorted(p for p in folder.rglob("*") if p.suffix in SOURCES):
        text = path.read_text(errors="replace")
        for match in INCLUDE.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            where = f"{path.relative_to(root)}:{line}"
            header = match.group(2)
            if header.startswith("dapple/"):
                room = header.split("/")[1]
                if room not in rooms:
                    findings.append(f"{where}: '{room}' is no room")
                elif room != name and room not in allowed:
                    findings.append(f"{where}: {name} may not include {room} ({header})")
            for prefix, owners in HIDDEN.items():
                if header.startswith(prefix) and name not in owners:
                    findings.append(f"{where}: {header} is hidden in {', '.join(sorted(owners))}")
    return findings


def application_edges(root):
    """Rooms that apps/cli links."""
    listing = root / "apps" / "cli" / "CMakeLists.txt"
    return set(re.findall(r"\bdapple_(\w+)", listing.read_text())) if listing.exists() else set()


def check(root):
    edges = room_edges(root)
    findings = cycles(edges)
    if not edges:
        findings.append(f"{root}: no rooms found")
    for room, allowed in edges.items():
        findings += include_findings(root, root / "src" / "dapple" / room, room, allowed, edges)
    findings += include_findings(root, root / "apps" / "cli", "cli", application_edges(root), edges)
    return findings


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    findings = check(root)
    for finding in findings:
        print(finding)
    if not findings:
        print(f"{len(room_edges(root))} rooms keep to their edges")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
