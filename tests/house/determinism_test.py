"""Same seed, same bits: every integrator on 1, 2 and 7 threads, and another seed gives other bits."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
SCENE = str(pathlib.Path(__file__).resolve().parent / "ball.pbrt")


def integrators():
    text = subprocess.run([PROGRAM, "integrators"], capture_output=True, text=True, check=True).stdout
    return [line for line in text.splitlines() if line and not line.startswith(" ")]


def render(folder, name, *options):
    out = pathlib.Path(folder) / name
    subprocess.run([PROGRAM, "render", SCENE, "-o", out.with_suffix(".exr"), "-o", out.with_suffix(".pfm"), "--quiet",
                    "--passes", "2", *options], check=True, stdin=subprocess.DEVNULL)
    return out


def same_layers(a, b):
    return subprocess.run([PROGRAM, "compare", a.with_suffix(".exr"), b.with_suffix(".exr"), "--exact"],
                          capture_output=True).returncode == 0


class Determinism(unittest.TestCase):
    def test_threads_leave_no_trace_and_seeds_matter(self):
        names = integrators()
        self.assertIn("path", names)
        for integrator in names:
            for model in ("spectral", "rgb"):
                with self.subTest(integrator=integrator, model=model), tempfile.TemporaryDirectory() as folder:
                    options = ["-i", integrator, "--color-model", model]
                    one = render(folder, "one", "--threads", "1", "--seed", "1", *options)
                    pixels = one.with_suffix(".pfm").read_bytes()
                    for threads in ("2", "7"):
                        other = render(folder, threads, "--threads", threads, "--seed", "1", *options)
                        self.assertEqual(pixels, other.with_suffix(".pfm").read_bytes())
                    self.assertTrue(same_layers(one, other), f"{integrator}: layers differ on {threads} threads")
                    if model == "rgb":
                        two = render(folder, "two", "--seed", "2", *options)
                        self.assertNotEqual(pixels, two.with_suffix(".pfm").read_bytes())


if __name__ == "__main__":
    unittest.main()
