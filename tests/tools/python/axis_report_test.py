"""The report of an axis on made-up records: what differs is known in closed form."""

import base64
import contextlib
import io
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet
from google.protobuf import descriptor_pb2
from mcap.reader import make_reader

import axis_report
import export
import made_run
import report
from picture_page import unpacked
from run_log import REPOSITORY, slewlab_program
from run_numbers import read_run

RATIO = 50.0
RECORD, SIMULATED = 0x77, 0x99
COUNT, PERIOD = 1000, 2_000_000  # [-], [ns]


def facts(record=None):
    made = {"rated_torque": 8.0, "total_ratio": RATIO, "machine": {
        "kind": "axis", "is_rigid": True, "ratio": RATIO, "position_unit": "rad", "speed_unit": "rad/s",
        "efforts": [{"name": "motor torque", "unit": "N m"}, {"name": "torque on the axis", "unit": "N m"}],
        "sensors": [{"name": "motor speed", "unit": "rad/s", "channel": "ENCODER", "field": "shaft_speed"},
                    {"name": "motor position", "unit": "rad", "channel": "ENCODER", "field": "shaft_position"},
                    {"name": "load position", "unit": "rad", "channel": "SENSORS", "field": "slew_angle"}]}}
    if record is not None:
        made["open_loop"] = {"record": "a", "record_hash": f"{record:016x}"}
    return made


def events(configuration_hash, off):
    """An axis that turns at 0.5 rad/s, and is `off` t^2 [rad] from there."""
    made = []
    for k in range(COUNT):
        time, t = k * PERIOD, k * PERIOD * 1e-9
        encoder = made_run.types.encoder_t()
        encoder.sequence, encoder.group_count = k, 1
        encoder.shaft_position, encoder.shaft_speed = [RATIO * (0.5 * t + off * t**2)], [RATIO * (0.5 + 2 * off * t)]
        torque = made_run.types.torque_t()
        torque.sequence = torque.answered_sequence = k
        torque.group_count, torque.motor_torque = 1, [-4.0]
        sensors = made_run.types.sensors_t()
        sensors.sequence = k
        for name in ("house", "pivot", "middle", "tip"):
            setattr(sensors, f"{name}_acceleration", float("nan"))
        sensors.slew_angle = 0.1 + 0.5 * t + off * t**2
        truth = made_run.types.truth_t()  # of an axis: no boom, so arrays of elements and modes are empty
        truth.sequence, truth.group_count = k, 1
        truth.gearbox_torque, truth.gear_deflection, truth.play_crossings = [100.0 * off], [0.0], [0]
        for channel, message in (("ENCODER", encoder), ("TORQUE", torque), ("SENSORS", sensors), ("TRUTH", truth)):
            message.simulated_time, message.configuration_hash = time, configuration_hash
            made.append((channel, time, message))
    return made


class AxisReportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.record, self.simulated = self.folder / "record.lcmlog", self.folder / "simulated"
        made_run.write_log(self.record, events(RECORD, 0.0))
        self.simulated.mkdir()
        made_run.write_log(self.simulated / "run.lcmlog", events(SIMULATED, 0.01))
        (self.simulated / "run.json").write_text(json.dumps(facts(RECORD)))

    def report(self, *runs):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            self.assertEqual(report.main([*map(str, runs), "--out", str(self.folder / "page.html")]), 0)
        return out.getvalue()

    def test_differences_are_those_the_logs_were_made_of(self):
        runs = [read_run(self.simulated), read_run(self.record)]
        axis_report.share_machine(runs)
        found = axis_report.difference(*runs)
        t = np.arange(COUNT) * PERIOD * 1e-9
        np.testing.assert_allclose(found["position"][1], 0.01 * t**2, atol=1e-12)
        np.testing.assert_allclose(found["speed"][1], 0.02 * t, atol=1e-12)
        np.testing.assert_allclose(found["load position"][1], 0.01 * t**2, atol=1e-12)
        # RMS of 0.02 t over 2 s is 0.04 / sqrt(3); of the last tenth about 0.038.
        self.assertAlmostEqual(axis_report.rms(found["speed"][1]), 0.04 / np.sqrt(3), delta=1e-4)
        self.assertAlmostEqual(axis_report.windows(found["speed"][1])[-1], 0.038, delta=1e-4)

    def test_table_and_picture_speak_of_the_axis(self):
        said = self.report(self.simulated, self.record)
        self.assertIn("speed against the record, RMS", said)
        self.assertIn("0.0231 rad/s", said)
        self.assertIn("4 N m (50 % of rated)", said)
        self.assertIn("taken for a record of the axis of simulated", said)
        page = (self.folder / "page.html").read_text()
        for text in ("position difference", "simulated minus recorded", "load encoder"):
            self.assertIn(text, page + unpacked(page))
        for word in ("house", "slewing", "T100", "tip"):
            self.assertNotIn(word, said)
        # Without the record there is nothing to differ from.
        self.assertNotIn("against the record", self.report(self.simulated))

    def test_two_runs_are_shown_as_their_difference(self):
        other = self.folder / "other"
        other.mkdir()
        made_run.write_log(other / "run.lcmlog", [event for event in events(0x55, 0.03) if 200_000_000 <= event[1] <= 1_600_000_000])
        heavier = facts()
        heavier["machine"]["is_rigid"] = False
        elastic = facts(RECORD)
        elastic["machine"]["is_rigid"] = False
        (self.simulated / "run.json").write_text(json.dumps(elastic))
        heavier["machine"]["inertia"] = 60.0  # [kg m^2] what differs is no hindrance
        (other / "run.json").write_text(json.dumps(heavier))
        self.report(self.simulated, other)
        told = json.loads(unpacked((self.folder / "page.html").read_text()))[0]
        view = told["views"]["difference, A minus B"]
        found = {}
        for trace in view["traces"]:
            drawn = told["series"][trace["series"]]
            y = np.frombuffer(base64.b64decode(drawn["y"]["bdata"]), "f4")
            x = drawn["x0"] + drawn["dx"] * np.arange(len(y)) if "x0" in drawn else np.frombuffer(base64.b64decode(drawn["x"]["bdata"]), "f4")
            found.setdefault(trace["name"], []).append((x, y))
        (t, position), (_, speed) = found["motor encoder"]
        self.assertAlmostEqual(float(t[0]), 0.2, places=6)
        self.assertAlmostEqual(float(t[-1]), 1.6, places=6)
        np.testing.assert_allclose(position, -0.02 * t**2, atol=1e-5)
        np.testing.assert_allclose(speed, -0.04 * t, atol=1e-5)
        np.testing.assert_array_equal(found["command"][0][1], 0.0)  # both are driven by -4 N m
        np.testing.assert_allclose(found["transmission"][0][1], -2.0, atol=1e-6)  # 100 off, of either
        # Signals of another transmission are not taken from each other.
        geared = facts()
        geared["machine"]["ratio"] = 40.0
        (other / "run.json").write_text(json.dumps(geared))
        self.report(self.simulated, other)
        self.assertNotIn("difference, A minus B", unpacked((self.folder / "page.html").read_text()))

    def test_export_names_the_axis_signals(self):
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(export.main([str(self.simulated), "--format", "parquet"]), 0)
        folder = self.simulated / "run_parquet"
        self.assertIn("motor_speed [rad/s]", pd.read_parquet(folder / "ENCODER.parquet").columns)
        self.assertIn("motor_torque [N m]", pd.read_parquet(folder / "TORQUE.parquet").columns)
        sensors = pd.read_parquet(folder / "SENSORS.parquet")
        self.assertEqual(list(sensors.columns[-1:]), ["load_position [rad]"])
        self.assertNotIn("tip_acceleration", sensors.columns)

    def test_where_messages_are_missing_there_is_a_gap(self):
        made_run.write_log(self.record, [event for event in events(RECORD, 0.0) if not 400_000_000 < event[1] < 1_000_000_000])
        said = self.report(self.simulated, self.record)
        self.assertIn("record: ENCODER, TORQUE, SENSORS, TRUTH: no message between 0.4 s and 1 s\n", said)
        told = json.loads(unpacked((self.folder / "page.html").read_text()))[0]
        traces = {}
        for trace in told["views"]["side by side"]["traces"]:
            drawn = told["series"][trace["series"]]
            traces.setdefault(trace["name"], np.frombuffer(base64.b64decode(drawn["y"]["bdata"]), "f4"))
        for name, is_gap in (("record", True), ("simulated", False), ("simulated minus recorded", True)):
            self.assertEqual(bool(np.isnan(traces[name]).any()), is_gap, name)

    def test_exports_of_a_linear_axis_have_its_units(self):
        """Of a linear motor, and of a motor that turns a screw: [rad], [rad/s] and [N m] at its shaft."""
        states = []
        for channel, time, message in events(SIMULATED, 0.01):
            if channel == "ENCODER":
                state = made_run.types.controller_state_t()
                state.sequence, state.simulated_time, state.configuration_hash = message.sequence, time, SIMULATED
                state.group_count, state.proportional_torque, state.integral_torque = 1, [0.0], [0.0]
                states.append(("CONTROLLER_STATE", time, state))
        made_run.write_log(self.simulated / "run.lcmlog", sorted(events(SIMULATED, 0.01) + states, key=lambda event: event[1]))
        on_axis = {"TRUTH": {"gearbox_torque": "N", "gear_deflection": "m", "house_speed": "m/s", "mechanical_energy": "J"},
                   "CONTROLLER_STATE": {"ramped_speed": "m/s"}, "SENSORS": {"slew_angle": "m", "tip_acceleration": "m/s^2"}}
        for place, speed, effort, name in (("m", "m/s", "N", "motor force"), ("rad", "rad/s", "N m", "motor torque")):
            linear = facts()
            linear["machine"] |= {"position_unit": "m", "speed_unit": "m/s",
                                  "efforts": [{"name": name, "unit": effort}, {"name": "force on the axis", "unit": "N"}]}
            for sensor, unit in zip(linear["machine"]["sensors"], (speed, place, "m")):
                sensor["unit"] = unit
            (self.simulated / "run.json").write_text(json.dumps(linear))
            for file_format in export.FORMATS:
                with contextlib.redirect_stdout(io.StringIO()):
                    self.assertEqual(export.main([str(self.simulated), "--format", file_format]), 0)
            expected = {channel: dict(fields) for channel, fields in on_axis.items()}
            expected |= {"ENCODER": {"shaft_speed": speed, "shaft_position": place, "sequence": "-"}, "TORQUE": {"motor_torque": effort}}
            expected["CONTROLLER_STATE"] |= {"average_torque": effort, "offset_torque": effort, "proportional_torque": effort,
                                             "integral_torque": effort}
            with self.subTest(motor=name):
                self.check_units_of_mcap(expected)
                self.check_units_of_tables(expected, f"{name.replace(' ', '_')} [{effort}]")

    def check_units_of_mcap(self, expected):
        with open(self.simulated / "run.mcap", "rb") as stream:
            summary = make_reader(stream).get_summary()
        for channel in summary.channels.values():
            (file,) = descriptor_pb2.FileDescriptorSet.FromString(summary.schemas[channel.schema_id].data).file
            comments = {file.message_type[0].field[place.path[-1]].name: place.trailing_comments for place in file.source_code_info.location}
            for field, unit in expected[channel.topic].items():
                self.assertEqual((channel.metadata[field], comments[field]), (unit, f" [{unit}]\n"), (channel.topic, field))

    def check_units_of_tables(self, expected, torque):
        axis_names = {"shaft_speed": "motor_speed", "shaft_position": "motor_position", "slew_angle": "load_position"}
        for channel, fields in expected.items():
            schema = pyarrow.parquet.read_schema(self.simulated / "run_parquet" / f"{channel}.parquet")
            heads = list(pd.read_csv(self.simulated / "run_csv" / f"{channel}.csv", nrows=0))
            for field, unit in fields.items():
                if field == "tip_acceleration":  # an axis has none
                    continue
                said = f"{axis_names.get(field, field)} [{unit}]"
                (column,) = [name for name in schema.names
                             if name in (field, f"{field}_1", said) or (field == "motor_torque" and name == torque)]
                self.assertEqual(schema.field(column).metadata[b"unit"].decode(), unit, column)
                self.assertIn(column if unit == "-" or column.endswith("]") else f"{column} [{unit}]", heads)

    def test_a_second_simulation_leaves_nothing_that_was_made_of_the_first(self):
        out = self.folder / "out"

        def simulate():
            ended = subprocess.run([slewlab_program(), "simulate", REPOSITORY / "config" / "axes" / "example_axis.yaml", self.record, "--out", out],
                                   stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)
            self.assertEqual(ended.returncode, 0, ended.stderr)

        simulate()
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(report.main([str(out), "--quiet"]), 0)
            for file_format in export.FORMATS:
                self.assertEqual(export.main([str(out), "--format", file_format]), 0)
        (out / "notes").mkdir()
        made = {"run.json", "run.lcmlog", "notes"}
        self.assertEqual({path.name for path in out.iterdir()}, made | {"report.html", "run.mcap", "run_csv", "run_parquet"})
        (out / "run_csv" / "notes.txt").write_text("mine")  # such a folder stays
        simulate()
        self.assertEqual({path.name for path in out.iterdir()}, made | {"run_csv"})

    def test_a_crane_stays_a_crane(self):
        crane = made_run.write_run(self.folder / "crane")
        self.assertIn("T100", self.report(crane))
        self.assertNotIn("taken for", self.report(crane))


if __name__ == "__main__":
    unittest.main()
