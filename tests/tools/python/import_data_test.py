"""Import against made-up data whose log is known in closed form: theta(t) = A sin(w t) and its rates."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import mcap.writer
import numpy as np
import pandas as pd

import export
import import_data
import report
from desk import charts
from desk.source import Recorded
from run_log import read_run_log, seconds
from run_numbers import facts_beside

RATIO = 2735.58
A, W = 0.02, 2 * np.pi * 0.5  # [rad], [rad/s] of the crane
MAP = """kind: import_map
description: a crane with two groups
time: {column: t, unit: ms, origin: first_row}
rate: {value: 100, unit: Hz, source: made up}
shaft_position:
  - {column: angle_1, unit: deg, ratio: {value: 2735.58, unit: "-", source: made up}}
  - {column: angle_2, unit: deg, ratio: {value: 2735.58, unit: "-", source: made up}, sign: -1}
shaft_speed:
  - {column: speed_1, unit: rpm}
  - {derive: central_difference}
motor_torque:
  - column: torque_1
    unit: kN m
    ratio: {value: 2735.58, unit: "-", source: made up}
    motors: 3
  - {column: torque_2, unit: N m, scale: {value: 50, unit: "-", source: "N m per volt"}, offset: {value: 2, unit: N m, source: zero}}
tip_acceleration: {column: tip, unit: mm/s^2}
slew_angle: {column: slew, unit: deg}
speed_request: {column: wish, unit: "%"}
emergency_stop: {column: stop, inverted: true}
"""


def table(rows=501, step=0.01):
    t = step * np.arange(rows)
    angle = np.degrees(A * np.sin(W * t))
    return pd.DataFrame({
        "t": 5000.0 + 1e3 * t, "angle_1": angle, "angle_2": -angle,
        "speed_1": A * W * np.cos(W * t) * RATIO * 60 / (2 * np.pi),
        "torque_1": 0.3 * np.cos(W * t), "torque_2": 2.0 + np.cos(W * t), "tip": 1e3 * np.sin(t), "slew": angle,
        "wish": np.where(t < 1.0, 0.0, 80.0), "stop": np.where(t < 4.0, 1, 0)})


class ImportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.out = self.folder / "a.lcmlog"

    def call(self, data, text=MAP, suffix="csv", write=None):
        file = self.folder / f"data.{suffix}"
        if write is not None:
            write(file)
        elif suffix == "csv":
            data.to_csv(file, index=False)
        else:
            data.to_parquet(file, index=False)
        (self.folder / "map.yaml").write_text(text)
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = import_data.main(["--map", str(self.folder / "map.yaml"), str(file), "--out", str(self.out)])
        self.said = out.getvalue()
        return code, err.getvalue().replace(str(self.folder) + "/", "")

    def refused(self, data, *parts, text=MAP, **options):
        """Nothing is written, and the message holds the parts."""
        code, error = self.call(data, text, **options)
        self.assertNotEqual(code, 0)
        for part in parts:
            self.assertIn(part, error)
        self.assertEqual([f.name for f in self.folder.iterdir() if "lcmlog" in f.name], [])
        return error

    def check_log(self):
        log = read_run_log(self.out)
        encoder, torque = log.channel("ENCODER"), log.channel("TORQUE")
        t = 0.01 * np.arange(501)
        np.testing.assert_array_equal(encoder["simulated_time"], np.arange(501) * 10_000_000)
        np.testing.assert_array_equal(torque["answered_sequence"], encoder["sequence"])
        position, speed = RATIO * A * np.sin(W * t), RATIO * A * W * np.cos(W * t)
        for group in (0, 1):
            np.testing.assert_allclose(encoder["shaft_position"][:, group], position, atol=1e-9)
        np.testing.assert_allclose(encoder["shaft_speed"][:, 0], speed, rtol=1e-12, atol=1e-12)
        # The central difference of A sin(wt) is the speed times sin(wT)/(wT).
        np.testing.assert_allclose(encoder["shaft_speed"][1:-1, 1], speed[1:-1] * np.sin(W * 0.01) / (W * 0.01), atol=1e-8)
        # 0.3 kN m of three motors on the slew axis; 50 N m per unit above an offset of 2.
        np.testing.assert_allclose(torque["motor_torque"][:, 0], 300 / RATIO / 3 * np.cos(W * t), atol=1e-12)
        np.testing.assert_allclose(torque["motor_torque"][:, 1], 50 * np.cos(W * t), atol=1e-12)
        sensors = log.channel("SENSORS")
        np.testing.assert_allclose(sensors["tip_acceleration"], np.sin(t), atol=1e-12)
        np.testing.assert_allclose(sensors["slew_angle"], A * np.sin(W * t), atol=1e-14)
        self.assertTrue(np.isnan(sensors["house_acceleration"]).all())
        moves = log.channel("OPERATOR")
        np.testing.assert_allclose(seconds(moves), [0.0, 1.0, 4.0])
        np.testing.assert_allclose(moves["speed_request"], [0.0, 0.8, 0.8])
        np.testing.assert_array_equal(moves["emergency_stop"], [False, False, True])
        np.testing.assert_array_equal(encoder["operator_sequence"], np.repeat([0, 1, 2], [100, 300, 101]))

    def test_csv_becomes_the_log_that_the_map_says(self):
        self.assertEqual(self.call(table()), (0, ""))
        self.check_log()

    def test_more_columns_than_any_recorder_has_are_refused(self):
        """A table turned on its side, rows for columns: refused by its line of names, before its values are read."""
        wide = lambda count: lambda file: file.write_text(",".join(f"c{k}" for k in range(count)) + "\nno number\n")
        self.refused(None, "data.csv: found 20000 columns, expected one row per moment and at most 10000 columns", write=wide(20_000))
        self.refused(None, "data.csv: the line of column names has more than 2000000 characters", write=wide(1_000_000))

    def test_the_runs_identity_is_what_the_file_holds(self):
        def identities(data):
            self.assertEqual(self.call(data), (0, ""))
            log = read_run_log(self.out)
            return {int(one) for name in ("ENCODER", "TORQUE", "OPERATOR", "SENSORS") for one in log.channel(name)["run_identity"]}

        other = table()
        other.iloc[7, other.columns.get_loc("tip")] += 1e-3
        first, again, changed = identities(table()), identities(table()), identities(other)
        self.assertEqual(len(first), 1)
        self.assertEqual(first, again)
        self.assertEqual(len(changed), 1)
        self.assertNotEqual(first, changed)
        self.assertNotIn(0, first | changed)

    def test_parquet_becomes_the_same_log(self):
        self.assertEqual(self.call(table(), suffix="parquet"), (0, ""))
        self.check_log()

    def test_csv_of_a_european_plc(self):
        text = MAP.replace("time:", 'csv: {separator: ";", decimal: ",", skip_lines: 2}\ntime:')

        def write(file):
            file.write_text("PLC 7\nexported\n" + table().to_csv(index=False, sep=";", decimal=","))

        self.assertEqual(self.call(None, text, write=write), (0, ""))
        self.check_log()

    def test_dates_as_times(self):
        data = table()
        data["t"] = pd.Timestamp("2026-11-21T02:00:00") + pd.to_timedelta(0.01 * np.arange(501), unit="s")
        for suffix in ("csv", "parquet"):
            self.assertEqual(self.call(data, MAP.replace("unit: ms", "unit: datetime"), suffix=suffix), (0, ""))
            self.check_log()

    def test_time_from_another_origin(self):
        late = MAP.replace("origin: first_row", "origin: {value: 4, unit: s, source: trigger}")
        code, error = self.call(table(), late)
        self.assertEqual((code, error), (0, ""))
        times = read_run_log(self.out).channel("ENCODER")["simulated_time"]
        self.assertEqual(times[0], 1_000_000_000)  # the first row is at 5000 ms
        self.assertEqual(times[-1], 6_000_000_000)
        self.out.unlink()
        self.refused(table(), "origin", "before the origin", text=MAP.replace("origin: first_row", "origin: {value: 6, unit: s, source: trigger}"))

    def test_linear_axis(self):
        # x = 0.1 t^2 [m] under 20 N with 5 mm per radian: angle 20 t^2, speed 40 t exactly, torque 0.1 N m.
        text = """kind: import_map
time: {column: t, unit: s}
shaft_position: [{column: x, unit: mm, metres_per_radian: {value: 5, unit: mm, source: screw}}]
shaft_speed: {derive: DERIVE}
motor_torque: [{column: f, unit: kN, metres_per_radian: {value: 5, unit: mm, source: screw}}]
"""
        t = 0.001 * np.arange(2001)
        data = pd.DataFrame({"t": t, "x": 100 * t**2, "f": 0.02})
        late = {"central_difference": 0.0, "two_sample_mean": 1e-3, "backward_difference": 0.5e-3}
        for derive, delay in late.items():
            self.assertEqual(self.call(data, text.replace("DERIVE", derive)), (0, ""))
            log = read_run_log(self.out)
            np.testing.assert_allclose(log.channel("ENCODER")["shaft_position"][:, 0], 20 * t**2, atol=1e-9)
            np.testing.assert_allclose(log.channel("ENCODER")["shaft_speed"][2:-1, 0], 40 * (t[2:-1] - delay), atol=1e-8)
            np.testing.assert_allclose(log.channel("TORQUE")["motor_torque"][:, 0], 0.1, rtol=1e-12)
            self.assertIn(derive, self.said)

    def test_the_angle_between_groups_is_kept(self):
        data = table()
        data["angle_1"] += 40.0
        data["angle_2"] -= 40.01  # its sign is -1: 0.01 deg of the crane ahead
        self.assertEqual(self.call(data), (0, ""))
        self.assertIn("shaft_position[1] begins at", self.said)
        self.assertNotIn("shaft_position[2] begins at", self.said)
        position = read_run_log(self.out).channel("ENCODER")["shaft_position"]
        self.assertEqual(position[0, 0], 0.0)
        np.testing.assert_allclose(position[:, 1] - position[:, 0], np.radians(0.01) * RATIO, atol=1e-8)

    AXIS = """kind: axis
coordinate: {value: COORDINATE, source: test}
rated_torque: {value: 5, unit: N m, source: test}
load_encoder: {value: true, source: test}
"""
    LINEAR_AXIS = AXIS.replace("COORDINATE", "linear") + """travel_per_turn: {value: 4, unit: mm, source: test}
mass: {value: 20, unit: kg, source: test}
top_speed: {value: 1, unit: m/s, source: test}
"""

    def test_an_axis_in_its_own_units(self):
        # 4 mm per turn: x = 1 mm t^2 of the carriage is pi/2 t^2 [rad] of the motor; 100 N are 0.2 / pi N m.
        (self.folder / "axis.yaml").write_text(self.LINEAR_AXIS)
        text = """kind: import_map
machine: axis.yaml
time: {column: t, unit: s}
shaft_position: {column: x, unit: mm}
shaft_speed: {derive: central_difference}
motor_torque: {column: f, unit: N}
load_position: {column: scale, unit: um}
""".replace("unit: um", "unit: mm")
        t = 0.01 * np.arange(101)
        data = pd.DataFrame({"t": t, "x": 5.0 + t**2, "f": 100.0 + 0 * t, "scale": 7.0 + t**2})
        self.assertEqual(self.call(data, text), (0, ""))
        log = read_run_log(self.out)
        turns = 2 * np.pi / 0.004
        np.testing.assert_allclose(log.channel("ENCODER")["shaft_position"][:, 0], turns * (5e-3 + 1e-3 * t**2), rtol=1e-12)
        np.testing.assert_allclose(log.channel("TORQUE")["motor_torque"][:, 0], 100.0 / turns, rtol=1e-12)
        np.testing.assert_allclose(log.channel("SENSORS")["slew_angle"], 7e-3 + 1e-3 * t**2, rtol=1e-12)
        self.assertIn("load_position: 0.007 ... 0.008 m", self.said)
        self.assertIn("N m", self.said)
        self.refused_axis(data, text.replace("unit: mm}\nshaft_speed", "unit: mm, on: shaft}\nshaft_speed"), "mm on the shaft", "rad")
        self.refused_axis(data, text.replace("unit: N}", "unit: N, metres_per_radian: {value: 1, unit: mm, source: x}}"), "on: axis")

    def test_units_that_this_machine_cannot_have_are_warned_of(self):
        # The machine of 1 m/s and 5 N m at 4 mm per turn goes 0.25 m/s and 4 kN at its carriage here.
        (self.folder / "axis.yaml").write_text(self.LINEAR_AXIS)
        right = """kind: import_map
machine: axis.yaml
time: {column: t, unit: s}
shaft_position: {column: x, unit: mm}
shaft_speed: {column: v, unit: mm/s}
motor_torque: {column: f, unit: N}
"""
        t = 0.01 * np.arange(101)
        data = pd.DataFrame({"t": t, "x": 125.0 * t**2, "v": 250.0 * t, "f": 4000.0 + 0 * t})
        self.assertEqual(self.call(data, right), (0, ""))
        self.assertNotIn("unlikely", self.said)
        for wrong, column, unit, fits in (("{column: x, unit: m}", "x", "m", "mm"), ("{column: v, unit: m/s}", "v", "m/s", "mm/s"),
                                          ("{column: f, unit: kN}", "f", "kN", "N")):
            with self.subTest(wrong):
                line = next(each for each in right.splitlines() if f"column: {column}," in each)
                code, said = self.call(data, right.replace(line, line.split(":")[0] + ": " + wrong))
                self.assertEqual(code, 0)
                self.assertIn(f"column '{column}' in {unit}: ", said)
                self.assertRegex(said, f"; .*{fits}.* would fit")
                self.assertIn("(unlikely of this machine, see the warning)", self.said)
                self.assertIn("; 1 signals unlikely of this machine", self.said)
        # The other way round: numbers in m and kN, named mm and N.
        small = data.assign(x=data.x / 1000 / 4, f=data.f / 1e4)
        _, said = self.call(small, right)
        self.assertRegex(said, "column 'x' in mm: .* only .* of the machine's travel .*; .*m would fit")
        self.assertRegex(said, "column 'f' in N: .* only .*; .*kN would fit")
        _, said = self.call(data.assign(f=0.0), right)
        self.assertEqual(said, "")

    def refused_axis(self, data, text, *parts):
        self.out.unlink(missing_ok=True)
        self.refused(data, *parts, text=text)

    def test_an_angle_of_axis_or_shaft_must_be_said(self):
        axis = self.AXIS.replace("COORDINATE", "rotary") + (
            "ratio: {value: 50, unit: \"-\", source: test}\ninertia: {value: 3, unit: kg m^2, source: test}\n"
            "top_speed: {value: 2, unit: rad/s, source: test}\n")
        (self.folder / "axis.yaml").write_text(axis)
        text = """kind: import_map
machine: axis.yaml
time: {column: t, unit: s}
shaft_position: {column: x, unit: deg, on: axis}
shaft_speed: {column: v, unit: rad/s, on: shaft}
motor_torque: {column: f, unit: N m, on: axis}
"""
        t = 0.01 * np.arange(101)
        data = pd.DataFrame({"t": t, "x": 90.0 * t, "v": 78.5 + 0 * t, "f": 100.0 + 0 * t})
        self.assertEqual(self.call(data, text), (0, ""))
        log = read_run_log(self.out)
        np.testing.assert_allclose(log.channel("ENCODER")["shaft_position"][:, 0], 50 * np.pi / 2 * t, rtol=1e-12)
        np.testing.assert_allclose(log.channel("ENCODER")["shaft_speed"][:, 0], 78.5)
        np.testing.assert_allclose(log.channel("TORQUE")["motor_torque"][:, 0], 2.0)
        self.refused_axis(data, text.replace("deg, on: axis", "deg"), "map.yaml:4:", "axis or shaft: deg may be either")
        (self.folder / "axis.yaml").write_text(axis.replace("value: true", "value: false"))
        self.refused_axis(data, text + "load_position: {column: x2, unit: deg}\n", "load_encoder")
        (self.folder / "axis.yaml").write_text(axis.replace("kind: axis", "kind: crane"))
        self.refused_axis(data, text, "axis.yaml:1:", "kind")

    def test_uneven_times_are_refused_and_with_resample_made_even(self):
        data = table().drop(index=[200, 201]).reset_index(drop=True)
        self.refused(data, "map.yaml:3:16: key 'time.column'", "30 ms between data row 200 (line 201) and the next where "
                     "10 ms is usual", "resample: linear")
        self.assertEqual(self.call(data, MAP + "resample: linear\n"), (0, ""))
        encoder = read_run_log(self.out).channel("ENCODER")
        self.assertEqual(len(encoder), 501)
        t = 0.01 * np.arange(501)
        # A chord over 30 ms misses the sine by (wT)^2 / 8 of its size at most.
        np.testing.assert_allclose(encoder["shaft_position"][:, 0], RATIO * A * np.sin(W * t),
                                   atol=RATIO * A * (W * 0.03)**2 / 8)
        torque = read_run_log(self.out).channel("TORQUE")["motor_torque"][:, 1]
        np.testing.assert_array_equal(torque[199:202], torque[199])  # a command holds

    def test_averages_when_the_rate_falls(self):
        text = MAP.replace("value: 100,", "value: 10,")
        self.refused(table(), "map.yaml:4:7: key 'rate': found rows 10 ms apart, 100 Hz", "resample: linear or mean", text=text)
        self.refused(table(), "folds", text=text + "resample: linear\n")
        data = table()
        data["tip"] += 1e3 * (-1.0) ** np.arange(501)  # at half the old rate: gone in the mean
        self.assertEqual(self.call(data, text + "resample: mean\n"), (0, ""))
        log = read_run_log(self.out)
        self.assertEqual(len(log.channel("ENCODER")), 51)
        t = 0.1 * np.arange(51)
        # The mean of sin over 0.1 s around t is sin(t) sin(0.05)/0.05; the trapezoid adds (0.01)^2/12.
        np.testing.assert_allclose(log.channel("SENSORS")["tip_acceleration"][1:-1], np.sin(t[1:-1]) * np.sin(0.05) / 0.05, atol=2e-5)

    def test_long_gap(self):
        self.refused(table().drop(index=range(100, 110)), "a gap of 0.11 s behind data row 100 (line 101)",
                     text=MAP + "resample: linear\n")

    def test_rate_and_unit_of_time_that_disagree(self):
        self.refused(table(), "key 'rate': found rows 10000 ms apart, 0.1 Hz; with time in ms it would be that rate",
                     text=MAP.replace("unit: ms", "unit: s"))
        self.refused(table(), "key 'rate'", "found rows 10 ms apart, 100 Hz", text=MAP.replace("value: 100,", "value: 200,"))

    def test_unknown_column_with_the_nearest_names(self):
        self.refused(table(), "map.yaml:9:14: key 'shaft_speed[1].column': found 'sped_1', which data.csv does not have, "
                     "expected 'speed_1'", text=MAP.replace("speed_1", "sped_1"))

    def test_wrong_units(self):
        self.refused(table(), "map.yaml:9:29: key 'shaft_speed[1].unit': found rad, a unit of angle, expected a unit of "
                     "angular speed: rad/s, mrad/s, deg/s, rpm, 1/min or a unit of speed", text=MAP.replace("rpm", "rad"))
        self.refused(table(), "found kNn, a unit that is not known here", text=MAP.replace("kN m", "kNn"))
        self.refused(table(), "key 'motor_torque[1].metres_per_radian': found nothing, beside a column in kN",
                     text=MAP.replace("kN m", "kN"))

    def test_missing_parts_all_in_one_go(self):
        error = self.refused(table(), "key 'time': found nothing, expected {column: NAME",
                             "key 'motor_torque': found nothing", "key 'shaft_speed': found nothing", "derive: one of",
                             text="kind: import_map\nshaft_position: [{column: angle_1, unit: deg}]\n")
        self.assertEqual(len(error.splitlines()), 3)
        self.refused(table(), "key 'rate.source': found nothing", text=MAP.replace("rate: {value: 100, unit: Hz, source: made up}",
                                                                                   "rate: {value: 100, unit: Hz}"))

    def test_unknown_key(self):
        self.refused(table(), "key 'tmie': found a key that is not known here, expected 'time' (or one of ", text=MAP.replace("time:", "tmie:"))
        self.refused(table(), "map.yaml:7:87: key 'shaft_position[2].sing': found a key that is not known here, "
                     "expected 'sign'", text=MAP.replace("sign:", "sing:"))

    def test_signals_given_twice(self):
        self.refused(table(), "map.yaml:21:1: key 'slew_angle': found the key a second time",
                     text=MAP + "slew_angle: {column: slew, unit: deg}\n")
        self.refused(table(), "key 'tip_acceleration.column': found 'angle_1', which is shaft_position[1] already",
                     text=MAP.replace("column: tip,", "column: angle_1,"))
        twice = "".join(line + "," + line.split(",")[-1] + "\n" for line in table().to_csv(index=False).splitlines())
        self.refused(None, "'stop', which data.csv has 2 times", write=lambda file: file.write_text(twice))

    def test_groups_that_do_not_fit(self):
        self.refused(table(), "key 'shaft_speed': found 1 groups, expected 2",
                     text=MAP.replace("  - {derive: central_difference}\n", ""))

    def test_time_that_does_not_rise(self):
        data = table()
        data.loc[7, "t"] = data.loc[6, "t"]
        self.refused(data, "map.yaml:3:16: key 'time.column': found 5060.0 at data row 8 (line 9) after 5060.0")
        self.refused(data, "at data row 8 after", suffix="parquet")

    def test_values_that_are_no_numbers(self):
        data = table()
        data.loc[41, "torque_2"] = np.nan
        self.refused(data, "key 'motor_torque[2].column': found no number (NaN or an empty cell) in column 'torque_2' at "
                     "data row 42 (line 43)", "rows: {first: ..., last: ...}")
        self.refused(data, "at data row 42,", suffix="parquet")
        data = table().astype({"tip": object})
        data.loc[3, "tip"] = "overflow"
        self.refused(data, "found 'overflow' in column 'tip' at data row 4 (line 5)")
        # The piece behind the hole is admitted.
        data = table()
        data.loc[41, "torque_2"] = np.nan
        self.assertEqual(self.call(data, MAP + "rows: {first: 101, last: 301}\n"), (0, ""))
        self.assertEqual(len(read_run_log(self.out).channel("ENCODER")), 201)

    def test_a_request_in_the_wrong_unit(self):
        self.refused(table(), "a request of 80", text=MAP.replace('wish, unit: "%"', 'wish, unit: "-"'))

    def test_files_that_are_none(self):
        self.refused(None, "there is no such file", write=lambda f: None)
        self.refused(None, "not readable as parquet", suffix="parquet", write=lambda f: f.write_text("no"))
        self.refused(None, "expected well-formed YAML", text="kind: [", write=lambda f: f.write_text("t\n1\n"))
        self.refused(None, "which data.csv does not have", write=lambda f: f.write_text(""))

    def test_what_was_made_of_an_older_log_goes_with_it_and_what_others_wrote_stays(self):
        def make(program, *words):
            with contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(program.main([str(self.out), *words]), 0)

        def there():
            return sorted(path.name for path in self.folder.iterdir() if path.name not in ("a.lcmlog", "data.csv", "map.yaml"))

        self.assertEqual(self.call(table())[0], 0)
        make(report, "--quiet")
        for file_format in export.FORMATS:
            make(export, "--format", file_format)
        self.assertEqual(there(), ["a.html", "a.mcap", "a_csv", "a_parquet"])
        self.assertNotEqual(self.call(table().drop(columns="t"))[0], 0)  # nothing new came, so nothing goes
        self.assertEqual(there(), ["a.html", "a.mcap", "a_csv", "a_parquet"])
        self.assertEqual(self.call(table(rows=401))[0], 0)
        self.assertEqual(there(), [])

        (self.folder / "a.html").write_text("<!doctype html>\n<title>the site's own page</title>")
        with open(self.folder / "a.mcap", "wb") as stream:  # the site's own recording
            writer = mcap.writer.Writer(stream)
            writer.start(profile="ros2", library="a recorder")
            writer.finish()
        for folder, name in (("a_csv", "monday.csv"), ("a_parquet", "notes.txt")):
            (self.folder / folder).mkdir()
            (self.folder / folder / name).write_text("mine")
        self.assertEqual(self.call(table())[0], 0)
        self.assertEqual(there(), ["a.html", "a.mcap", "a_csv", "a_parquet"])
        self.assertEqual((self.folder / "a_csv" / "monday.csv").read_text(), "mine")
        with contextlib.redirect_stderr(io.StringIO()):  # and no page, no export takes its place
            self.assertEqual(report.main([str(self.out)]), 2)
            for file_format in export.FORMATS:
                self.assertEqual(export.main([str(self.out), "--format", file_format]), 2, file_format)

    def linear_axis(self):
        """Columns of a linear motor, of the machine that the map names."""
        (self.folder / "axis.yaml").write_text(
            "kind: axis\ndescription: A linear motor.\ncoordinate: {value: linear, source: test}\nmass: {value: 95, unit: kg, source: test}\n"
            "rated_force: {value: 600, unit: N, source: test}\ntop_speed: {value: 0.3, unit: m/s, source: test}\n")
        t = 0.002 * np.arange(500)
        return pd.DataFrame({"t": t, "x": 50.0 * np.sin(2.0 * t), "f": -19.0 * np.sin(2.0 * t)}), (
            "kind: import_map\nmachine: axis.yaml\ntime: {column: t, unit: s, origin: first_row}\nshaft_position:\n  - {column: x, unit: mm}\n"
            "shaft_speed:\n  - {derive: central_difference}\nmotor_torque:\n  - {column: f, unit: N}\n")

    def test_a_linear_axis_stays_one_for_whoever_shows_or_exports_its_log(self):
        data, text = self.linear_axis()
        self.assertEqual(self.call(data, text), (0, ""))
        shown = {chart["title"]: chart["unit"] for chart in charts.charts(Recorded(self.out).facts, Recorded(self.out).store)}
        self.assertEqual(shown, {"speed of the axis": "m/s", "motor force": "% of the rated force"})
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertEqual(export.main([str(self.out), "--format", "csv"]), 0)
            self.assertEqual(report.main([str(self.out)]), 0)
        columns = {name: (self.folder / "a_csv" / f"{name}.csv").read_text().split("\n")[0] for name in ("ENCODER", "TORQUE")}
        for column, channel in (("motor_speed [m/s]", "ENCODER"), ("motor_position [m]", "ENCODER"), ("motor_force [N]", "TORQUE")):
            self.assertIn(f'"{column}"', columns[channel])
        self.assertRegex(said.getvalue(), r"largest speed +0\.1 m/s")
        # Of a machine that the next map does not name nothing is said any more.
        self.assertEqual(self.call(table())[0], 0)
        self.assertEqual(facts_beside(self.out), {})
        self.assertFalse((self.folder / "a.json").exists())

    def test_a_file_of_the_user_is_no_machine_and_is_not_written_over(self):
        data, text = self.linear_axis()
        for content in ("", '{"machine": {"kind": "axis"}}', "notes"):
            (self.folder / "a.json").write_text(content)
            code, error = self.call(data, text)
            self.assertEqual((code, error), (2, "slewlab import: a.json: found a file that slewlab did not write, expected none: there the machine of "
                                             "a.lcmlog is told; name another log with --out\n"))
            self.assertFalse(self.out.exists())
        self.assertEqual(self.call(table())[0], 0)
        self.assertEqual((facts_beside(self.out), (self.folder / "a.json").read_text()), ({}, "notes"))

    def test_an_older_log_survives_a_failure(self):
        self.out.write_bytes(b"older")
        self.assertNotEqual(self.call(table(), MAP.replace("rpm", "rad"))[0], 0)
        self.assertEqual(self.out.read_bytes(), b"older")

    def test_an_encoder_of_one_turn_goes_on_where_the_map_says_unwrap(self):
        """Eight radians to either side, within a turn: refused with its row, and as it went with the key."""
        data = table()
        whole = 400.0 * data["angle_1"]
        for wrapped in (np.mod(whole, 360.0), np.mod(whole + 180.0, 360.0) - 180.0):
            data["angle_1"] = wrapped
            row = int(np.flatnonzero(np.abs(np.diff(wrapped)) > 180.0)[0]) + 1
            self.refused(data, f"about a turn, behind data row {row} (line {row + 1}) in column 'angle_1'", "unwrap: {value: 360, unit: deg")
            text = MAP.replace("{column: angle_1, unit: deg,", "{column: angle_1, unit: deg, unwrap: {value: 360, unit: deg, source: made up},")
            self.assertEqual(self.call(data, text), (0, ""))
            position = read_run_log(self.out).channel("ENCODER")["shaft_position"][:, 0]
            np.testing.assert_allclose(position, RATIO * 400.0 * A * np.sin(W * 0.01 * np.arange(501)), rtol=1e-9, atol=1e-6)
            self.out.unlink()

    def test_a_position_that_jumps_there_and_back_is_refused_with_its_row(self):
        data = table()
        data.loc[300, "angle_1"] += 50.0
        self.refused(data, "column 'angle_1' at data row 301 (line 302), between", "jumps there and back")

    def test_a_position_that_jumps_and_stays_is_an_encoder_that_slips(self):
        data = table()
        data.loc[300:, "angle_1"] += 50.0
        self.refused(data, "column 'angle_1' at data row 301 (line 302), between", "jumps there and stays", "an encoder that slips")

    def test_one_row_of_an_acceleration_that_stands_alone_is_refused_and_what_rings_is_not(self):
        data = table()
        data.loc[300, "tip"] += 3e4
        self.refused(data, "column 'tip' at data row 301 (line 302), between", "no other row is a 20th as far off")
        data = table()
        ring = 3e4 * np.exp(-np.arange(12) / 3.0) * np.cos(1.9 * np.arange(12))
        data.loc[300:311, "tip"] += ring
        self.assertEqual(self.call(data), (0, ""))


if __name__ == "__main__":
    unittest.main()
