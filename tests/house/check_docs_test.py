"""That check_docs.py finds paths that are not there, and nothing else."""
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import check_docs


class Paths(unittest.TestCase):
    def test_missing_paths_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "src/dapple/world").mkdir(parents=True)
            (root / "src/dapple/world/compile.cpp").touch()
            page = root / "page.md"
            page.write_text("`world/compile` `src/dapple/ROOM` `src/dapple/world/*.cpp` `other/thing` world/none\n"
                            "`dapple render world/none.pbrt` `src/dapple/word/compile.cpp`\n")
            self.assertEqual(check_docs.path_findings(page, root),
                             ["page.md:2: there is no world/none.pbrt", "page.md:2: there is no src/dapple/word/compile.cpp"])


if __name__ == "__main__":
    unittest.main()
