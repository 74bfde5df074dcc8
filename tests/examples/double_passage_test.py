"""The double passage of the clearance as a user runs it: half a period apart the shocks cancel, a whole period apart they do not."""

import os
import runpy
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, os.environ["SLEWLAB_PYTHON_MESSAGES"])
import slewlab  # noqa: E402

EXAMPLE = runpy.run_path(str(ROOT / "examples" / "double_passage" / "double_passage.py"))


class DoublePassageTest(unittest.TestCase):
    def test_half_a_period_apart_the_shocks_cancel(self):
        scenario = slewlab.Scenario(slewlab.config("scenarios/double_passage.yaml"))
        self.assertAlmostEqual(1.0 / EXAMPLE["boom_period"](scenario), 1.31, delta=0.02)  # [Hz] thesis Table 4.1
        self.assertEqual(EXAMPLE["turn_of"](scenario), 4.0)
        with tempfile.TemporaryDirectory() as folder:
            found = EXAMPLE["passages"](scenario, folder)
            # Two equal shocks leave 2 |cos(pi T_apart / T)| / 2 of both at once: nothing half a period apart, all of it a whole one apart, but
            # for damping and for what the gears' own mode adds.
            self.assertLess(found["half"], 0.25 * found["together"])
            self.assertGreater(found["whole"], 0.6 * found["together"])
            for name in found:
                log = slewlab.open_log(Path(folder) / name)
                crossings = log.messages("TRUTH")["play_crossings"][-1]
                self.assertTrue((crossings > 0).all(), name)
            torque = slewlab.open_log(Path(folder) / "half")["TORQUE"]
            turned = [torque.index[torque[f"motor_torque_{group}"] < 0.0][0] for group in (1, 2)]
            self.assertAlmostEqual(turned[1] - turned[0], 0.5 * EXAMPLE["boom_period"](scenario), delta=scenario.controller_period)


if __name__ == "__main__":
    unittest.main()
