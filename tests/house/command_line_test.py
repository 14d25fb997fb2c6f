"""The command line as people and programs meet it: exit statuses, one-line errors, progress, Ctrl-C, crop, files."""
import concurrent.futures
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
SCENE = str(pathlib.Path(__file__).resolve().parent / "ball.pbrt")


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.waiting = []
        self.helpers = concurrent.futures.ThreadPoolExecutor(os.cpu_count())
        self.addCleanup(self.helpers.shutdown)

    def dapple(self, *arguments, status=0):
        result = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                                stdin=subprocess.DEVNULL, timeout=120)
        self.assertEqual(result.returncode, status, f"{arguments}: {result.stdout}{result.stderr}")
        return result

    def header(self, name, attribute):
        listing = subprocess.run(["oiiotool", "--info", "-v", self.folder / name], capture_output=True, text=True).stdout
        for line in listing.splitlines():
            key, _, value = line.strip().partition(": ")
            if key == attribute:
                return value.strip('"')
        return None

    def bad_input(self, *arguments, saying):
        self.waiting.append(self.helpers.submit(self.check_bad_input, *arguments, saying=saying))

    def check_bad_input(self, *arguments, saying):
        result = self.dapple(*arguments, status=2)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("dapple: error: "), lines[0])
        self.assertIn(saying, lines[0])

    def test_bad_input_is_one_line_and_status_2(self):
        self.bad_input(saying="a command is missing: render, ")
        self.bad_input("rendr", SCENE, saying="did you mean 'render'")
        self.bad_input("render", saying="scene")
        self.bad_input("render", "missing.pbrt", saying="missing.pbrt")
        self.bad_input("render", self.folder, saying="")
        self.bad_input("render", SCENE, "--integrator", "pathh", saying="did you mean 'path'")
        self.bad_input("render", SCENE, "-i", "path", "-D", "maxdeth=3", saying="did you mean 'maxdepth'")
        self.bad_input("render", SCENE, "-i", "path", "-D", "maxdepth=many", saying="maxdepth")
        self.bad_input("render", SCENE, "-D", "maxdepth", saying="name=value")
        self.bad_input("render", SCENE, "-o", "a.jpeg", saying="a.jpeg")
        self.bad_input("render", SCENE, "-o", "missing/a.exr", saying="missing")
        self.bad_input("render", SCENE, "--time", "soon", saying="--time")
        self.bad_input("render", SCENE, "--passes", "0", saying="--passes")
        self.bad_input("render", SCENE, "--passes", "-3", saying="passes")
        self.bad_input("render", SCENE, "--crop", "0.5,0.5,0,1", saying="--crop")
        self.bad_input("render", SCENE, "--resolution", "0x4", saying="--resolution")
        self.bad_input("render", SCENE, "--memory", "1k", saying="--memory")
        self.bad_input("render", SCENE, "--threads", "0", saying="--threads")
        self.bad_input("render", SCENE, "--layers", "beuty", saying="did you mean 'beauty'")
        self.bad_input("render", SCENE, "--color-model", "cmyk", saying="color-model")
        self.bad_input("render", SCENE, "--progress", "loud", saying="progress")
        self.bad_input("render", SCENE, "--no-such-option", saying="no-such-option")
        self.bad_input("inspect", "missing.pbrt", saying="missing.pbrt")
        self.bad_input("compare", "a.exr", "b.exr", saying="a.exr")
        self.bad_input("integrators", "pathh", saying="did you mean 'path'")
        for result in self.waiting:
            result.result()
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_errors_say_what_is_allowed(self):
        render = ("render", SCENE, "-o", "a.exr")
        for arguments, line in (
                ((*render, "--passes", "1.5"), "--passes takes a whole number from 1 to 1000000000, not '1.5'"),
                ((*render, "--threads", "0"), "--threads takes a whole number from 1 to 4096, not '0'"),
                ((*render, "--error", "abc"), "--error takes a number from 0.000001 to 1, not 'abc'"),
                ((*render, "--seed", "-1"), "--seed takes a whole number of 0 or more (64 bits), not '-1'"),
                ((*render, "--seed", "18446744073709551616"),
                 "--seed takes a whole number of 0 or more (64 bits), not '18446744073709551616'"),
                ((*render, "--time", ""), "--time takes a duration such as 60s, 5m or 1h30m, not ''"),
                ((*render, "--memory", "8X"), "--memory takes a size such as 512M or 8G, not '8X'"),
                ((*render, "--resolution", "65537x1"),
                 "--resolution takes WIDTHxHEIGHT such as 640x480, each from 1 to 65536, not '65537x1'"),
                ((*render, "--crop", "nonsense"),
                 "--crop takes x0,x1,y0,y1 with x0 < x1 and y0 < y1, as parts of the image such as 0.25,0.75,0,1 or as "
                 "pixels, not 'nonsense'"),
                ((*render, "--color-model", "RGB"),
                 "--color-model takes rgb or spectral, not 'RGB'; did you mean 'rgb'?"),
                ((*render, "--layers", "caustics"),
                 "--layers takes words of all,beauty,guides,classes,groups,photons,error, not 'caustics'; 'classes' has "
                 "the layer 'caustic'"),
                ((*render, "-o", "b.jpg"),
                 "cannot write image 'b.jpg': an image ends in .exr (linear, all layers), .png (8-bit sRGB), .hdr or "
                 ".pfm (linear), or in .dapple (the render itself, for dapple resume and dapple merge); others are "
                 "made of a .png: 'oiiotool b.png -o b.jpg'"),
                (("compare", "a.exr", "b.exr", "-o", "c.tif"),
                 "cannot write image 'c.tif': an image ends in .exr (linear, all layers), .png (8-bit sRGB), .hdr or "
                 ".pfm (linear); others are made of a .png: 'oiiotool c.png -o c.tif'"),
                ((*render, "--checkpoint", "a.exr"),
                 "--checkpoint takes a file that ends in .dapple, or none, not 'a.exr'"),
                ((*render, "-i", "path", "-D", "radiustest=true"),
                 "path has no setting 'radiustest'; it is a setting of sppm ('dapple integrators path' lists its own)"),
                ((*render, "-i", "sppm", "-D", "fixedradius=0"),
                 "setting 'fixedradius' takes a number above 0 or auto, not '0'"),
                ((*render, "--passses", "4"),
                 "dapple render has no option '--passses'; did you mean '--passes'? (dapple render --help shows how)"),
                ((*render, "b.pbrt"),
                 "'b.pbrt' is one argument too many for dapple render (dapple render --help shows how)"),
                ((*render, "--passes"), "--passes takes a value: number of passes (dapple render --help shows how)"),
                ((*render, "--passes", "1", "--passes", "2"),
                 "--passes is given more than once (dapple render --help shows how)"),
                ((*render, "--quiet=loud"), "--quiet takes no value (dapple render --help shows how)"),
                (("compare", "a.exr", "b.exr", "--clamp", "-1"), "--clamp takes a number above 0, not '-1'"),
                (("inspect",), "dapple inspect needs scene: a pbrt-v4 scene file (dapple inspect --help shows how)"),
                (("rendr",), "unknown command 'rendr'; did you mean 'render'? (dapple --help shows how)"),
                (("scene.pbrt",), "a command is missing: dapple render scene.pbrt")):
            self.assertEqual(self.dapple(*arguments, status=2).stderr, f"dapple: error: {line}\n")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_help_teaches(self):
        for command in ((), "render", "resume", "merge", "inspect", "compare", "doctor", "integrators"):
            self.assertIn("Examples:\n  dapple ", self.dapple(*([command] if command else []), "--help").stdout)
        self.assertRegex(self.dapple("--version").stdout, r"^dapple \d+\.\d+\.\d+ \(commit ")

    def test_scene_defaults(self):
        self.dapple("render", SCENE, "--quiet")
        self.assertEqual(self.header("ball.exr", "dapple:passes"), "4")
        self.assertEqual(self.header("ball.exr", "dapple:integrator"), "path")

    def test_a_first_pass_that_is_cut_says_what_helps(self):
        errors = self.dapple("render", SCENE, "-i", "photonmap", "--time", "1ms", "-o", "a.exr", "--resolution",
                             "800x600").stderr
        self.assertRegex(errors, "the first pass was cut short at .*; what helps: a longer --time, or a smaller "
                                 "--resolution, -D photons\n")

    def test_every_scene_of_ours_renders(self):
        scenes = sorted((pathlib.Path(__file__).resolve().parents[2] / "scenes").glob("*.pbrt"))
        self.assertGreater(len(scenes), 10)
        for scene in scenes:
            self.dapple("render", scene, "--quiet", "-i", "path", "--resolution", "4x4", "--passes", 1, "-o", "a.exr")

    def test_quiet_says_nothing(self):
        result = self.dapple("render", SCENE, "--quiet", "--passes", 1, "-o", "a.png")
        self.assertEqual(result.stdout + result.stderr, "")

    def test_header_tells_how(self):
        self.dapple("render", SCENE, "--quiet", "--passes", 2, "--seed", 9, "-o", "a.exr")
        self.assertEqual(self.header("a.exr", "dapple:seed"), "9")
        self.assertEqual(self.header("a.exr", "dapple:passes"), "2")
        self.assertEqual(self.header("a.exr", "dapple:end"), "all passes done")
        self.assertIn("--seed 9", self.header("a.exr", "dapple:command"))
        self.assertIsNone(self.header("a.exr", "dapple:incomplete"))

    def test_layers_have_the_names_that_programs_expect(self):
        self.dapple("render", SCENE, "--quiet", "--passes", 1, "-o", "all.exr")
        channels = self.header("all.exr", "channel list")
        for name in ("R", "Albedo.R", "N.X", "Z", "direct.R", "caustic.B", "indirect.G"):
            self.assertIn(name, channels.replace(",", "").split())
        self.dapple("render", SCENE, "--quiet", "--passes", 1, "-o", "beauty.exr", "--layers", "beauty")
        self.assertEqual(self.header("beauty.exr", "channel list"), "R, G, B")

    def test_crop_is_a_part_of_the_whole(self):
        self.dapple("render", SCENE, "--quiet", "--passes", 2, "-o", "whole.exr", "--layers", "beauty")
        self.dapple("render", SCENE, "--quiet", "--passes", 2, "-o", "part.exr", "--layers", "beauty", "--crop", "8,24,4,20")
        subprocess.run(["oiiotool", "whole.exr", "--cut", "16x16+8+4", "-o", "cut.exr"], cwd=self.folder, check=True)
        subprocess.run(["oiiotool", "part.exr", "--origin", "+0+0", "--fullpixels", "-o", "part0.exr"], cwd=self.folder,
                       check=True)
        self.dapple("compare", "cut.exr", "part0.exr", "--exact")

    def test_json_progress_is_json(self):
        result = self.dapple("render", SCENE, "--time", "1s", "--progress", "json", "-o", "a.png", "--resolution", "64x48")
        events = [json.loads(line) for line in result.stdout.splitlines()]
        kinds = [event["event"] for event in events]
        self.assertEqual((kinds[0], kinds[-2], kinds[-1]), ("begin", "end", "written"))
        self.assertIn("progress", kinds)
        self.assertTrue(all(event["percent"] < 100 for event in events if event["event"] == "progress"))

    def test_time_is_kept(self):
        # Of the whole command, and where a pass takes longer.
        for options in (("-i", "path", "--resolution", "64x48"), ("-i", "vcm", "--resolution", "2000x1500"),
                        ("-i", "photonsplat", "--resolution", "1200x900")):
            with self.subTest(options=options):
                start = time.monotonic()
                self.dapple("render", SCENE, "--time", "4s", "-o", "a.exr", "--layers", "beauty", *options)
                self.assertAlmostEqual(time.monotonic() - start, 4, delta=0.4)  # 5 %, and others beside us

    def signalled(self, signals, *options):
        """Exit status and errors of a render that gets SIGINT so many times after 1.5 s."""
        render = subprocess.Popen([PROGRAM, "render", SCENE, "-o", "a.exr", "--progress", "none", *options], cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
        time.sleep(1.5)
        for _ in range(signals):
            os.kill(render.pid, signal.SIGINT)
            time.sleep(0.05)
        _, errors = render.communicate(timeout=60)
        return render.returncode, errors

    def test_interrupt_while_loading_ends_at_once_and_says_so(self):
        (self.folder / "long.pbrt").write_text('WorldBegin\n' + 'Shape "sphere"\n' * 1000000)
        render = subprocess.Popen([PROGRAM, "render", "long.pbrt", "-o", "a.exr"], cwd=self.folder,
                                  stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
        status = pathlib.Path(f"/proc/{render.pid}/status")
        while not int(status.read_text().split("SigCgt:")[1].split()[0], 16) & 1 << (signal.SIGINT - 1):
            time.sleep(0.001)
        render.send_signal(signal.SIGINT)
        _, errors = render.communicate(timeout=5)
        self.assertEqual(errors, "dapple: error: interrupted while loading the scene: nothing is written\n")
        self.assertEqual(render.returncode, -signal.SIGINT)  # 130 in a shell
        self.assertFalse((self.folder / "a.exr").exists())

    def test_first_interrupt_finishes_the_pass(self):
        status, errors = self.signalled(1, "--passes", "1000000")
        self.assertEqual(status, 0, errors)
        self.assertEqual(self.header("a.exr", "dapple:end"), "stopped by request")
        self.assertGreater(int(self.header("a.exr", "dapple:passes")), 0)

    def test_second_interrupt_still_writes(self):
        for integrator in ("path", "vcm"):
            with self.subTest(integrator=integrator):
                status, errors = self.signalled(2, "-i", integrator, "--passes", "5", "--resolution", "3000x3000",
                                                "--layers", "beauty")
                passes = int(self.header("a.exr", "dapple:passes"))
                self.assertEqual(status, 130 if passes == 0 else 0, errors)
                self.assertEqual(self.header("a.exr", "dapple:incomplete") is not None, passes == 0)
                self.assertEqual("the first pass was cut short" in errors, passes == 0)

    def test_second_interrupt_before_anything_is_there_keeps_an_older_picture(self):
        (self.folder / "a.exr").write_bytes(b"older")
        status, errors = self.signalled(2, "-i", "sppm", "--passes", "1", "--resolution", "4000x4000", "--layers", "beauty")
        self.assertEqual(status, 130, errors)
        self.assertIn("stopped before there was anything to show: nothing is written", errors)
        self.assertEqual((self.folder / "a.exr").read_bytes(), b"older")

    def test_compare_has_an_exit_status(self):
        self.dapple("render", SCENE, "--quiet", "--passes", 1, "-o", "one.exr", "--seed", 1)
        self.dapple("render", SCENE, "--quiet", "--passes", 1, "-o", "two.exr", "--seed", 2)
        self.dapple("compare", "one.exr", "one.exr", "--exact", "--mean-within", 0)
        self.dapple("compare", "one.exr", "two.exr", "--mean-within", 50, "--diff", "diff.png")
        self.assertTrue((self.folder / "diff.png").exists())
        self.dapple("compare", "one.exr", "two.exr", "--exact", status=1)
        self.dapple("compare", "one.exr", "two.exr", "--mean-within", 0, status=1)
        self.dapple("compare", "one.exr", "two.exr", "--relmse-within", 0, status=1)

    def test_inspect_tells_lights_and_shares(self):
        text = self.dapple("inspect", SCENE).stdout
        self.assertIn("area light on sphere", text)
        self.assertIn("group lamp", text)
        self.assertIn("% of photons", text)
        self.assertIn("warnings      none", text)

    def test_inspect_tells_memory_and_what_suits(self):
        scenes = pathlib.Path(__file__).resolve().parents[2] / "scenes"
        for scene, suits in (("glass-caustic", r"suits +photonmap, .*vcm: \d+ % of the light is caustics"),
                             ("fog", r"suits +path, lightpath, bdpt, vcm: media scatter"),
                             ("shapes", r"suits +path: no caustics")):
            self.assertRegex(self.dapple("inspect", scenes / (scene + ".pbrt")).stdout, suits)
        for integrator, memory in (("path", r"film [\d.]+ MiB\n  --memory must be above [\d.]+ MiB\n"), ("photonmap", r", about [\d.]+ MiB for photon maps\n"),
                                   ("sppm", r", about [\d.]+ MiB for photon maps\n"),
                                   ("vcm", r", about [\d.]+ MiB for light paths\n"),
                                   ("photonsplat", r", kept for each pixel [\d.]+ MiB\n")):
            self.assertRegex(self.dapple("inspect", scenes / "glass-caustic.pbrt", "-i", integrator).stdout, memory)

    def test_memory_is_one_account(self):
        text = self.dapple("inspect", SCENE, "-i", "photonmap").stdout
        above = float(re.search(r"\n  --memory must be above ([\d.]+) MiB; what is above is for photon maps\n", text)[1])
        render = ("render", SCENE, "-i", "photonmap", "--passes", 1, "-o", "a.exr", "--quiet", "--memory")
        self.dapple(*render, f"{above + 0.1}M")
        self.dapple(*render, f"{above - 0.1}M", status=2)

    def test_what_a_scene_lacks_is_said(self):
        (self.folder / "black.pbrt").write_text("""Film "rgb" "integer xresolution" 8 "integer yresolution" 8
            WorldBegin
            Texture "wood" "spectrum" "imagemap" "string filename" "Wood.png"
            Material "diffuse" "texture reflectance" "wood"
            Shape "sphere" """)
        (self.folder / "wood.jpg").write_text("")
        missing = "black.pbrt:3:13: cannot read image 'Wood.png': no such file; there is 'wood.jpg'; it is shown magenta"
        dark = "the scene has no lights: the image will be black"
        text = self.dapple("inspect", "black.pbrt").stdout
        self.assertIn(f"warning       {missing}\nwarning       {dark}\n", text)
        lines = self.dapple("render", "black.pbrt", "--passes", 1, "-o", "a.exr").stderr.splitlines()
        self.assertEqual(lines[:2], [f"warning: {missing}", f"warning: {dark}"])
        self.assertEqual(lines[-1], "warning: 1 texture file could not be read and is magenta in this image: Wood.png")

    def test_inspect_heeds_caustics_by_how_much_light_they_are(self):
        for radius, light, suits in ((0.2, "0 0 3", "path: no caustics"),
                                     (1.0, "0 0 2", r"photonmap, .*vcm: [67]\.\d % of the light is caustics"),
                                     (1.0, "0 0 0", r"photonmap, .*vcm: 100 % of the light is caustics")):
            (self.folder / "bead.pbrt").write_text(f"""Film "rgb" "integer xresolution" 8 "integer yresolution" 8
                WorldBegin
                LightSource "point" "point3 from" [{light}]
                Shape "sphere" "float radius" 9
                Material "dielectric"
                Shape "sphere" "float radius" {radius}""")
            self.assertRegex(self.dapple("inspect", "bead.pbrt").stdout, "suits +" + suits)

    def test_doctor_finds_all_well(self):
        self.assertIn("All is well.", self.dapple("doctor").stdout)


if __name__ == "__main__":
    unittest.main()
