"""`slewlab new`: files to begin with, which `slewlab check` takes and a run or an import goes with."""

import os
import pty
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from new_map import map_text, signs_agree
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


def at_a_terminal(words, answers, folder):
    """Exit code and what stands on the screen of `slewlab new` at a terminal, where a person answers one question after the other."""
    person, terminal = pty.openpty()
    running = subprocess.Popen([PROGRAM, "new", *map(str, words)], stdin=terminal, stdout=terminal, stderr=terminal, cwd=folder, start_new_session=True)
    os.close(terminal)
    screen, answers = b"", list(answers)
    try:
        while True:
            try:
                part = os.read(person, 4096)
            except OSError:  # the other side is closed
                break
            if not part:
                break
            screen += part
            if screen.endswith(b": ") and answers:
                answer = answers.pop(0)
                os.write(person, b"\x04" if answer is None else answer.encode() + b"\n")  # Ctrl-D
    finally:
        os.close(person)
    return running.wait(60), screen.decode().replace("\r\n", "\n")


class NewTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def map_of(self, table):
        """The map that is made for a CSV of that text."""
        data, map_file = self.folder / "data.csv", self.folder / "map.yaml"
        data.write_text(table)
        self.made("map", map_file, "--data", data)
        return map_file

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

    def test_a_sign_is_not_guessed_from_rounding(self):
        times = [0.0, 0.1, 0.2, 0.3]
        for places, speeds, agree in (([0.1, 0.2, 0.3, 0.4], [1.0, 1.0, 1.1, 1.0], True), ([0.1, 0.2, 0.3, 0.4], [-1.0, -1.0, -1.1, -1.0], False),
                                      ([0.1, 0.2, 0.3, 0.4], [-0.1, 0.2, -0.1, 0.1], None), ([0.1, 0.1, 0.1, 0.1], [1.0, 1.0, 1.1, 1.0], None),
                                      ([0.0, 0.1, 0.0, 0.1], [0.0, 1.0, -1.0, 1.0], True)):
            with self.subTest(places=places, speeds=speeds):
                self.assertIs(signs_agree(pd.DataFrame({"t": times, "p": places, "v": speeds}), "p", "v"), agree)

    def test_every_motor_group_of_the_header_is_an_entry(self):
        headers = {"time,shaft_speed_1,shaft_speed_2,shaft_position_1,shaft_position_2,motor_torque_1,motor_torque_2": ("rad", "rad/s", "N m"),
                   "t_s,speed_1_rpm,speed_2_rpm,position_1_rad,position_2_rad,torque_1_Nm,torque_2_Nm": ("rad", "rpm", "Nm"),
                   "t,M1_speed,M2_speed,M1_pos [deg],M2_pos [deg],M1_torque,M2_torque": ("deg", "rad/s", "N m"),
                   "Zeit [s],Drehzahl1 [1/min],Drehzahl2 [1/min],Winkel1 [rad],Winkel2 [rad],Moment1 [kNm],Moment2 [kNm]": ("rad", "1/min", "kNm")}
        for number, (header, units) in enumerate(headers.items()):
            with self.subTest(header=header):
                data, map_file, log = (self.folder / f"{number}{end}" for end in (".csv", ".yaml", ".lcmlog"))
                # The second group turns the other way, by its speed against its position.
                rows = [[0.01 * k, k, k, 0.1 * k * k, -0.1 * k * k, 5 + k, 7 + k] for k in range(6)]
                data.write_text(header + "\n" + "".join(",".join(f"{value:.6g}" for value in row) + "\n" for row in rows))
                self.made("map", map_file, "--data", data)
                self.assertEqual(slewlab("check", map_file), (0, f"{map_file}: OK\n"))
                told, names = yaml.safe_load(map_file.read_text()), header.split(",")
                columns = {name: [each["column"] for each in told[name]] for name in ("shaft_speed", "shaft_position", "motor_torque")}
                self.assertEqual(columns, {"shaft_speed": names[1:3], "shaft_position": names[3:5], "motor_torque": names[5:7]})
                for name, unit in zip(("shaft_position", "shaft_speed", "motor_torque"), units, strict=True):
                    self.assertEqual([each["unit"] for each in told[name]], [unit, unit])
                self.assertEqual([each.get("sign") for each in told["shaft_speed"]], [None, -1])
                guesses = map_file.read_text().count("  # guess: column, by its name")
                self.assertEqual(guesses, 6)
                code, said = slewlab("import", "--map", map_file, data, "--out", log)
                self.assertEqual(code, 0, said)
                self.assertEqual(read_run_log(log).channel("TORQUE")["motor_torque"].shape, (6, 2))
        self.assertIn("guess: unit, the usual one", (self.folder / "0.yaml").read_text())

    def test_groups_that_some_signals_have_not_are_marked(self):
        map_file = self.map_of("t,encoder,torque_1,torque_2\n0,0,1,1\n1,1,1,1\n2,2,1,1\n")
        told = yaml.safe_load(map_file.read_text())
        self.assertEqual([each["column"] for each in told["shaft_position"]], ["encoder", "REPLACE_shaft_position_2"])
        self.assertEqual(told["shaft_speed"], 2 * [{"derive": "central_difference"}])
        self.assertIn("found REPLACE_shaft_position_2", slewlab("check", map_file)[1])

    def test_an_emergency_stop_is_known_in_english_and_german(self):
        for name in ("Not-Aus", "NotHalt", "NOTHALT", "Not_Aus [-]", "estop", "E-Stop", "emergency_stop"):
            for first, inverted in ((0, None), (1, True)):
                with self.subTest(name=name, first=first):
                    data = self.folder / "data.csv"
                    data.write_text(f"t,pos,speed,torque,{name}\n0,0,1,1,{first}\n1,1,1,1,{first}\n2,2,1,1,{1 - first}\n")
                    stop = yaml.safe_load(map_text(data))["emergency_stop"]
                    self.assertEqual((stop["column"], stop.get("inverted")), (name, inverted))

    def test_enable_and_brake_are_known_where_they_are_flags(self):
        data = self.folder / "data.csv"
        data.write_text("t,pos,torque,Drive Enable,Brake released,Brake torque [Nm]\n0,0,1,0,0,1\n1,1,1,1,1,1\n2,2,1,1,1,1\n")
        told = yaml.safe_load(map_text(data))
        self.assertEqual((told["enable"], told["brake"]), ({"column": "Drive Enable"}, {"column": "Brake released", "inverted": True}))
        data.write_text("t,pos,torque,enable,brake\n0,0,1,3,0\n1,1,1,7,0\n2,2,1,7,0\n")
        told = yaml.safe_load(map_text(data))
        self.assertNotIn("enable", told)
        self.assertEqual(told["brake"], {"column": "brake"})

    def test_a_torque_in_per_cent_waits_for_what_a_per_cent_is(self):
        map_file = self.map_of("t,M1 Pos [deg],M1 Torque [%],Joystick [%]\n0,0,1,5\n1,1,1,5\n2,2,1,5\n")
        told = yaml.safe_load(map_file.read_text())
        self.assertEqual([told["motor_torque"][0][key] for key in ("column", "unit")], ["M1 Torque [%]", "N m"])
        self.assertEqual(told["speed_request"], {"column": "Joystick [%]", "unit": "%"})
        self.assertIn("key 'motor_torque[1].scale.source': found REPLACE: N m per motor that 1 % is", slewlab("check", map_file)[1])

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
        code, said = slewlab("import", "--map", map_file, data, "--out", log)
        self.assertEqual((code, log.exists()), (2, False))
        self.assertIn("found REPLACE: motor turns per turn of the slew axis", said)
        map_file.write_text(text.replace("REPLACE: ", "nameplate, "))
        self.assertEqual(slewlab("import", "--map", map_file, data, "--out", log)[0], 0)
        np.testing.assert_allclose(read_run_log(log).channel("SENSORS")["tip_acceleration"], np.array([0.1, 0.1, 0.0, 0.0]) * 9.80665, rtol=1e-12)

    def test_a_guess_says_what_it_is_made_of(self):
        map_file = self.map_of("t,M [Nm],Tip (mm/s2)\n0,1,1\n1,1,1\n2,2,1\n")
        text = map_file.read_text()
        self.assertIn("# guess: column, by its name; guess: unit, the usual one\ntime: {", text)
        self.assertIn('# guess: column, by its unit; guess: sign 1\n  - {column: "M [Nm]", unit: "Nm"}', text)
        self.assertIn('# guess: column, by its name and unit\ntip_acceleration: {column: "Tip (mm/s2)", unit: "mm/s^2"}', text)

    def test_what_no_column_was_found_for_is_said(self):
        map_file = self.map_of("t,pos_deg\n0,0\n1,1\n2,2\n")
        text = map_file.read_text()
        self.assertIn('column: "REPLACE_motor_torque"', text)
        self.assertIn("derive: central_difference", text)
        code, said = slewlab("check", map_file)
        self.assertEqual(code, 1)
        line = 1 + text[:text.index('"REPLACE_motor_torque"')].count("\n")
        self.assertRegex(said, rf":{line}:\d+: key 'motor_torque\[1\].column': found REPLACE_motor_torque, expected the name of a column of the data")
        code, said = slewlab("import", "--map", map_file, self.folder / "data.csv")
        self.assertEqual(code, 2)
        self.assertIn("found REPLACE_motor_torque, expected the name of a column of the data", said)

    def test_a_mistake_in_a_map_is_found_by_line(self):
        map_file = self.folder / "map.yaml"
        map_file.write_text("kind: import_map\ntime: {column: t, unit: s}\nshaft_positoin:\n  - {column: a, unit: rad}\n")
        code, said = slewlab("check", map_file)
        self.assertEqual(code, 1)
        self.assertIn(f"{map_file}:3:1: key 'shaft_positoin': found a key that is not known here, expected 'shaft_position'", said)

    def test_at_a_terminal_it_asks_for_what_is_missing(self):
        (self.folder / "there.yaml").write_text("mine")
        # Kind, a file that is there, another; groups to pinion's ratio, torque, speed, inertia: as they are but for a wrong unit and a bare number.
        answers = ["crnae", "crane", "there.yaml", "mine.yaml", "1", "", "", "", "3 kg", "300", "", "", "52 m", "", "0.7 rad", "60 t", ""]
        code, screen = at_a_terminal([], answers, self.folder)
        self.assertEqual(code, 0, screen)
        for said in ("found 'crnae', expected 'crane'", "there.yaml: found a file that is there", "boom length [46.6 m]: ", "load mass [30 t]: ",
                     "rated torque of a motor [250 N m]: 3 kg\n  ", "mine.yaml: written"):
            self.assertIn(said, screen)
        self.assertIn("the unit 'kg'", screen)
        path = self.folder / "mine.yaml"
        code, said = slewlab("check", path)
        self.assertEqual((code, said.splitlines()[0]), (0, f"{path}: OK"))
        made, template = yaml.safe_load(path.read_text()), yaml.safe_load((REPOSITORY / "config" / "templates" / "crane.yaml").read_text())
        source = "answered to slewlab new: replace by where the number is from"
        for (section, key), (value, unit) in {("drive", "groups"): (1, "-"), ("drive", "rated_torque"): (300, "N m"), ("boom", "length"): (52, "m"),
                                              ("boom", "angle"): (0.7, "rad"), ("load", "mass"): (60, "t")}.items():
            self.assertEqual(made[section].pop(key), {"value": value, "unit": unit, "source": source})
            del template[section][key]
        self.assertEqual(made, template)  # and nothing else
        self.assertEqual((self.folder / "there.yaml").read_text(), "mine")

    def test_at_a_terminal_what_was_told_is_not_asked(self):
        code, screen = at_a_terminal(["scenario", "--crane", REPOSITORY / "config" / "cranes" / "thesis.yaml"], ["s.yaml", ""], self.folder)
        self.assertEqual(code, 0, screen)
        self.assertIn("thesis.yaml\n", (self.folder / "s.yaml").read_text())
        (self.folder / "data.csv").write_text(DATA)
        code, screen = at_a_terminal(["map", "m.yaml"], ["nothing.csv", "data.csv"], self.folder)
        self.assertEqual(code, 0, screen)
        self.assertIn("nothing.csv: found no file of that name", screen)
        self.assertIn("ratio.source': found REPLACE", slewlab("check", self.folder / "m.yaml")[1])
        code, screen = at_a_terminal(["axis", "a.yaml"], [], self.folder)  # nothing is missing
        self.assertEqual((code, screen), (0, "a.yaml: written; fill it in, then: slewlab check a.yaml\n"))
        code, screen = at_a_terminal(["axis"], ["b.yaml", None], self.folder)
        self.assertEqual(code, 2)
        self.assertIn("nothing was written", screen)
        self.assertFalse((self.folder / "b.yaml").exists())

    def test_on_a_pipe_nothing_is_asked(self):
        for words, said in (((), "KIND is required"), (("crane",), "FILE is required")):
            ended = subprocess.run([PROGRAM, "new", *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=60)
            self.assertEqual(ended.returncode, 2)
            self.assertIn(said, ended.stderr)

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
