"""Every cell of every notebook runs, in its order; a notebook's own assertions say what it has to find."""

import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, os.environ["SLEWLAB_PYTHON_MESSAGES"])
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


class NotebooksTest(unittest.TestCase):
    def test_there_are_five(self):
        self.assertEqual(len(NOTEBOOKS), 5)

    def test_cells_run_and_hold_no_output(self):
        for path in NOTEBOOKS:
            notebook = json.loads(path.read_text(encoding="utf-8"))
            code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
            with self.subTest(notebook=path.name), tempfile.TemporaryDirectory() as folder:
                self.assertEqual([cell["outputs"] for cell in code], [[]] * len(code))
                self.assertTrue(any("assert " in "".join(cell["source"]) for cell in code))
                here = os.getcwd()
                os.chdir(folder)
                try:
                    names = {"print": lambda *words: None}
                    for number, cell in enumerate(code, 1):
                        exec(compile("".join(cell["source"]), f"{path.name}, code cell {number}", "exec"), names)
                finally:
                    os.chdir(here)


if __name__ == "__main__":
    unittest.main()
