"""Records that are not part of the project: SLEWLAB_SHARED_DATA names their folder, ../shared/data beside the sources where it is not
set. Tests skip without them."""

import contextlib
import io
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import import_data
from run_log import REPOSITORY

DATA = Path(os.environ.get("SLEWLAB_SHARED_DATA", REPOSITORY.parent / "shared" / "data"))
SLEWLAB = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin" / "slewlab"


class SharedDataTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def need_data(self):
        if not DATA.is_dir():
            self.skipTest(f"the shared records are not here: {DATA}")

    def quietly(self, main, *arguments):
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertEqual(main([str(a) for a in arguments]), 0, said.getvalue())
        return said.getvalue()

    def imported(self, map_file, machine, record):
        """The log of DATA/machine/record.csv."""
        return self.imported_from(map_file, DATA / machine / f"{record}.csv")

    def imported_from(self, map_file, table):
        log = self.folder / f"{table.parent.name}_{table.stem}.lcmlog"
        self.quietly(import_data.main, "--map", map_file, table, "--out", log)
        return log

    def diagnosed(self, option, file, logs, out, *more):
        """diagnosis.json of these logs against the machine of the file, with more options."""
        said = subprocess.run([SLEWLAB, "diagnose", option, file, "--log", *logs, "--out", out, *more], capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads((out / "diagnosis.json").read_text())
