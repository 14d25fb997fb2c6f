#!/usr/bin/env python3
"""How well `--time` holds: whole commands, from their start to their end, by the wall clock.

Prints a Markdown table: a line for each scene, a column for each algorithm, with the seconds that the command took;
those outside of 5 % in bold. Media that an algorithm does not render are left out with "-". Other load on the machine
shows: run it when nothing else does.

    bench/time_limit.py build/release/bin/dapple --time 5 ../shared/scenes/*/*v4.pbrt
"""

import argparse
import pathlib
import subprocess
import tempfile
import time

ALGORITHMS = ("path", "lightpath", "photonmap", "irradiancecache", "photonsplat", "sppm", "bdpt", "vcm")
TOLERANCE = 0.05


def seconds_of(dapple, scene, algorithm, limit):
    """Wall seconds of a render; None when it fails (what it says is printed by then)."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.monotonic()
        done = subprocess.run([dapple, "render", scene, "-o", f"{folder}/image.exr", "--integrator", algorithm,
                               "--time", f"{limit}s", "--progress", "none"], capture_output=True, text=True)
        seconds = time.monotonic() - start
    return seconds if done.returncode == 0 else None


def name_of(scene):
    path = pathlib.Path(scene)
    return path.stem if path.stem != "scene-v4" else path.parent.parent.name


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dapple")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--time", type=float, default=5.0, help="seconds for each command (default 5)")
    parser.add_argument("--algorithm", action="append", help="NAME; may be given again (default: all)")
    arguments = parser.parse_args()
    algorithms = arguments.algorithm or ALGORITHMS
    print(f"| {arguments.time:g} s | " + " | ".join(algorithms) + " |")
    print("| --- |" + " --- |" * len(algorithms))
    errors = []
    for scene in arguments.scenes:
        cells = []
        for algorithm in algorithms:
            seconds = seconds_of(arguments.dapple, scene, algorithm, arguments.time)
            if seconds is None:
                cells.append("-")
                continue
            error = seconds / arguments.time - 1
            errors.append(abs(error))
            cells.append(f"{seconds:.2f}" if abs(error) <= TOLERANCE else f"**{seconds:.2f}**")
        print(f"| {name_of(scene)} | " + " | ".join(cells) + " |", flush=True)
    outside = sum(error > TOLERANCE for error in errors)
    print(f"\n{outside} of {len(errors)} commands outside of {100 * TOLERANCE:g} %; the farthest {100 * max(errors):.1f} %.")


if __name__ == "__main__":
    main()
