"""Real machines as their makers describe them (machines/*/machine.yaml): imported, simulated open loop from their recorded
torque, and shown against their records. What is expected comes from the CSV files and m x'' = F, integrated here."""

import html
import re
import subprocess
import unittest

import numpy as np
import pandas as pd

import axis_report
import report
from run_log import REPOSITORY
from run_numbers import read_run
from shared_data import DATA, SLEWLAB, SharedDataTest

MACHINES = REPOSITORY / "tests" / "diagnosis" / "machines"
MOST_LINES = 15  # of a machine's file

# Of each machine: its records, inertia on the axis, and from a table to position, speed and torque (force) on the axis.
RADIUS, CONSTANT, RATIO = 0.028, 0.0934, 256.8571  # READMEs of the data: [m], [N m/A], [-]


def central(x, t):
    v = np.gradient(x, (t[-1] - t[0]) / (len(t) - 1))
    v[0], v[-1] = v[1], v[-2]
    return v


def servo_axis(d):
    return d.position_m, central(d.position_m.to_numpy(), d.time_s.to_numpy()), d.force_command_N


def motor_bench(d):
    return d.position_rad, central(d.position_rad.to_numpy(), d.time_s.to_numpy()), d.torque_command_Nm


def robot_axis(d):
    return np.radians(d.motor_position_deg), np.radians(d.motor_speed_deg_per_s), d.torque_Nm * RATIO


def belt_cart(d):
    return d.position_m, central(d.position_m.to_numpy(), d.time_s.to_numpy()), d.current_command_A * CONSTANT / RADIUS


CASES = {servo_axis: (["run_a"], 95.0), motor_bench: (["fit_a", "fit_b"], 1.2e-4),
         robot_axis: (["fit_a", "unseen"], 701.0 + 0.0092 * RATIO**2), belt_cart: (["fit_a", "unseen"], 6.0)}


def one_inertia(t, x, v, torque, inertia):
    """m x'' = F with F held from row to row, from the motion of the first row: exact. Rows come evenly in the log."""
    h = (t[-1] - t[0]) / (len(t) - 1)
    speed = v[0] + np.concatenate(([0.0], np.cumsum(torque[:-1]))) * h / inertia
    position = x[0] + np.concatenate(([0.0], np.cumsum(0.5 * h * (speed[:-1] + speed[1:]))))
    return position, speed


class MachinesTest(SharedDataTest):
    def test_a_machine_takes_few_lines(self):
        for file in sorted(MACHINES.glob("*/machine.yaml")):
            self.assertLessEqual(len(file.read_text().splitlines()), MOST_LINES, file)
            said = subprocess.run([SLEWLAB, "check", file], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)

    def test_open_loop_against_the_record_is_one_inertia(self):
        self.need_data()
        for read, (records, inertia) in CASES.items():
            name = read.__name__
            for record in records:
                with self.subTest(machine=name, record=record):
                    self.check(name, record, read, inertia)

    def check(self, name, record, read, inertia):
        csv = DATA / name / f"{record}.csv"
        log, out = self.imported(MACHINES / name / "map.yaml", name, record), self.folder / f"{name}_{record}"
        simulated = subprocess.run([SLEWLAB, "simulate", MACHINES / name / "machine.yaml", log, "--out", out],
                                   capture_output=True, text=True)
        self.assertEqual(simulated.returncode, 0, simulated.stderr)
        table = self.quietly(report.main, out, log, "--out", self.folder / "page.html")
        for word in ("house", "slew", "boom", "tip", "T100"):
            self.assertNotIn(word, table.replace("slewlab", ""))
            self.assertNotIn(word, re.sub(r"<script.*?</script>", "", (self.folder / "page.html").read_text().replace("slewlab", ""), flags=re.S)
                             .split('"data"')[0])

        data = pd.read_csv(csv)
        t = data.time_s.to_numpy()
        x, v, torque = (np.asarray(values, float) for values in read(data))
        position, speed = one_inertia(t, x, v, torque, inertia)
        runs = [read_run(out), read_run(log)]
        axis_report.share_machine(runs)
        found = axis_report.difference(*runs)
        # The log's times are whole nanoseconds, the plant's step is their mean.
        np.testing.assert_allclose(axis_report.rms(found["position"][1]), axis_report.rms(position - x), rtol=1e-4)
        np.testing.assert_allclose(axis_report.rms(found["speed"][1]), axis_report.rms(speed - v), rtol=1e-4)
        unit = "m" if name in ("servo_axis", "belt_cart") else "rad"
        self.assertIn(f"{axis_report.rms(found['position'][1]):.3g} {unit}", table)
        self.assertEqual("load position" in found, name == "robot_axis")

    # The makers' models have no friction, and every machine has: it is named, it predicts the record that was not fitted, and what is
    # written runs. Least squares by hand are the measure of tests/diagnosis/balance/balance_machines_test.cpp.
    def test_friction_is_named_of_every_machine(self):
        self.need_data()
        for name, records in (("servo_axis", ["run_a"]), ("motor_bench", ["fit_a", "fit_b"]), ("robot_axis", ["fit_a", "fit_b"]),
                              ("belt_cart", ["fit_a", "fit_b"])):
            with self.subTest(machine=name):
                logs, out = [self.imported(MACHINES / name / "map.yaml", name, record) for record in records], self.folder / name
                found = self.diagnosed("--axis", MACHINES / name / "machine.yaml", logs, out)
                self.assertTrue(found["is_stated"], found["verdict"])
                self.assertTrue({"dry", "viscous"} <= set(found["causes"][0]["laws"]), found["verdict"])
                self.assertLess(found["probability_unknown"], 0.02)
                validation = found["validation"]
                self.assertTrue(validation["holds"])
                for error in ("balance_rms", "forward_speed_rms"):
                    self.assertLess(validation["cause"][error], min(validation["nominal"][error], validation["inertia_alone"][error]))
                self.assertIn(html.escape(found["verdict"]), (out / "diagnosis.html").read_text())
                checked = subprocess.run([SLEWLAB, "check", out / "axis_with_effect.yaml"], capture_output=True, text=True)
                self.assertEqual(checked.returncode, 0, checked.stderr)


if __name__ == "__main__":
    unittest.main()
