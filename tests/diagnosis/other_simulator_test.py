"""Cranes of another simulator as a PLC's recorder would give them (100 Hz, some begun with the drives on, some without accelerometers),
diagnosed against the thesis's crane without their controller. What is expected is the truth that their README tells.

The records are not part of the project: SLEWLAB_SHARED_DATA names their folder, ../shared/data beside the sources where
it is not set; without them the tests are skipped."""

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

DATA = Path(os.environ.get("SLEWLAB_SHARED_DATA", REPOSITORY.parent / "shared" / "data")) / "other_simulator"
MAPS = REPOSITORY / "tests" / "diagnosis" / "other_simulator"
SLEWLAB = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin" / "slewlab"
SURE = 0.9


class OtherSimulatorTest(unittest.TestCase):
    def setUp(self):
        if not DATA.is_dir():
            self.skipTest(f"the records of the other simulator are not here: {DATA}")
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def diagnosed(self, crane, map_name):
        logs = []
        for record in ("fit_1", "fit_2"):
            logs.append(self.folder / f"{crane}_{record}.lcmlog")
            with contextlib.redirect_stdout(io.StringIO()) as said:
                code = import_data.main(["--map", str(MAPS / map_name), str(DATA / crane / f"{record}.csv"), "--out", str(logs[-1])])
            self.assertEqual(code, 0, said.getvalue())
        out = self.folder / crane
        said = subprocess.run([SLEWLAB, "diagnose", "--crane", REPOSITORY / "config" / "cranes" / "thesis.yaml", "--log", *logs, "--out", out],
                              capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads((out / "diagnosis.json").read_text())

    def test_nothing_is_missing_where_nothing_is(self):
        for crane, map_name in (("a", "four.yaml"), ("b", "encoders.yaml")):
            with self.subTest(crane=crane):
                found = self.diagnosed(crane, map_name)
                self.assertFalse(found["gap"], found["verdict"])
                self.assertEqual(found["causes"][0]["effects"], [])

    def test_viscous_friction_of_the_bearing_is_named_with_its_size(self):
        found = self.diagnosed("c", "tip.yaml")
        first = found["causes"][0]
        self.assertEqual(first["effects"], ["bearing_viscous"], found["verdict"])
        self.assertGreater(first["probability"], SURE)
        self.assertTrue(first["validation"]["holds"])
        size = first["sizes"][0]
        self.assertLess(size["low_90"], 4e6)  # the README's 4e6 Nms/rad
        self.assertGreater(size["high_90"], 4e6)

    def test_a_torque_that_lags_is_named_beside_a_heavier_load(self):
        found = self.diagnosed("d", "four.yaml")
        first = found["causes"][0]
        self.assertIn("torque_lag", first["effects"], found["verdict"])
        self.assertGreater(found["effects"]["torque_lag"], SURE)
        self.assertTrue(any(cause["effects"] == ["torque_lag", "load_mass"] or cause["effects"] == ["load_mass", "torque_lag"]
                            for cause in found["causes"][:2]), found["verdict"])
        self.assertTrue(first["validation"]["holds"])


if __name__ == "__main__":
    unittest.main()
