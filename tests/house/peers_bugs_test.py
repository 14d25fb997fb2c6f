"""Each test that docs/peers-bugs.md names is one that a test program or ctest knows, and stands in the file named.

    peers_bugs_test.py FOLDER_OF_PROGRAMS
"""
import pathlib
import re
import subprocess
import sys
import unittest

PROGRAMS = pathlib.Path(sys.argv.pop())
ROOT = pathlib.Path(__file__).resolve().parents[2]
ROWS = {1, 4, 5, *range(7, 13), 14, 16, 17, 21, 25, 27, 28, 30, 31, 34, 35}


def known_tests():
    """Names without the parts that parameters add (Prefix/Suite.Test/parameter is Suite.Test), and those of this folder."""
    names = set(re.findall(r"NAME (house\.\w+)", (pathlib.Path(__file__).parent / "CMakeLists.txt").read_text()))
    for program in PROGRAMS.glob("test_*"):
        listing = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
        suite = ""
        for line in listing.splitlines():
            word = line.split("#")[0].strip()
            if not line.startswith(" "):
                suite = word.rstrip(".").split("/")[-1]
            elif word:
                names.add(f"{suite}.{word.split('/')[0]}")
    return names


def named_tests(text):
    return re.findall(r"`(\w+\.\w+)`", text)


class PeersBugs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = (ROOT / "docs/peers-bugs.md").read_text()
        cls.known = known_tests()

    def test_each_row_has_tests(self):
        rows = {int(row): line for line, row in re.findall(r"^(\| (\d+) \|.*)$", self.page, re.MULTILINE)}
        self.assertEqual(set(rows), ROWS)
        for row, line in rows.items():
            self.assertTrue(named_tests(line), f"row {row} names no test")

    def test_each_test_exists(self):
        for name in named_tests(self.page):
            self.assertIn(name, self.known)

    def test_each_test_stands_in_the_file_named(self):
        for cell in re.split(r"[|\n]", self.page):
            waiting = []
            for name, path in re.findall(r"`(\w+\.\w+)`|(tests/[\w/]+\.cpp)", cell):
                if name and not name.startswith("house."):
                    waiting.append(name)
                elif path:
                    text = (ROOT / path).read_text()
                    for test in waiting:
                        suite, case = test.split(".")
                        self.assertRegex(text, rf"TEST(_[PF])?\({suite}, {case}\)")
                    waiting = []
            self.assertFalse(waiting, f"no file named for {waiting}")

    def test_a_test_that_does_not_exist_is_noticed(self):
        self.assertNotIn("Environment.IsBlackWithoutObjects", self.known)
        self.assertEqual(named_tests("| 1 | x | `Suite.Test` in a |"), ["Suite.Test"])


if __name__ == "__main__":
    unittest.main()
