#!/usr/bin/env python3
"""Renders a scene with several algorithms for growing times and prints the relMSE against a reference each time.

Every run starts anew with its own time limit, so a line is what a user gets who asks for that time. The measured time
is the renderer's CPU time (user + system, of all threads), which other load on the machine disturbs least, and its wall
time. A run's relMSE includes the reference's own noise. Needs a built dapple and nothing else but Python.

    bench/time_to_error.py build/release/bin/dapple SCENE REFERENCE.exr --resolution 175x250 \
        --algorithm photonmap --algorithm path:maxdepth=100 --times 2 4 8 16
"""

import argparse
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def render(arguments, algorithm, seconds, image):
    """CPU and wall seconds of one run."""
    name, _, definitions = algorithm.partition(":")
    command = [arguments.dapple, "render", arguments.scene, "-o", str(image), "--quiet", "--integrator", name,
               "--time", f"{seconds}s", "--layers", "beauty"]
    for definition in filter(None, definitions.split(",")):
        command += ["-D", definition]
    for option in ("resolution", "threads"):
        if getattr(arguments, option):
            command += [f"--{option}", str(getattr(arguments, option))]
    if arguments.pbrt_coats:
        command.append("--pbrt-coats")
    cpu, wall = cpu_seconds(), time.monotonic()
    subprocess.run(command, check=True)
    return cpu_seconds() - cpu, time.monotonic() - wall


def relative_error(arguments, image):
    command = [arguments.dapple, "compare", str(image), arguments.reference]
    if arguments.clamp:
        command += ["--clamp", str(arguments.clamp)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    found = re.search(r"relMSE\D*?([0-9.]+(?:e[+-]?\d+)?)", text)
    if not found:
        sys.exit(f"no relMSE in what dapple compare printed:\n{text}")
    return float(found.group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dapple")
    parser.add_argument("scene")
    parser.add_argument("reference")
    parser.add_argument("--algorithm", action="append", required=True, help="NAME or NAME:key=value,key=value")
    parser.add_argument("--times", type=float, nargs="+", default=[2, 4, 8], help="render times [s]")
    parser.add_argument("--target", type=float, default=0.01, help="stop an algorithm once its relMSE is below this")
    parser.add_argument("--clamp", type=float, help="compare after limiting both images to this value")
    parser.add_argument("--resolution")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--pbrt-coats", action="store_true", help="rough coats with pbrt's weights, as its references")
    arguments = parser.parse_args()
    print("algorithm                      render s    CPU s   wall s    relMSE")
    with tempfile.TemporaryDirectory() as folder:
        for algorithm in arguments.algorithm:
            for seconds in arguments.times:
                image = pathlib.Path(folder) / "image.exr"
                cpu, wall = render(arguments, algorithm, seconds, image)
                error = relative_error(arguments, image)
                print(f"{algorithm:30} {seconds:8g} {cpu:8.2f} {wall:8.2f} {error:9.4f}", flush=True)
                if error < arguments.target:
                    break


if __name__ == "__main__":
    main()
