"""Checkpoints from the outside: kill at any moment and resume, merge, refusal of what does not belong, full disks, memory.

    resume_test.py PROGRAM [--kills N] [unittest arguments]

N moments of SIGKILL are spread over renders of each integrator (6 unless given; the issue asks for 50).
"""
import array
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
KILLS = 6
if "--kills" in sys.argv:
    at = sys.argv.index("--kills")
    KILLS = int(sys.argv[at + 1])
    del sys.argv[at:at + 2]
SCENE = pathlib.Path(__file__).resolve().parent / "ball.pbrt"
FAST = ("--quiet", "--resolution", "24x18")


def integrators():
    text = subprocess.run([PROGRAM, "integrators"], capture_output=True, text=True, check=True).stdout
    return [line for line in text.splitlines() if line and not line.startswith(" ")]


class Resume(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(SCENE, self.folder / "ball.pbrt")

    def start(self, *arguments, **options):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)

    def dapple(self, *arguments, status=0, **options):
        process = self.start(*arguments, **options)
        out, errors = process.communicate(timeout=240)
        self.assertEqual(process.returncode, status, f"{arguments}: {out}{errors}")
        return errors

    def refused(self, *arguments, saying):
        errors = self.dapple(*arguments, status=2)
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertTrue(errors.startswith("dapple: error: "), errors)
        self.assertIn(saying, errors)

    def same(self, a, b):
        self.dapple("compare", a, b, "--exact")

    def test_killed_at_any_moment_it_ends_with_the_same_bits(self):
        moments = random.Random(7)
        names = integrators()
        total, number = 0, 0
        while total < KILLS:
            integrator = names[number % len(names)]
            passes = 60
            options = ("render", "ball.pbrt", "-i", integrator, "--passes", passes, "--seed", number,
                       "--layers", "all,error", *FAST)
            whole, cut = f"whole{number}.exr", f"cut{number}.exr"
            begin = time.monotonic()
            self.dapple(*options, "-o", whole)
            seconds = time.monotonic() - begin
            checkpoint = f"{number}.dapple"
            process = self.start(*options, "-o", cut, "--checkpoint", checkpoint, "--checkpoint-every", "1ms")
            kills = 0
            while True:
                time.sleep(moments.uniform(0.05, 0.9) * seconds)
                finished = process.poll() is not None
                process.send_signal(signal.SIGKILL)
                process.communicate()
                kills += not finished
                if finished or kills == 3 or total + kills == KILLS:
                    break
                # Before the first checkpoint there is nothing to lose.
                again = ("resume", checkpoint, "--quiet", "--checkpoint-every", "1ms") if (
                    self.folder / checkpoint).exists() else (*options, "-o", cut, "--checkpoint", checkpoint)
                process = self.start(*again)
            with self.subTest(integrator=integrator, kills=kills):
                if (self.folder / checkpoint).exists():
                    self.dapple("resume", checkpoint, "--quiet", "--threads", 1 + number % 3)
                else:
                    self.dapple(*options, "-o", cut)
                self.same(whole, cut)
            total += kills
            number += 1
        print(f"{total} kills in {number} renders", file=sys.stderr)

    def test_it_says_where_it_goes_on(self):
        self.dapple("render", "ball.pbrt", "-o", "a.exr", "--passes", 4, "--checkpoint", "a.dapple", *FAST)
        holds = rf"'{self.folder}/a.dapple' holds 4 passes \(\d+ s\)"
        self.assertRegex(self.dapple("resume", "a.dapple"), holds + ", all that is asked for")
        self.assertRegex(self.dapple("resume", "a.dapple", "--time", "1ms"), holds + ", and --time 0 s counts from the")
        self.assertRegex(self.dapple("resume", "a.dapple", "--passes", 6, "--time", "1h"),
                         holds + "; going on with pass 5 of 6, until 1 h 00 min in all\n")
        self.assertRegex(self.dapple("resume", "a.dapple", "--passes", 3),
                         r"a.dapple' holds 6 passes \(\d+ s\), and --passes 3 counts from the first: the image of these is "
                         "written\n")

    def test_eight_passes_are_eight_merged_passes(self):
        for integrator in integrators():
            options = ("render", "ball.pbrt", "-i", integrator, "--layers", "all,error", *FAST)
            with self.subTest(integrator=integrator):
                self.dapple(*options, "-o", "whole.exr", "--passes", 8)
                # One by one for two; a process takes longer to start than to render, so fewer parts for the others.
                parts, alone = [], [(number, 1) for number in (5, 0, 3, 7, 1, 2, 6, 4)]
                for number, count in alone if integrator in ("path", "photonmap") else [(5, 3), (0, 1), (1, 4)]:
                    parts.append(f"{number}.dapple")
                    self.dapple(*options, "-o", parts[-1], "--passes", count, "--first-pass", number)
                self.dapple("merge", *parts, "-o", "merged.exr", "-o", "merged.dapple")
                self.same("whole.exr", "merged.exr")
                # A merged render is one like any other: it goes on.
                self.dapple(*options, "-o", "ten.exr", "--passes", 10)
                self.dapple("resume", "merged.dapple", "--passes", 10, "-o", "resumed.exr", "--quiet")
                self.same("ten.exr", "resumed.exr")

    def test_numbers_lowered_for_time_stay(self):
        """A limit that is over at once leaves the least of what is automatic; a checkpoint goes on with that."""
        for integrator, least in (("sppm", ("-D", "photons=8192")), ("photonmap", ("-D", "photons=8192")),
                                  ("irradiancecache", ("-D", "photons=8192", "-D", "cacherecords=16"))):
            with self.subTest(integrator=integrator):
                options = ("render", "ball.pbrt", "-i", integrator, *FAST)
                self.dapple(*options, "-o", "short.dapple", "--time", "1ms")
                self.dapple("resume", "short.dapple", "--passes", 6, "-o", "resumed.exr", "--quiet")
                self.dapple(*options, *least, "-o", "whole.exr", "--passes", 6)
                self.same("whole.exr", "resumed.exr")
                self.dapple(*options, "-o", "automatic.dapple", "--passes", 1, "--first-pass", 1)
                self.refused("merge", "short.dapple", "automatic.dapple", "-o", "merged.exr", saying="settings")

    def test_what_does_not_belong_is_refused(self):
        def part(name, *options):
            self.dapple("render", "ball.pbrt", "-i", "path", "-o", name, "--passes", 2, *FAST, *options)
        part("a.dapple")
        part("overlap.dapple", "--first-pass", 1)
        part("seed.dapple", "--first-pass", 2, "--seed", 4)
        part("depth.dapple", "--first-pass", 2, "-D", "maxdepth=3")
        part("apart.dapple", "--first-pass", 5)
        self.refused("merge", "a.dapple", "overlap.dapple", "-o", "x.exr", saying="already there")
        self.refused("merge", "a.dapple", "seed.dapple", "-o", "x.exr", saying="seed 4, not 0")
        self.refused("merge", "a.dapple", "depth.dapple", "-o", "x.exr", saying="maxdepth=3")
        self.refused("merge", "a.dapple", "ball.pbrt", "-o", "x.exr", saying="is no .dapple file")
        self.refused("merge", "a.dapple", "none.dapple", "-o", "x.exr", saying="no such file")
        self.refused("resume", "ball.pbrt", saying="is no .dapple file")
        whole = (self.folder / "a.dapple").read_bytes()
        (self.folder / "cut.dapple").write_bytes(whole[:-100])
        (self.folder / "bad.dapple").write_bytes(whole[:2000] + bytes([whole[2000] ^ 1]) + whole[2001:])
        self.refused("resume", "cut.dapple", saying="cut short or damaged")
        self.refused("resume", "bad.dapple", saying="checksum")
        self.dapple("merge", "a.dapple", "apart.dapple", "-o", "gap.dapple", "--quiet")
        self.refused("resume", "gap.dapple", saying="merge those first")
        # A merged file has the command of its first part, which must not be written over.
        part("next.dapple", "--first-pass", 2)
        self.dapple("merge", "a.dapple", "next.dapple", "-o", "both.dapple", "--quiet")
        self.refused("resume", "both.dapple", "--passes", 5, saying="would overwrite")
        self.assertEqual((self.folder / "a.dapple").read_bytes(), whole)
        self.refused("resume", "a.dapple", "--error", "0.1", saying="no error estimates")
        scene = self.folder / "ball.pbrt"
        text = scene.read_text()
        scene.write_text(text.replace("[20 20 20]", "[21 20 20]"))
        self.refused("resume", "a.dapple", "--passes", "4", saying="another scene")
        part("scene.dapple", "--first-pass", 2)
        self.refused("merge", "a.dapple", "scene.dapple", "-o", "x.exr", saying="another scene")
        self.assertFalse((self.folder / "x.exr").exists())

    def test_a_scene_may_move(self):
        self.dapple("render", "ball.pbrt", "-o", "a.dapple", "--passes", 2, *FAST)
        self.dapple("render", "ball.pbrt", "-o", "whole.exr", "--passes", 4, *FAST)
        (self.folder / "new").mkdir()
        (self.folder / "ball.pbrt").rename(self.folder / "new" / "moved.pbrt")
        self.refused("resume", "a.dapple", saying="ball.pbrt")
        self.dapple("resume", "a.dapple", "--scene", "new/moved.pbrt", "--passes", 4, "-o", "b.exr", "--quiet")
        self.same("whole.exr", "b.exr")

    def test_interrupted_renders_leave_a_checkpoint_when_it_was_asked_for(self):
        process = self.start("render", "ball.pbrt", "-o", "a.exr", "--checkpoint", "c.dapple", "--passes", 1000000,
                             "--progress", "json", *FAST[1:])
        process.stdout.readline()  # it has begun
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.refused("render", "ball.pbrt", "-o", "a.exr", "--checkpoint", "c.dapple", saying="dapple resume")
        before = (self.folder / "a.exr").read_bytes()
        self.dapple("resume", "c.dapple", "--passes", 1, "--quiet", "-o", "again.exr")
        (self.folder / "first.exr").write_bytes(before)
        self.same("first.exr", "again.exr")

    def test_automatic_checkpoints_come_and_go(self):
        options = ("render", "ball.pbrt", "-o", "a.exr", "--checkpoint-every", "100ms", *FAST)
        self.dapple(*options, "--time", "1s")
        self.assertFalse((self.folder / "a.dapple").exists())
        process = self.start(*options, "--passes", 1000000)
        for _ in range(200):
            time.sleep(0.05)
            if (self.folder / "a.dapple").exists():
                break
        process.kill()
        process.communicate()
        self.assertTrue((self.folder / "a.dapple").exists())
        # The next render of the same name does not destroy it.
        self.dapple(*options, "--time", "1s")
        self.assertTrue((self.folder / "a.dapple").exists())
        self.dapple("resume", "a.dapple", "--passes", 1, "--quiet")
        self.assertFalse((self.folder / "a.dapple").exists())

    def test_error_is_reached_and_honest(self):
        self.dapple("render", "ball.pbrt", "-i", "path", "-o", "a.exr", "-o", "a.pfm", "--error", "0.15", "--seed", 1, *FAST)
        self.dapple("render", "ball.pbrt", "-i", "path", "-o", "truth.pfm", "--passes", 4000, "--seed", 2, "--layers",
                    "beauty", *FAST)
        listing = subprocess.run(["oiiotool", "--info", "-v", self.folder / "a.exr"], capture_output=True, text=True).stdout
        noise = float([line.split(": ")[1] for line in listing.splitlines() if "dapple:errorNoise" in line][0])
        self.assertIn("error.noise", listing)
        self.assertLess(noise, 0.15)
        true_error = self.relative_error("a.pfm", "truth.pfm")
        self.assertLess(abs(true_error / noise - 1), 0.35, f"estimated {noise}, true {true_error}")

    def relative_error(self, name, reference):
        """As film/error_sums.h defines it, from the images themselves."""
        def luminance(file):
            values = array.array("f", (self.folder / file).read_bytes().split(b"\n", 3)[3])
            return [(54 * values[i] + 183 * values[i + 1] + 19 * values[i + 2]) / 256 for i in range(0, len(values), 3)]
        a, b = luminance(name), luminance(reference)
        floor = 0.1 * sum(b) / len(b)
        return (sum((x - y) ** 2 / (y * y + floor * floor) for x, y in zip(a, b)) / len(a)) ** 0.5

    def test_error_estimates_know_epochs(self):
        for integrator, epochs in (("path", b"1 0"), ("photonmap", b"4 1"), ("irradiancecache", b"16 1"), ("sppm", b"1 1")):
            self.dapple("render", "ball.pbrt", "-i", integrator, "-o", "a.dapple", "--passes", 1, *FAST)
            self.assertIn(b"correlation\0" + epochs + b"\0", (self.folder / "a.dapple").read_bytes(), integrator)

    def test_full_disk_keeps_the_render_until_there_is_room(self):
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, resource.RLIM_INFINITY))
        process = self.start("render", "ball.pbrt", "-o", "a.exr", "--passes", 2, "--resolution", "64x48", "--progress",
                             "none", preexec_fn=small_files)
        errors = process.stderr.readline()  # that there is no room
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "it waits for room")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["ball.pbrt"])
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        errors += process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn("kept in memory", errors)
        self.dapple("render", "ball.pbrt", "-o", "b.exr", "--passes", 2, "--resolution", "64x48", "--quiet")
        self.same("a.exr", "b.exr")

    def test_vanished_folder_is_survived(self):
        (self.folder / "out").mkdir()
        process = self.start("render", "ball.pbrt", "-o", "out/a.exr", "--time", "2s", "--progress", "json", *FAST[1:])
        process.stdout.readline()  # it has begun
        (self.folder / "out").rmdir()
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(errors, r"(?m)^dapple: error: cannot write image 'out/a.exr'.*; the render was saved as ./dapple-rescue-1.exr$")
        self.assertTrue((self.folder / "dapple-rescue-1.exr").exists())

    def test_memory_is_a_ceiling_for_photons(self):
        ceiling = 256 << 20
        process = self.start("render", "ball.pbrt", "-i", "photonmap", "-D", "photons=100M", "--memory", "256M", "-o", "a.exr",
                             "--passes", 5, "--resolution", "64x48", "--quiet")
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.communicate()
        self.assertEqual(process.returncode, 0)
        peak = usage.ru_maxrss * 1024
        print(f"peak {peak / 2**20:.0f} MiB under --memory 256M", file=sys.stderr)
        self.assertLess(peak, ceiling)
        self.assertGreater(peak, ceiling / 4, "it makes use of what it is given")


if __name__ == "__main__":
    unittest.main()
