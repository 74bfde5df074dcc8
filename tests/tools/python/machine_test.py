"""What Python knows of a plain axis, against what the C++ side says of it in run.json."""

import contextlib
import io
import json
import math
import subprocess
import tempfile
import unittest
from pathlib import Path

import import_data
from machine import read_axis
from run_log import slewlab_program
from run_numbers import facts_beside

COMMON = """kind: axis
description: made up
load_encoder: {value: true, source: test}
"""
MACHINES = {  # file, and units of the columns
    "a linear motor": ("""coordinate: {value: linear, source: test}
mass: {value: 95, unit: kg, source: test}
rated_force: {value: 600, unit: N, source: test}
top_speed: {value: 0.3, unit: m/s, source: test}
""", "m", "N", "m"),
    "a screw": ("""coordinate: {value: linear, source: test}
mass: {value: 95, unit: kg, source: test}
travel_per_turn: {value: 2.5, unit: mm, source: test}
rated_torque: {value: 0.6, unit: N m, source: test}
top_speed: {value: 0.3, unit: m/s, source: test}
""", "rad", "N m", "m"),
    "a gear that gives": ("""coordinate: {value: rotary, source: test}
inertia: {value: 2, unit: kg m^2, source: test}
motor_inertia: {value: 0.001, unit: kg m^2, source: test}
ratio: {value: 50, unit: "-", source: test}
transmission:
  stiffness: {value: 1e4, unit: N m/rad, source: test}
  damping_ratio: {value: 0.05, unit: "-", source: test}
  play: {value: 0.001, unit: rad, source: test}
rated_torque: {value: 8, unit: N m, source: test}
top_speed: {value: 3, unit: rad/s, source: test}
""", "rad", "N m", "rad"),
}
MAP = """kind: import_map
machine: axis.yaml
time: {{column: t, unit: s, origin: first_row}}
shaft_position:
  - {{column: x, unit: {shaft}, on: shaft}}
shaft_speed:
  - {{derive: central_difference}}
motor_torque:
  - {{column: f, unit: {effort}, on: shaft}}
load_position: {{column: y, unit: {axis}}}
"""


class MachineTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_an_imported_log_has_the_machine_of_its_map_beside_it_as_a_run_has(self):
        machine, log = self.folder / "axis.yaml", self.folder / "record.lcmlog"
        rows = [f"{0.002 * k},{0.1 * math.sin(0.004 * k)},{0.01 * math.cos(0.004 * k)},0" for k in range(500)]
        (self.folder / "record.csv").write_text("\n".join(["t,x,f,y", *rows]))
        for name, (text, shaft, effort, axis) in MACHINES.items():
            machine.write_text(COMMON + text)
            (self.folder / "map.yaml").write_text(MAP.format(shaft=shaft, effort=effort, axis=axis))
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                self.assertEqual(import_data.main(["--map", str(self.folder / "map.yaml"), str(self.folder / "record.csv"), "--out", str(log)]), 0)
            subprocess.run([slewlab_program(), "simulate", machine, log, "--out", self.folder / "simulated"], stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL, check=True)
            imported, simulated = facts_beside(log), json.loads((self.folder / "simulated" / "run.json").read_text())
            with self.subTest(name):
                self.assertEqual({key: imported[key] for key in ("rated_torque", "total_ratio")},
                                 {key: simulated[key] for key in ("rated_torque", "total_ratio")})
                self.assertEqual(imported["machine"], {key: simulated["machine"][key] for key in imported["machine"]})
                self.assertEqual(imported["top_speed"], simulated["machine"]["top_speed"])
                self.assertEqual(read_axis(machine).units()["motor_torque"], effort)


if __name__ == "__main__":
    unittest.main()
