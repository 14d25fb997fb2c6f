"""check_edges.py must be able to fail: a small house with one fault at a time."""
import importlib.util
import pathlib
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("check_edges", ROOT / "scripts" / "check_edges.py")
check_edges = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(check_edges)


class CheckEdges(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.room("base", "dapple_room(base)")
        self.room("math", "dapple_room(math USES base LIBRARIES Imath::Imath)")
        self.room("film", "dapple_room(film USES base math)")

    def room(self, name, listing):
        folder = self.root / "src" / "dapple" / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "CMakeLists.txt").write_text(listing + "\n")

    def source(self, name, text):
        path = self.root / "src" / "dapple" / name
        path.write_text(text)

    def findings(self):
        return check_edges.check(self.root)

    def test_good_house(self):
        self.source("film/film.h", '#include "dapple/math/vec.h"\n#include "dapple/film/filter.h"\n')
        self.assertEqual(self.findings(), [])

    def test_upward_include(self):
        self.source("math/vec.h", '#pragma once\n\n#include "dapple/film/film.h"\n')
        self.assertEqual(self.findings(), ["src/dapple/math/vec.h:3: math may not include film (dapple/film/film.h)"])

    def test_unlisted_room(self):
        self.source("math/vec.h", '#include "dapple/nowhere/film.h"\n')
        self.assertEqual(self.findings(), ["src/dapple/math/vec.h:1: 'nowhere' is no room"])

    def test_hidden_library(self):
        self.source("film/film.cpp", "#include <tbb/parallel_for.h>\n")
        self.assertEqual(len(self.findings()), 1)
        self.assertIn("hidden in base", self.findings()[0])

    def test_cycle(self):
        self.room("base", "dapple_room(base USES film)")
        self.assertTrue(any("cycle" in finding for finding in self.findings()))

    def test_unknown_edge(self):
        self.room("film", "dapple_room(film USES base maths)")
        self.assertTrue(any("'maths'" in finding for finding in self.findings()))

    def test_command_line_is_checked(self):
        folder = self.root / "apps" / "cli"
        folder.mkdir(parents=True)
        (folder / "CMakeLists.txt").write_text("target_link_libraries(dapple PRIVATE dapple_film)\n")
        (folder / "main.cpp").write_text('#include "dapple/film/film.h"\n#include "dapple/math/vec.h"\n')
        self.assertEqual(self.findings(), ["apps/cli/main.cpp:2: cli may not include math (dapple/math/vec.h)"])


if __name__ == "__main__":
    unittest.main()
