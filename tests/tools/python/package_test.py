"""The package slewlab against the command line, against itself and against closed forms."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import report
from run_log import REPOSITORY, messages_folder, read_run_log
from run_numbers import read_run
from sanitizer import IS_SANITIZED

sys.path.insert(0, str(messages_folder()))
import slewlab  # noqa: E402

SLEW = slewlab.config("scenarios/thesis_slew.yaml")
SHORT = {"duration": 12}


def run_by_command(scenario, changes, folder):
    words = [REPOSITORY / "tools" / "in-private-network", messages_folder().parent / "bin" / "slewlab", "run", scenario, "--out", folder]
    for key, value in changes.items():
        words += ["--set", f"{key}={value}"]
    ended = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return folder / "run.lcmlog"


class RunTest(unittest.TestCase):
    def test_the_log_is_that_of_slewlab_run_to_the_byte(self):
        # A crane, an axis, and faults on purpose.
        for name, changes in (("thesis_slew", SHORT), ("example_axis", {}), ("faults/torque_lost", {})):
            with self.subTest(name=name), tempfile.TemporaryDirectory() as folder:
                scenario = slewlab.config(f"scenarios/{name}.yaml")
                by_command = run_by_command(scenario, changes, Path(folder) / "run")
                in_process = Path(folder) / "own.lcmlog"
                slewlab.Scenario(scenario, changes).run(log=in_process)
                self.assertEqual(in_process.read_bytes(), by_command.read_bytes())

    def test_a_run_over_lcm_is_the_run_in_the_process(self):
        scenario = slewlab.Scenario(SLEW, {"duration": 5, "crane.load.mass": "20 t"})
        own = scenario.run()
        with tempfile.TemporaryDirectory() as folder:
            log = scenario.run_over_lcm(folder)
            self.assertEqual(log.remarks, [])
            for channel in own.channels:
                self.assertEqual(log.messages(channel).tobytes(), own.messages(channel).tobytes())
            with self.assertRaisesRegex(slewlab.ProgramFailed, "thesis_slew.yaml"):  # what the command said
                slewlab.Scenario(SLEW, {"duration": 5}).run_over_lcm(Path(folder) / "other", "exit 3")

    def test_a_log_opened_is_the_run_that_wrote_it(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.lcmlog"
            run = slewlab.Scenario(SLEW, SHORT).run(log=path)
            log = slewlab.open_log(folder)
            self.assertEqual(log.remarks, [])
            self.assertEqual(log.channels, run.channels)
            other = read_run_log(path)
            for channel in log:
                for field in run.messages(channel).dtype.names:
                    np.testing.assert_array_equal(log.messages(channel)[field], run.messages(channel)[field])
                    np.testing.assert_array_equal(log.messages(channel)[field], other.channel(channel)[field])

    def test_a_callable_that_says_what_the_controller_said_moves_the_crane_alike(self):
        scenario = slewlab.Scenario(SLEW, {"duration": 33})  # the emergency stop is at 30 s
        own = scenario.run()
        answers = iter(own.messages("TORQUE"))

        def replayed(encoder, operator):
            torque = next(answers)
            self.assertEqual(torque["answered_sequence"], encoder.sequence)
            return slewlab.Answer(list(torque["motor_torque"]), bool(torque["enable"]), bool(torque["brake"]))

        again = scenario.run(replayed)
        for channel in ("ENCODER", "SENSORS", "TRUTH"):
            self.assertEqual(again.messages(channel).tobytes(), own.messages(channel).tobytes())
        self.assertNotIn("CONTROLLER_STATE", again)

    def test_a_class_is_made_anew_at_every_start_and_says_whether_it_acknowledges(self):
        made = []

        class Still:
            def __init__(self):
                made.append(0)

            def __call__(self, encoder, operator):
                made[-1] += 1
                return slewlab.Answer([0.0] * encoder.group_count, acknowledge=encoder.time > 0.5)

        scenario = slewlab.Scenario(slewlab.config("scenarios/faults/controller_restarted.yaml"))  # dead from 10 s to 12 s of 30 s
        run = scenario.run(Still, channels=["TORQUE"])
        self.assertEqual(len(made), 2)
        self.assertEqual(made[0], 1000)  # a question every 10 ms
        self.assertGreater(made[1], 1700)
        torque = run.messages("TORQUE")
        np.testing.assert_array_equal(torque["acknowledge"].astype(bool), torque["simulated_time"] > 500_000_000)

    def test_what_a_callable_raises_comes_out(self):
        def broken(encoder, operator):
            if encoder.time >= 0.5:
                raise ArithmeticError("at half a second")
            return [0.0] * encoder.group_count

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.lcmlog"
            with self.assertRaisesRegex(ArithmeticError, "at half a second"):
                slewlab.Scenario(SLEW, SHORT).run(broken, log=path)
            self.assertFalse(path.exists())  # a file of that name is a whole run
        with self.assertRaisesRegex(ValueError, r"answered 1 motor torque\(s\), expected 2"):
            slewlab.Scenario(SLEW, SHORT).run(lambda encoder, operator: [1.0])
        with self.assertRaisesRegex(TypeError, "answered 'fast', expected a motor torque"):
            slewlab.Scenario(SLEW, SHORT).run(lambda encoder, operator: "fast")

    def test_tables_have_times_units_and_entries_from_one(self):
        run = slewlab.Scenario(SLEW, {"duration": 1}).run(channels=["ENCODER"])
        self.assertEqual(run.channels, ["ENCODER"])
        table = run["ENCODER"]
        # 1 s at 10 ms; the lockstep's last period has no question.
        np.testing.assert_allclose(table.index, np.arange(100) * 0.01, rtol=0, atol=1e-12)
        self.assertEqual(table.attrs["units"]["shaft_speed_2"], "rad/s")
        self.assertEqual(table.attrs["units"]["time"], "s")
        motor_torque = slewlab.Scenario(SLEW, {"duration": 1}).run()["TORQUE"]
        self.assertEqual(motor_torque.attrs["units"]["motor_torque_1"], "N m")  # as files and figures write it
        with self.assertRaisesRegex(KeyError, "no ENCODR here, expected 'ENCODER'"):
            run["ENCODR"]
        with self.assertRaisesRegex(KeyError, "no channel SENSOR, expected 'SENSORS'"):
            slewlab.Scenario(SLEW, {"duration": 1}).run(channels=["SENSOR"])

    def test_a_linear_motor_has_metres_and_newtons_in_a_run_in_its_log_and_in_figures(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "axis.yaml").write_text("""kind: axis
description: made up
coordinate: {value: linear, source: test}
mass: {value: 95, unit: kg, source: test}
rated_force: {value: 600, unit: N, source: test}
top_speed: {value: 0.3, unit: m/s, source: test}
""")
        scenario = folder / "scenario.yaml"
        scenario.write_text(f"include: {slewlab.config('scenarios/example_axis.yaml')}\naxis: axis.yaml\n")
        run = slewlab.Scenario(scenario, {"duration": 1}).run(lambda *_: [10.0])
        run.scenario.run(lambda *_: [10.0], log=folder / "run.lcmlog")
        (folder / "run.json").write_text(json.dumps({"machine": run.scenario.machine.facts()}))  # as slewlab run has it beside its log
        for one in (run, slewlab.open_log(folder)):
            self.assertEqual([one["ENCODER"].attrs["units"][name] for name in ("shaft_position_1", "shaft_speed_1")], ["m", "m/s"])
            self.assertEqual(one["TORQUE"].attrs["units"]["motor_torque_1"], "N")
        for figure in (slewlab.overview(run), slewlab.report_figures(run)["picture"]):
            titles = " ".join(axis.title.text or "" for axis in figure.select_yaxes())
            self.assertIn("[m/s]", titles)
            self.assertIn("[N]", titles)
            self.assertNotIn("N m]", titles)

    def test_a_file_that_is_no_log_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "run.lcmlog").write_text("no log")
            with self.assertRaisesRegex(slewlab.LogError, "holds no message that slewlab can read"):
                slewlab.open_log(folder)
            with self.assertRaisesRegex(slewlab.LogError, "No such file or directory"):
                slewlab.open_log(Path(folder) / "other.lcmlog")


class InputTest(unittest.TestCase):
    def test_exceptions_say_what_they_are_for(self):
        for error in (slewlab.InputError, slewlab.LogError):
            self.assertIn("line" if error is slewlab.InputError else "log", error.__doc__)

    def test_none_takes_a_value_away_as_null_does(self):
        scenario = slewlab.config("scenarios/thesis_slew.yaml")
        self.assertEqual(slewlab.files.pairs({"seed": None}), [("seed", "null")])
        self.assertEqual(slewlab.Scenario(scenario, {"crane.effects": None}).run(channels=["ENCODER"]).messages("ENCODER").tobytes(),
                         slewlab.Scenario(scenario).run(channels=["ENCODER"]).messages("ENCODER").tobytes())

    def test_a_wrong_argument_is_told_with_what_would_be_right(self):
        scenario, machine = slewlab.Scenario(SLEW, SHORT), slewlab.Machine(slewlab.config("cranes/thesis.yaml"))
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "short.lcmlog"
            scenario.run(log=log)
            (Path(folder) / "empty").mkdir()
            for wrong, error, words in (
                    (lambda: scenario.run("./mine"), TypeError, "found './mine' for a controller, expected a callable"),
                    (lambda: scenario.closed_loop("shaft_sped_1"), ValueError, "no output 'shaft_sped_1' here, expected 'shaft_speed_1'"),
                    (lambda: scenario.run(channels="SENSORS"), TypeError, "found 'SENSORS' for channels, expected a list of names: ['SENSORS']"),
                    (lambda: scenario.run_over_lcm(folder, lambda encoder, operator: [0.0]), TypeError, "expected a shell command; a callable goes with run()"),
                    (lambda: scenario.changed({"crane.load.mass": {"value": 3}}), TypeError, "crane.load.mass: found {'value': 3}, expected a number"),
                    (lambda: scenario.changed({"duration": None}), slewlab.InputError, "'duration'"),  # as --set duration=null
                    (lambda: slewlab.config("import_maps"), FileNotFoundError, "import_maps: expected one of acceptance, "),
                    (lambda: slewlab.config("crane/thesis.yaml"), FileNotFoundError, "expected 'cranes'"),
                    (lambda: machine.modes(elements=1000), ValueError, "found 1000 elements, expected 0 (a rigid boom) to 200"),
                    (lambda: scenario.open_loop([1.0, 60.0]), ValueError, "found a frequency of 60 Hz, expected at most 50 Hz"),
                    (lambda: machine.state_space().bode("tip_velocity", [-1.0]), ValueError, "found a frequency of -1 Hz, expected finite numbers above 0"),
                    (lambda: machine.state_space().bode("tip_velocity", [0.0, 1.0]), ValueError, "found a frequency of 0 Hz, expected finite numbers above 0"),
                    (lambda: slewlab.margins([1.0, 2.0], [1.0]), ValueError, "found 1 values at 2 frequencies"),
                    (lambda: slewlab.open_log(Path(folder) / "empty"), slewlab.LogError, "empty: found a folder without run.lcmlog"),
                    (lambda: list(slewlab.open_log(log).stretches("SENSOR")), KeyError, "expected 'SENSORS'")):
                with self.subTest(words=words), self.assertRaises(error) as raised:
                    wrong()
                self.assertIn(words, str(raised.exception))

    def test_a_log_is_gone_through_a_stretch_at_a_time(self):
        with tempfile.TemporaryDirectory() as folder:
            run = slewlab.Scenario(SLEW, {"duration": 60, "telemetry.sensors_period": "1 ms"}).run(log=Path(folder) / "run.lcmlog")
            log = slewlab.open_log(folder)
            for channels in ((), ("SENSORS",)):
                pieces = {}
                for stretch in log.stretches(*channels):
                    for name, messages in stretch.items():
                        pieces.setdefault(name, []).append(messages)
                self.assertEqual(set(pieces), set(channels or log.channels))
                self.assertGreater(len(pieces["SENSORS"]), 1)
                for name, parts in pieces.items():
                    np.testing.assert_array_equal(np.concatenate(parts), run.messages(name))

    def test_a_wrong_key_is_named_with_the_near_one(self):
        with self.assertRaisesRegex(slewlab.InputError, "load.mas.*'mass'"):
            slewlab.Scenario(SLEW, {"crane.load.mas": "3 t"})
        with self.assertRaisesRegex(FileNotFoundError, "expected 'thesis.yaml'"):
            slewlab.config("cranes/thesi.yaml")

    def test_check_says_what_the_command_says(self):
        self.assertEqual(slewlab.Machine(slewlab.config("cranes/thesis.yaml")).check(), [])
        with self.assertRaises(slewlab.InputError) as raised:
            slewlab.check(SLEW, {"crane.drive.groups": 1})
        self.assertIn("a controller for 2 motor group(s), expected one for the crane's 1", str(raised.exception))
        warnings = slewlab.check(SLEW, {"crane.load.rope_length": "2 km"})
        self.assertEqual(len(warnings), 1)
        self.assertIn("'crane.load.rope_length'", warnings[0])

    def test_values_say_where_they_stand(self):
        crane = slewlab.Machine(slewlab.config("cranes/thesis.yaml"), {"load.mass": "60 t"})
        mass = crane.values.loc["load.mass"]
        self.assertEqual((mass["value"], mass["unit"], mass["source"]), ("60", "t", "command line"))
        length = crane.values.loc["boom.length"]
        line = Path(length["file"]).read_text().splitlines()[length["line"] - 1]
        self.assertIn(f"length: {{value: {length['value']}", line)

    def test_units_are_those_of_the_files(self):
        self.assertAlmostEqual(slewlab.factor("deg", "rad"), np.pi / 180, places=15)
        self.assertAlmostEqual(slewlab.factor("rpm", "deg/s"), 6.0, places=12)
        with self.assertRaisesRegex(ValueError, "'kg' is no unit of this quantity, expected one of m, mm"):
            slewlab.factor("kg", "m")


STILL = {"crane.drive.gearbox_play": "0 deg", "crane.drive.pinion_play": "0 deg", "duration": 3}
LATE = ('[{effect: dead_time, delay: {value: 15, unit: ms, source: test}}, {effect: encoder_delay, delay: {value: 8, unit: ms, source: test}}]')


def last_torque(scenario, gain):
    """[N m] How far the torque still swings, 2.5 s after a push of 0.5 N m, with a gain [N m s/rad] on the shaft speed."""
    def push_then_damp(encoder, operator):
        push = 0.5 if encoder.time < 0.02 else 0.0
        return [float(np.clip(push - gain * speed, -250.0, 250.0)) for speed in encoder.shaft_speed]

    return scenario.run(push_then_damp, channels=["TORQUE"])["TORQUE"].motor_torque_1.loc[2.5:].abs().max()


class ControlTest(unittest.TestCase):
    def test_the_gain_margin_is_where_the_simulation_becomes_unstable(self):
        # With a gain of 1 the margin is the gain itself at which a run that is a twentieth above rings up, and one a twentieth below dies out.
        for effects in ("[]", LATE):
            with self.subTest(effects=effects):
                scenario = slewlab.Scenario(SLEW, STILL | {"crane.effects": effects})
                frequencies = np.geomspace(0.05, scenario.highest_frequency, 4000)
                margins = slewlab.margins(frequencies, scenario.open_loop(frequencies, np.ones_like))
                limit = 10.0 ** (margins.gain / 20.0)
                self.assertLess(last_torque(scenario, 0.95 * limit), 0.5)
                self.assertGreater(last_torque(scenario, 1.05 * limit), 10.0)

    def test_the_sampled_loop_ends_at_half_the_rate_with_its_gain_margin(self):
        # Of the thesis's loop, discretised by scipy.signal.cont2discrete: gain 15.3 dB at 50 Hz.
        from scipy.signal import cont2discrete

        scenario = slewlab.Scenario(SLEW)
        plant, period = scenario.machine.state_space().part("shaft_speed_1"), scenario.controller_period
        a, b, c, _, _ = cont2discrete((plant.a, plant.b, plant.c, plant.d), period)
        found = scenario.margins()
        self.assertEqual(found.gain_frequency, 50.0)
        self.assertAlmostEqual(found.gain, -20 * np.log10(40.0 * abs((c @ np.linalg.solve(-np.eye(len(a)) - a, b))[0, 0])), delta=1e-6)
        self.assertAlmostEqual(found.gain, 15.3, delta=0.1)
        with self.assertRaisesRegex(ValueError, "at most 50 Hz"):
            scenario.bode([51.0])

    def test_a_delay_of_the_plant_is_one_of_its_sampled_response(self):
        # x' = u, held: y is a ramp. u that comes 2.3 periods late has done 0.7 T of its own period and 0.3 T of the one before, two periods on.
        system = slewlab.StateSpace(np.zeros((1, 1)), np.ones((1, 1)), np.ones((1, 1)), np.zeros((1, 1)), {"x": "-"}, {"u": "-"}, {"y": "-"})
        period, frequencies = 0.1, np.array([0.3, 2.0, 5.0])
        z = np.exp(2j * np.pi * frequencies * period)
        np.testing.assert_allclose(system.sampled_response(frequencies, period, 0.23)[:, 0, 0],
                                   period * (0.7 + 0.3 / z) / (z - 1) / z**2, rtol=1e-12)

    def test_the_filter_on_the_speed_takes_its_phase(self):
        # The step response of 1 / (1 + s T) after a period is 1 - exp(-period / T).
        plain, filtered = slewlab.Scenario(SLEW), slewlab.Scenario(SLEW, {"controller.speed_filter_time": "50 ms"})
        frequencies = np.array([0.1, 1.0, 20.0])
        z, kept = np.exp(2j * np.pi * frequencies * 0.01), np.exp(-0.01 / 0.05)
        np.testing.assert_allclose(filtered.open_loop(frequencies), plain.open_loop(frequencies) * (1 - kept) / (1 - kept / z), rtol=1e-12)
        self.assertAlmostEqual(filtered.margins().phase, 39.0, delta=0.1)  # 78.6 deg without
        # In the closed loop, which is continuous, the filter F stands in the way back: y = L / (1 + F L) r.
        loop = (plain.machine.state_space().part("shaft_speed_1").response(frequencies) * plain.speed_controller().response(frequencies))[:, 0, 0]
        back = 1.0 / (1.0 + 2j * np.pi * frequencies * 0.05)
        np.testing.assert_allclose(filtered.closed_loop().response(frequencies)[:, 0, 0], loop / (1.0 + back * loop), rtol=1e-6)

    def test_effects_that_the_loop_has_not_are_named(self):
        lag = ('[{effect: torque_lag, time_constant: {value: 20, unit: ms, source: test}, delay_share: {value: 0, unit: "-", source: test}}, '
               '{effect: dead_time, delay: {value: 5, unit: ms, source: test}}]')
        scenario = slewlab.Scenario(SLEW, {"crane.effects": lag})
        self.assertEqual(scenario.loop_leaves_out, ["torque_lag"])
        with self.assertWarnsRegex(UserWarning, "open_loop.. leaves out what the machine's effects do to it: torque_lag$"):
            scenario.open_loop([1.0])
        with self.assertWarnsRegex(UserWarning, "closed_loop.. leaves out .*: dead_time, torque_lag$"):
            scenario.closed_loop()

    def test_lists_do_as_arrays_and_a_step_has_units(self):
        scenario = slewlab.Scenario(SLEW)
        self.assertEqual(scenario.bode([1.0, 2.0]).attrs["units"]["phase"], "deg")
        answer = scenario.closed_loop("shaft_speed_1").step("shaft_speed_1", [0.0, 0.1, 0.2])
        self.assertEqual(answer.attrs["units"], {"shaft_speed_1": "rad/s", "time": "s"})

    def test_a_rigid_mode_stands_at_zero_in_words_too(self):
        crane = slewlab.Machine(slewlab.config("cranes/thesis.yaml"))
        self.assertEqual(repr(crane.modes(elements=200)[0]), "<Mode rigid 1, 0.000000 Hz>")

    def test_margins_of_an_integrator_with_a_delay(self):
        # L = k exp(-s T) / s: gain 1 at k rad/s, phase there -90 deg - k T; phase -180 deg at pi / (2 T), gain there 2 k T / pi.
        k, delay = 2.0, 0.1
        frequencies = np.geomspace(0.01, 10.0, 20001)
        s = 2j * np.pi * frequencies
        found = slewlab.margins(frequencies, k * np.exp(-s * delay) / s)
        self.assertAlmostEqual(found.phase, 90.0 - np.degrees(k * delay), delta=1e-3)
        self.assertAlmostEqual(found.phase_frequency, k / (2 * np.pi), delta=1e-5)
        self.assertAlmostEqual(found.gain, -20 * np.log10(2 * k * delay / np.pi), delta=1e-3)
        self.assertAlmostEqual(found.gain_frequency, 1 / (4 * delay), delta=1e-4)

    def test_the_closed_loop_is_the_open_one_closed(self):
        # y = L / (1 + L) r at every frequency; the closed loop is taken to be continuous, so the controller's period goes.
        scenario = slewlab.Scenario(SLEW, {"controller_period": "1 us", "plant_step": "1 us"})
        frequencies = np.geomspace(0.1, 30.0, 40)
        open_loop = scenario.open_loop(frequencies)
        closed = scenario.closed_loop("shaft_speed_1").response(frequencies)[:, 0, 0]
        np.testing.assert_allclose(closed, open_loop / (1 + open_loop), rtol=2e-3)

    def test_a_small_step_of_torque_moves_the_simulated_machine_as_the_linear_one(self):
        # Without play, load and brakes nothing is left that is not linear, and the step holds the torque as the simulation does.
        changes = {"crane.drive.gearbox_play": "0 deg", "crane.drive.pinion_play": "0 deg", "duration": 3, "controller_period": "1 ms",
                   "telemetry.sensors_period": "1 ms"}
        scenario = slewlab.Scenario(SLEW, changes)
        run = scenario.run(lambda encoder, operator: [5.0, 5.0])
        speed = run["ENCODER"].shaft_speed_1
        linear = scenario.machine.state_space().step("shaft_speed_1", speed.index.to_numpy(), 5.0)
        # Rope and rod swing by less than a degree; the fixed step's error at 1 ms is below a thousandth (docs/benchmarks.md).
        np.testing.assert_allclose(speed, linear, rtol=0, atol=2e-3 * np.abs(linear).max())

    def test_python_control_gets_the_same_system_with_its_names(self):
        import control

        system = slewlab.Machine(slewlab.config("cranes/thesis.yaml")).state_space()
        other = system.to_control()
        self.assertEqual((other.state_labels, other.input_labels, other.output_labels),
                         (list(system.states), list(system.inputs), list(system.outputs)))
        frequencies = np.geomspace(0.1, 30.0, 20)
        # Their response is (outputs, inputs, frequencies), over rad/s.
        theirs = control.frequency_response(other, 2 * np.pi * frequencies).complex
        np.testing.assert_allclose(np.moveaxis(theirs, 2, 0), system.response(frequencies), rtol=1e-6, atol=1e-9 * np.abs(theirs).max())

    def test_modes_are_the_state_matrix_eigenvalues(self):
        crane = slewlab.Machine(slewlab.config("cranes/thesis.yaml"))
        a = crane.state_space().a.copy()
        n = len(a) // 2
        squares = np.sort(np.linalg.eigvals(-a[n:, :n]).real)  # of M^-1 K: undamped
        frequencies = [mode.frequency for mode in crane.modes()]
        np.testing.assert_allclose(np.sqrt(squares[1:]) / (2 * np.pi), frequencies[1:], rtol=1e-6)


class SweepTest(unittest.TestCase):
    def test_every_combination_is_a_row_whatever_the_threads(self):
        scenario = slewlab.Scenario(SLEW, SHORT)
        over = {"crane.load.mass": ["10 t", "30 t"], "controller.ramp.curved_share": [0.0, 0.3]}
        tables = [slewlab.sweep(scenario, over, threads=threads, progress=False) for threads in (1, 3)]
        self.assertTrue(tables[0].equals(tables[1]))
        self.assertEqual(list(zip(tables[0]["crane.load.mass"], tables[0]["controller.ramp.curved_share"])),
                         [(10.0, 0.0), (10.0, 0.3), (30.0, 0.0), (30.0, 0.3)])
        self.assertEqual(tables[0].attrs["units"]["crane.load.mass"], "t")
        alone = slewlab.measures(scenario.changed({"crane.load.mass": "30 t", "controller.ramp.curved_share": 0.0}).run())
        self.assertEqual({name: tables[0][name][2] for name in alone}, alone)
        self.assertEqual(tables[0].attrs["units"]["peak_tip_acceleration"], "m/s^2")

    def test_the_first_rows_drawn_are_those_of_a_shorter_table(self):
        scenario = slewlab.Scenario(SLEW, {"duration": 2})
        draw = {"crane.load.mass": lambda random: f"{random.uniform(10, 40)} t"}
        short, long = (slewlab.monte_carlo(scenario, draw, runs, seed=5, progress=False) for runs in (2, 4))
        self.assertTrue(short.equals(long[:2]))
        self.assertEqual(len(set(long["crane.load.mass"])), 4)

    def test_one_value_is_one_run_and_one_number_one_column(self):
        scenario = slewlab.Scenario(SLEW, {"duration": 2})

        def end_angle(run):
            return run["SENSORS"].slew_angle.iloc[-1]

        table = slewlab.sweep(scenario, {"crane.load.mass": "10 t", "controller.ramp.curved_share": 0.1}, measure=end_angle, progress=False)
        self.assertEqual(table[["crane.load.mass", "controller.ramp.curved_share"]].values.tolist(), [[10.0, 0.1]])
        alone = scenario.changed({"crane.load.mass": "10 t", "controller.ramp.curved_share": 0.1}).run()
        self.assertEqual(table["end_angle"][0], end_angle(alone))
        self.assertIn("measured", slewlab.sweep(scenario, {"seed": 3}, measure=lambda run: 1, progress=False))
        for wrong, error, words in ((lambda: slewlab.sweep(scenario, {"seed": 3}, measure=lambda run: "fast", progress=False), TypeError, "measure: found 'fast'"),
                                    (lambda: slewlab.sweep(scenario, {"seed": []}, progress=False), ValueError, "seed: found no value"),
                                    (lambda: slewlab.sweep(scenario, {"seed": 3}, threads=-2, progress=False), ValueError, "found -2 workers, expected at least 1"),
                                    (lambda: slewlab.monte_carlo(scenario, {"seed": 3}, 2, seed=1, progress=False), TypeError,
                                     "seed: found 3, expected a function of a random generator"),
                                    (lambda: slewlab.monte_carlo(scenario, {}, 0, seed=1, progress=False), ValueError, "runs: found 0, expected at least 1")):
            with self.subTest(words=words), self.assertRaises(error) as raised:
                wrong()
            self.assertIn(words, str(raised.exception))

    def test_what_was_set_is_a_number_in_the_first_ones_unit_where_it_is_one(self):
        from slewlab.sweep import as_numbers

        self.assertEqual(as_numbers(["25.355 t", "500 kg"]), ([25.355, 0.5], "t"))
        self.assertEqual(as_numbers(["20 Nm", "1e3N m"]), ([20.0, 1000.0], "N m"))
        for others in (["2.yaml"], [1, 2], ["10 t", 3], ["10 t", "3 m"], ["s_curve"], [True]):
            self.assertEqual(as_numbers(others), (others, ""))

    def test_a_machine_without_a_load_has_no_sidelead(self):
        found = slewlab.measures(slewlab.Scenario(slewlab.config("scenarios/example_axis.yaml"), {"duration": 5}).run())
        self.assertIn("largest_motor_torque", found)
        self.assertNotIn("largest_sidelead", found)

    def test_peaks_are_those_of_the_report(self):
        # The demo's table in README.md, whose numbers run_numbers.py takes from the log of `slewlab run`.
        found = slewlab.measures(slewlab.Scenario(SLEW).run())
        readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
        self.assertIn(f"peak tip acceleration, after the stop                {found['peak_tip_acceleration']:.2f} m/s²", readme)
        self.assertIn(f"largest sidelead, after the stop                     {np.degrees(found['largest_sidelead']):.1f}°", readme)


class FigureTest(unittest.TestCase):
    def test_a_panel_for_every_channel_and_no_peak_is_lost(self):
        run = slewlab.Scenario(SLEW).run(channels=["SENSORS", "TORQUE"])
        figure = slewlab.overview(run, run, most_points=500)
        titles = [figure.layout[f"yaxis{number}"].title.text for number in ("", 3)]  # two columns: the odd axes are the first's
        self.assertEqual(titles, ["motor torque [N m]", "tip acceleration [m/s²]"])
        drawn = next(trace for trace in figure.data if trace.name == "tip_acceleration")
        self.assertLessEqual(len(drawn.y), 500)
        acceleration = run["SENSORS"].tip_acceleration
        self.assertEqual((max(drawn.y), min(drawn.y)), (acceleration.max(), acceleration.min()))


    def test_the_reports_figures_are_those_of_its_page(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            run_by_command(SLEW, {"duration": 33}, folder / "a")
            run_by_command(SLEW, {"duration": 33, "crane.load.mass": "20 t"}, folder / "b")
            logs = [slewlab.open_log(folder / name) for name in "ab"]
            pages = [report.views([read_run(folder / name) for name in names]) for names in ("a", "ab")]
            for drawn, page in zip((slewlab.report_figures(logs[0]), slewlab.report_figures(*logs)), pages, strict=True):
                self.assertEqual(list(drawn), list(page))
                for name, figure in drawn.items():
                    self.assertEqual(figure.to_json(), page[name][0].to_json())
            self.assertEqual(list(pages[1]), ["side by side", "over each other", "difference, A minus B"])
            # A run in this process has the same messages, and its machine's modes.
            own = slewlab.report_figures(slewlab.Scenario(SLEW, {"duration": 33}).run(), panels=["spectrum", "tip"])["picture"]
        titles = [axis.title.text for axis in own.select_yaxes()]
        self.assertEqual(titles, ["tip acceleration<br>[m/s²]", "spectrum before the stop<br>[m/s²]", "spectrum after the stop<br>[m/s²]"])
        whole = pages[0]["picture"][0]
        for name in ("tip", "house"):
            mine, theirs = ([trace.y for trace in figure.data if trace.name == name] for figure in (own, whole))
            np.testing.assert_array_equal(mine[-1], theirs[-1])
        modes = [{each.text for each in figure.layout.annotations if each.name == "mode"} for figure in (own, whole)]
        self.assertEqual(*modes)
        self.assertTrue(modes[0])

    def test_nothing_to_draw_is_said(self):
        run = slewlab.Scenario(SLEW, {"duration": 1}).run(channels=["PLANT_STATUS"])
        for draw in (slewlab.overview, slewlab.report_figures):
            for given, error, words in (((), TypeError, "found no run, expected at least one"), ((run,), ValueError, "found nothing to draw"),
                                        (("run.lcmlog",), TypeError, "found 'run.lcmlog', expected a run or a log; open_log()")):
                with self.subTest(draw=draw, words=words), self.assertRaises(error) as raised:
                    draw(*given)
                self.assertIn(words, str(raised.exception))
        with self.assertRaisesRegex(ValueError, "no panel 'spectra' here"):
            slewlab.report_figures(slewlab.Scenario(SLEW, {"duration": 1}).run(), panels=["spectra"])


class DiagnosisTest(unittest.TestCase):
    def test_the_friction_that_was_put_in_comes_out_as_an_object(self):
        # 40 N m of dry friction, which the nominal axis has not; play and a gearbox that gives are left to the laws' sizes: 5 %.
        friction = ('[{effect: bearing_coulomb, torque: {value: 40, unit: N m, source: test}, '
                    'asymmetry: {value: 0, unit: "-", source: test}, give: {value: 0, unit: rad, source: test}}]')
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a_run").mkdir()
            logs = [Path(folder) / "a_run" / "run.lcmlog", Path(folder) / "fast.lcmlog"]
            for log, request in zip(logs, (0.3, 0.5), strict=True):
                changes = {"axis.effects": friction, "operator.0.speed_request": request}
                slewlab.Scenario(slewlab.config("scenarios/example_axis.yaml"), changes).run(log=log)
            # A log may be named by the folder of its run.
            found = slewlab.diagnose(slewlab.config("axes/example_axis.yaml"), [logs[0].parent, logs[1]])
            self.one_log_and_a_machine(logs, Path(folder) / "found")
            self.options_of_the_command(logs)
        self.assertTrue(found.gap)
        self.assertIsNone(found.folder)
        self.assertIn("dry", found.causes[0].effects)
        self.assertTrue(found.causes[0].validated)
        size = next(size for size in found.causes[0].sizes if size.parameter == "dry")
        self.assertAlmostEqual(size.value, 40.0, delta=2.0)
        self.assertLess(size.low, size.value)
        self.assertEqual(size.unit, "N m")
        self.assertIsInstance(size, slewlab.Size)
        self.assertEqual((found.action, found.is_stated, found.explained_share), tuple(found.raw[key] for key in ("action", "is_stated", "explained_share")))
        self.assertIn("axis_with_effect.yaml", found.action)
        self.assertEqual((found.remainder.share, found.remainder.follows), (found.raw["unexplained_share"], found.raw["remainder"]["follows"]))
        with self.assertRaisesRegex(slewlab.ProgramFailed, "nothing_there.lcmlog"):
            slewlab.diagnose(slewlab.config("axes/example_axis.yaml"), "nothing_there.lcmlog")

    def one_log_and_a_machine(self, logs, out):
        # An inertia of its own: the file with the effect stands upon it, beside the findings.
        machine = slewlab.Machine(slewlab.config("axes/example_axis.yaml"))
        inertia = machine.values.loc["inertia"]
        changed = machine.changed({"inertia": f"{1.01 * float(inertia['value'])} {inertia['unit']}"})
        slewlab.diagnose(changed, slewlab.open_log(logs[1]), out=out)
        self.assertEqual(slewlab.Machine(out / "machine.yaml").values.loc["inertia"]["value"], changed.values.loc["inertia"]["value"])
        self.assertIn("include: machine.yaml\n", (out / "axis_with_effect.yaml").read_text())
        one = slewlab.diagnose(machine, str(logs[1]))
        self.assertEqual(one.raw, slewlab.diagnose(machine.path, [logs[1]]).raw)

    def options_of_the_command(self, logs):
        axis = slewlab.config("axes/example_axis.yaml")
        found = slewlab.diagnose(axis, logs[0], unseen=logs[1], without=["dry"])
        self.assertEqual([Path(told["log"]).name for told in found.raw["unseen"]], [logs[1].name])
        self.assertNotIn("dry", [effect for cause in found.causes for effect in cause.effects])
        stretch = slewlab.diagnose(axis, logs[0], fitted_seconds=5)
        self.assertTrue(any("are fitted, where most moves" in remark for remark in stretch.raw["remarks"]), stretch.raw["remarks"])
        self.assertRegex(stretch.raw["unseen"][0]["log"], r" [\d.]+ to [\d.]+ s$")
        with self.assertRaisesRegex(slewlab.ProgramFailed, "expected no --measured-torque beside an axis"):
            slewlab.diagnose(axis, logs, measured_torque=True)

    def test_records_that_cannot_tell_are_an_exception_with_the_reasons(self):
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "run.lcmlog"
            slewlab.Scenario(SLEW, SHORT).run(log=log)
            machine = slewlab.Machine(slewlab.config("cranes/thesis.yaml"), {"drive.groups": 1})
            with self.assertRaises(slewlab.CannotTell) as raised:
                slewlab.diagnose(machine, log, out=Path(folder) / "found")
            self.assertEqual(raised.exception.code, 3)
            self.assertEqual(len(raised.exception.reasons), 1)
            self.assertIn("the log has 2 motor groups, the nominal crane 1", raised.exception.reasons[0])
            self.assertFalse((Path(folder) / "found").exists())

    def test_what_is_no_file_is_refused_by_its_type(self):
        machine, scenario = slewlab.Machine(slewlab.config("cranes/thesis.yaml")), slewlab.Scenario(SLEW, SHORT)
        for wrong, words in ((lambda: slewlab.diagnose(scenario, "a.lcmlog"), "expected the path of a crane's or an axis's file, or a Machine"),
                             (lambda: slewlab.diagnose(machine, scenario.run()), "run(log=PATH) writes one"),
                             (lambda: slewlab.diagnose(machine, "a.lcmlog", controller=machine), "expected the path of a controller's file"),
                             (lambda: slewlab.diagnose(machine, "a.lcmlog", without="load_mass"), "expected a list of effects"),
                             (lambda: slewlab.diagnose(machine, "a.lcmlog", unseen=scenario.run()), "run(log=PATH) writes one"),
                             (lambda: slewlab.Machine(machine), "expected the path of a crane's or an axis's file"),
                             (lambda: slewlab.Scenario(scenario), "expected the path of a scenario's file"),
                             (lambda: slewlab.check(machine), "expected the path of a file of slewlab")):
            with self.subTest(words=words), self.assertRaises(TypeError) as raised:
                wrong()
            self.assertIn(words, str(raised.exception))

    def test_a_folder_without_findings_is_said(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(FileNotFoundError, "found no diagnosis.json there, expected the folder of a finished"):
            slewlab.read_diagnosis(folder)

    def test_a_machine_with_changes_becomes_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            machine = slewlab.Machine(slewlab.config("cranes/thesis.yaml"), {"load.mass": "60 t", "boom.angle": "40 deg", "drive.groups": 1})
            again = slewlab.Machine(machine.write(Path(folder) / "machine.yaml"))
            self.assertEqual([mode.frequency for mode in again.modes()], [mode.frequency for mode in machine.modes()])
            self.assertEqual(again.group_count, 1)


# What an installed package is asked for, in a process that sees no other slewlab: it prints its version and where its scenario lies.
RUN_AND_DIAGNOSE = """
import pathlib, slewlab
print(slewlab.__version__, slewlab.config("scenarios/example_axis.yaml"))
scenario = slewlab.Scenario(slewlab.config("scenarios/example_axis.yaml"), {"duration": 30})
scenario.run_over_lcm("run")
found = slewlab.diagnose(slewlab.config("axes/example_axis.yaml"), ["run"], out="found")
assert found.answer and pathlib.Path("found/diagnosis.html").is_file(), found
"""


# What a caller may write: a class, an object of it, an answer by numpy, lists of numbers.
TYPED = """
import numpy as np
import slewlab

class Still:
    def __call__(self, encoder: slewlab.Encoder, operator: slewlab.Operator) -> np.ndarray:
        return np.zeros(encoder.group_count)

def answered(encoder: slewlab.Encoder, operator: slewlab.Operator) -> slewlab.Answer:
    return slewlab.Answer([0.0] * encoder.group_count)

scenario = slewlab.Scenario("scenario.yaml", {"duration": None})
for controller in (Still, Still(), answered, lambda encoder, operator: [0.0, 0.0]):
    scenario.run(controller)
found: slewlab.Margins = slewlab.margins([1.0, 2.0], scenario.open_loop([1.0, 2.0], lambda z: 20.0))
version: str = slewlab.__version__
sizes: list[slewlab.Size] = [size for cause in slewlab.read_diagnosis("findings").causes for size in cause.sizes]
for stretch in slewlab.open_log("run.lcmlog").stretches("SENSORS"):
    messages: np.ndarray = stretch["SENSORS"]
"""


@unittest.skipUnless((messages_folder() / "slewlab" / "_core.pyi").is_file(), "a build with a sanitizer makes no stubs")
class TypesTest(unittest.TestCase):
    def mypy(self, folder, *what):
        words = [sys.executable, "-m", "mypy", "--config-file", REPOSITORY / "pyproject.toml", "--cache-dir", folder, *what]
        ended = subprocess.run(words, cwd=folder, env=os.environ | {"MYPYPATH": str(messages_folder())}, stdin=subprocess.DEVNULL,
                               capture_output=True, text=True, check=False, timeout=100)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)

    def test_the_package_and_its_stubs_hold_what_they_say(self):
        with tempfile.TemporaryDirectory() as folder:
            self.mypy(folder, messages_folder() / "slewlab")
            (Path(folder) / "caller.py").write_text(TYPED)
            self.mypy(folder, "--strict-optional", "--check-untyped-defs", "caller.py")
        self.assertFalse([name for name in slewlab.__all__ if not hasattr(slewlab, name)])


@unittest.skipIf(IS_SANITIZED, "what is installed is not sanitized")
class InstallTest(unittest.TestCase):
    def install(self, component, prefix):
        subprocess.run(["cmake", "--install", messages_folder().parent, "--component", component, "--prefix", prefix],
                       check=True, capture_output=True, timeout=100)

    def test_the_package_stands_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            self.install("python", folder)
            place = Path(folder) / "lib" / "python3" / "dist-packages"
            for name in ("py.typed", "_core.pyi", "_log.pyi", "share/slewlab/config/cranes/thesis.yaml"):
                self.assertTrue((place / "slewlab" / name).is_file(), name)
            for name in ("_core", "_log"):
                extension = next((place / "slewlab").glob(f"{name}*.so")).read_bytes()
                self.assertNotIn(str(REPOSITORY).encode(), extension)
            code = ("import slewlab; print(slewlab.__version__, slewlab.config('cranes/thesis.yaml')); "
                    "run = slewlab.Scenario(slewlab.config('scenarios/thesis_slew.yaml'), {'duration': 1}).run(log='run.lcmlog'); "
                    "open('run.json', 'w').write('{}'); log = slewlab.open_log('run.lcmlog'); "
                    "assert run['ENCODER'].attrs['units'] == log['ENCODER'].attrs['units']; assert 'units are those of a crane' in log.remarks[-1]")
            ended = subprocess.run([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(place)}, cwd=folder,
                                   capture_output=True, text=True, check=False, timeout=100)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertEqual(ended.stdout.split(),
                             [slewlab.__version__, str(place / "slewlab" / "share" / "slewlab" / "config" / "cranes" / "thesis.yaml")])

    def test_a_wheel_runs_over_lcm_diagnoses_and_is_the_command(self):
        # A wheel is the package with the component `programs` in its own folder (pyproject.toml), and no other slewlab in PATH.
        with tempfile.TemporaryDirectory() as folder:
            self.install("python", folder)
            place = Path(folder) / "lib" / "python3" / "dist-packages"
            self.install("programs", place / "slewlab")
            shutil.rmtree(place / "slewlab" / "share" / "slewlab" / "python" / "slewlab")  # which a wheel leaves out
            alone = {"PATH": "/usr/bin:/bin", "PYTHONPATH": str(place), "HOME": folder}
            ended = subprocess.run([sys.executable, "-c", RUN_AND_DIAGNOSE], env=alone, cwd=folder, capture_output=True, text=True, check=False, timeout=100)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertEqual(ended.stdout.split()[:2],
                             [slewlab.__version__, str(place / "slewlab" / "share" / "slewlab" / "config" / "scenarios" / "example_axis.yaml")])
            command = [sys.executable, "-c", "from slewlab.program import main; main()"]
            for words in (["--version"], ["report", "run"], ["export", "run", "--format", "csv"]):
                ended = subprocess.run([*command, *words], env=alone, cwd=folder, capture_output=True, text=True, check=False, timeout=100)
                self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            self.assertTrue((Path(folder) / "run" / "run_csv" / "ENCODER.csv").is_file())

    def test_without_the_program_the_error_says_what_to_install(self):
        with tempfile.TemporaryDirectory() as folder:
            self.install("python", folder)
            place = Path(folder) / "lib" / "python3" / "dist-packages"
            code = "import slewlab; slewlab.diagnose(slewlab.config('cranes/thesis.yaml'), ['a.lcmlog'])"
            ended = subprocess.run([sys.executable, "-c", code], env={"PATH": folder, "PYTHONPATH": str(place)}, cwd=folder,
                                   capture_output=True, text=True, check=False, timeout=100)
            self.assertIn("install the wheel or the Debian package (docs/install.md), or name it in SLEWLAB_PROGRAM", ended.stderr)


class PageTest(unittest.TestCase):
    def test_every_block_of_the_page_runs(self):
        page = (REPOSITORY / "docs" / "python.md").read_text(encoding="utf-8")
        blocks = [block.split("```")[0] for block in page.split("```python\n")[1:]]
        self.assertEqual(len(blocks), 8)
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                names = {"print": lambda *words: None}
                for block in blocks:
                    exec(compile(block, "docs/python.md", "exec"), names)
            finally:
                os.chdir(here)


if __name__ == "__main__":
    unittest.main()
