"""`slewlab new`: files to begin with, which `slewlab check` takes and a run or an import goes with."""

import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import yaml

from run_log import REPOSITORY, messages_folder, read_run_log

PROGRAM = messages_folder().parent / "bin" / "slewlab"

DATA = """made by a recorder
Time [ms];Slew encoder [deg];Motor speed (rpm);Drive torque [Nm];Tip acc [m/s^2];Oil temp
0;0,0;-1;5;0,1;40
1;0,1;-2;5;0,1;40
2;0,3;-3,1;5;0;40
3;0,6;-4;5,5;0;40
"""


def slewlab(*words):
    ended = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    return ended.returncode, ended.stdout + ended.stderr


class NewTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def made(self, *words):
        code, said = slewlab("new", *words)
        self.assertEqual(code, 0, said)

    def assert_ok_but_for_the_templates_words(self, code, said, *files):
        """Each is good, and what its user has to replace is remarked on."""
        self.assertEqual(code, 0, said)
        for file in files:
            self.assertIn(f"{file}: OK\n", said)
            self.assertRegex(said, rf"{file}:\d+:\d+: warning: key 'description': still the template's")
        self.assertRegex(said, rf"{files[0]}:\d+:\d+: warning: \d+ values have the template's source still")
        self.assertEqual([line for line in said.splitlines() if not line.endswith(": OK") and "the template's" not in line], [])

    def test_crane_controller_and_scenario_pass_the_check_together(self):
        crane, controller, scenario = (self.folder / name for name in ("mine/crane.yaml", "control/controller.yaml", "scenario.yaml"))
        self.made("crane", crane)
        self.made("controller", controller, "--crane", crane)
        self.made("scenario", scenario, "--crane", crane, "--controller", controller)
        code, said = slewlab("check", crane, controller, scenario)
        self.assert_ok_but_for_the_templates_words(code, said, crane, controller, scenario)
        self.assertIn("\ncrane: mine/crane.yaml\ncontroller: control/controller.yaml\n", scenario.read_text())

    def test_an_axis_runs_with_a_controller_and_a_scenario_of_its_own(self):
        axis, controller, scenario = (self.folder / name for name in ("axis.yaml", "controller.yaml", "scenario.yaml"))
        self.made("axis", axis)
        self.made("controller", controller, "--axis", axis)
        self.made("scenario", scenario, "--axis", axis, "--controller", controller)
        code, said = slewlab("check", axis, controller, scenario)
        self.assert_ok_but_for_the_templates_words(code, said, axis, controller, scenario)
        self.assertIn("\naxis: axis.yaml\n", scenario.read_text())
        code, said = slewlab("new", "axis", self.folder / "other.yaml", "--axis", axis)
        self.assertEqual(code, 2)
        self.assertIn("a machine beside a new axis", said)

    def test_a_controller_has_the_numbers_of_its_machine(self):
        offshore = REPOSITORY / "config" / "cranes" / "offshore_900t.yaml"
        self.made("controller", self.folder / "controller.yaml", "--crane", offshore)
        made, crane = yaml.safe_load((self.folder / "controller.yaml").read_text()), yaml.safe_load(offshore.read_text())
        drive = crane["drive"]
        self.assertEqual(made["groups"]["value"], drive["groups"]["value"])
        self.assertAlmostEqual(made["total_ratio"]["value"], drive["gearbox_ratio"]["value"] * drive["pinion_ratio"]["value"], places=6)
        self.assertEqual(made["motor_torque_rated"]["value"], drive["rated_torque"]["value"])
        self.assertEqual((drive["top_speed"]["unit"], made["ramp"]["top_speed"]["unit"]), ("rpm", "rad/s"))
        self.assertAlmostEqual(made["ramp"]["top_speed"]["value"], drive["top_speed"]["value"] * 2 * np.pi / 60, places=12)
        self.assertEqual(made["motor_torque_rated"]["source"], "of offshore_900t.yaml")

    def test_a_map_is_guessed_from_the_header_and_the_data(self):
        data, map_file, log = self.folder / "data.csv", self.folder / "map.yaml", self.folder / "site.lcmlog"
        data.write_text(DATA)
        self.made("map", map_file, "--data", data)
        text = map_file.read_text()
        self.assertIn("key 'shaft_position[1].ratio.source': found REPLACE", slewlab("check", map_file)[1])
        map_file.write_text(text.replace("REPLACE: motor", "chosen: motor"))
        self.assertEqual(slewlab("check", map_file), (0, f"{map_file}: OK\n"))
        self.assertIn('csv: {separator: ";", decimal: ",", skip_lines: 1}', text)
        self.assertIn("# Columns that are not used: Oil temp", text)
        self.assertEqual(text.count("guess: column"), 5)
        code, said = slewlab("import", "--map", map_file, data, "--out", log)
        self.assertEqual(code, 0, said)
        found = read_run_log(log)
        np.testing.assert_allclose(found.channel("ENCODER")["shaft_position"][:, 0], np.radians([0.0, 0.1, 0.3, 0.6]), atol=1e-15)
        # The speed column falls while the position rises, so that its sign was guessed to be -1.
        np.testing.assert_allclose(found.channel("ENCODER")["shaft_speed"][:, 0], np.array([1, 2, 3.1, 4]) * 2 * np.pi / 60, rtol=1e-12)
        np.testing.assert_array_equal(found.channel("SENSORS")["tip_acceleration"], [0.1, 0.1, 0.0, 0.0])

    def test_a_unit_that_is_none_is_not_taken_for_the_usual_one_in_silence(self):
        data, map_file, log = self.folder / "data.csv", self.folder / "map.yaml", self.folder / "site.lcmlog"
        data.write_text(DATA.replace("Tip acc [m/s^2]", "Tip acc [g]").replace("Drive torque [Nm]", "Drive torque [lbft]"))
        self.made("map", map_file, "--data", data)
        text = map_file.read_text()
        self.assertIn("guess: in g, the acceleration of gravity", text)
        self.assertIn("guess: unit, the usual one: 'lbft' is none that is known here", text)
        self.assertIn('source: "REPLACE: motor turns per turn of the slew axis"', text)
        code, said = slewlab("check", map_file)
        self.assertEqual(code, 1)
        self.assertIn("key 'shaft_position[1].ratio.source': found REPLACE: motor turns per turn of the slew axis, expected a value of your own", said)
        self.assertEqual(slewlab("import", "--map", map_file, data, "--out", log)[0], 0)
        np.testing.assert_allclose(read_run_log(log).channel("SENSORS")["tip_acceleration"], np.array([0.1, 0.1, 0.0, 0.0]) * 9.80665, rtol=1e-12)

    def test_what_no_column_was_found_for_is_said(self):
        data, map_file = self.folder / "data.csv", self.folder / "map.yaml"
        data.write_text("t,pos_deg\n0,0\n1,1\n2,2\n")
        self.made("map", map_file, "--data", data)
        text = map_file.read_text()
        self.assertIn('column: "REPLACE_motor_torque"', text)
        self.assertIn("derive: central_difference", text)
        code, said = slewlab("check", map_file)
        self.assertEqual(code, 1)
        line = 1 + text[:text.index('"REPLACE_motor_torque"')].count("\n")
        self.assertRegex(said, rf":{line}:\d+: key 'motor_torque\[1\].column': found REPLACE_motor_torque, expected the name of a column of the data")
        code, said = slewlab("import", "--map", map_file, data)
        self.assertEqual(code, 2)
        self.assertIn("'REPLACE_motor_torque', which data.csv does not have", said)

    def test_a_mistake_in_a_map_is_found_by_line(self):
        map_file = self.folder / "map.yaml"
        map_file.write_text("kind: import_map\ntime: {column: t, unit: s}\nshaft_positoin:\n  - {column: a, unit: rad}\n")
        code, said = slewlab("check", map_file)
        self.assertEqual(code, 1)
        self.assertIn(f"{map_file}:3:1: key 'shaft_positoin': found a key that is not known here, expected 'shaft_position'", said)

    def test_nothing_is_overwritten_and_nothing_is_ignored(self):
        crane = self.folder / "crane.yaml"
        self.made("crane", crane)
        for words, expected in ((("crane", crane), "nothing is overwritten"),
                                (("crnae", self.folder / "x.yaml"), "KIND: found 'crnae', expected 'crane' (or one of"),
                                (("crane", self.folder / "x.yaml", "--controller", crane), "it beside a scenario"),
                                (("crane", self.folder / "x.yaml", "--data", crane), "them beside a map"),
                                (("map", self.folder / "x.yaml"), "--data: found nothing")):
            with self.subTest(words=words):
                code, said = slewlab("new", *words)
                self.assertEqual(code, 2)
                self.assertIn(expected, said)


if __name__ == "__main__":
    unittest.main()
