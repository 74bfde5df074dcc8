"""A wrong command line, or a file that it names, ends a command of the Python side with exit code 2 (docs/command_line.md), and whatever
lies where it was to write stays."""

import contextlib
import importlib
import io
import os
import tempfile
import unittest
from pathlib import Path

import made_run
from run_log import REPOSITORY

SCENARIO = REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml"
STUDY = REPOSITORY / "config" / "campaigns" / "load_and_boom.yaml"


class ExitCodesTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(temporary.name)
        self.folder = Path(temporary.name)
        made_run.write_log(self.folder / "run.lcmlog", made_run.messages())
        Path("none.lcmlog").write_text("no log")
        Path("file").write_text("mine")
        Path("precious.lcmlog").mkdir()
        Path("precious.lcmlog", "thesis.txt").write_text("mine")

    def refused(self, program, *words):
        """What it said."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            try:
                code = importlib.import_module(program).main([str(word) for word in words])
            except SystemExit as ended:
                code = ended.code
        self.assertEqual(code, 2, said.getvalue())
        return said.getvalue()

    def test_a_log_that_is_not_there_or_is_none(self):
        for log, said in (("nowhere", "there is no such folder or log"), ("none.lcmlog", "holds no message that slewlab can read")):
            for program, more in (("report", ()), ("export", ("--format", "csv")), ("export", ("--format", "mcap")), ("desk_command", ())):
                with self.subTest(log=log, program=program):
                    self.assertIn(said, self.refused(program, log, *more))
        self.assertIn("no log and no folder of that name", self.refused("desk_command", "nowhere", "--follow"))
        self.assertIn("no log and no folder of that name", self.refused("bridge", "nowhere", "--foxglove"))

    def test_a_name_that_cannot_be_written(self):
        run, folder = "run.lcmlog", "precious.lcmlog"
        is_folder, is_file = "which is a folder, expected the name of a file to write", "which is a file, expected the name of a folder"
        for program, words, said in (("report", (run, "--out", folder), is_folder), ("report", (run, "--out", "new/"), is_folder),
                                     ("report", (run, "--out", "file/page.html"), "file is a file"),
                                     ("report", (run, "--out", "file"), "no earlier page"),
                                     ("export", (run, "--format", "mcap", "--out", folder), is_folder),
                                     ("export", (run, "--format", "mcap", "--out", "new/"), is_folder),
                                     ("export", (run, "--format", "mcap", "--out", "file"), "no earlier export"),
                                     ("export", (run, "--format", "csv", "--out", "file"), is_file),
                                     ("export", (run, "--format", "csv", "--out", folder), "no earlier export"),
                                     ("import_data", ("file", "--map", "file", "--out", folder), is_folder),
                                     ("campaign_command", (STUDY, "--out", "file"), is_file),
                                     ("desk_command", (SCENARIO, "--out", "file/desk"), "file is a file")):
            with self.subTest(program=program, words=words):
                self.assertIn(said, self.refused(program, *words))
        self.assertEqual(Path("file").read_text(), "mine")
        self.assertEqual(Path(folder, "thesis.txt").read_text(), "mine")
        self.assertEqual({each.name for each in self.folder.iterdir()}, {"run.lcmlog", "none.lcmlog", "file", folder})

    def test_an_earlier_page_and_an_earlier_export_are_written_over(self):
        for program, words in (("report", ("run.lcmlog", "--out", "page", "--quiet")), ("export", ("run.lcmlog", "--format", "mcap", "--out", "mcap"))):
            main = importlib.import_module(program).main
            Path(words[-1] if program == "export" else "page").touch()  # empty, as mktemp makes it
            for _ in range(2):
                with contextlib.redirect_stdout(io.StringIO()):
                    self.assertEqual(main(list(words)), 0)


if __name__ == "__main__":
    unittest.main()
