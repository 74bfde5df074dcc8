import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet
from mcap.reader import make_reader

import export
import made_run


class ExportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.events = made_run.messages()
        made_run.write_log(self.folder / "run.lcmlog", self.events)

    def call(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = export.main([str(a) for a in arguments])
        return code, err.getvalue()

    def sent(self, channel):
        return [message for name, _, message in self.events if name == channel]

    def check_tables(self, read, suffix):
        self.assertEqual(self.call(self.folder, "--format", suffix), (0, ""))
        folder = self.folder / f"run_{suffix}"
        self.assertEqual({f.stem for f in folder.iterdir()}, {"ENCODER", "OPERATOR", "SENSORS", "TORQUE", "TRUTH"})
        torque = read(folder / f"TORQUE.{suffix}")
        sent = self.sent("TORQUE")
        np.testing.assert_array_equal(torque["time"], [m.simulated_time / 1e9 for m in sent])
        np.testing.assert_array_equal(torque["motor_torque_2"], [m.motor_torque[1] for m in sent])
        sensors = read(folder / f"SENSORS.{suffix}")
        np.testing.assert_array_equal(sensors["tip_acceleration"], [m.tip_acceleration for m in self.sent("SENSORS")])

    def test_parquet_holds_every_value_to_the_bit(self):
        self.check_tables(pd.read_parquet, "parquet")

    def test_every_column_of_parquet_has_its_unit(self):
        self.assertEqual(self.call(self.folder, "--format", "parquet"), (0, ""))
        units = {}
        for channel in ("ENCODER", "TORQUE", "SENSORS", "TRUTH"):
            schema = pyarrow.parquet.read_schema(self.folder / "run_parquet" / f"{channel}.parquet")
            units |= {name: schema.field(name).metadata[b"unit"].decode() for name in schema.names}
        self.assertEqual((units["time"], units["shaft_speed_1"], units["motor_torque_2"], units["tip_acceleration"], units["supplied_work"]),
                         ("s", "rad/s", "Nm", "m/s^2", "J"))

    def test_csv_holds_every_value_to_the_bit(self):
        self.check_tables(lambda path: pd.read_csv(path, float_precision="round_trip"), "csv")

    def test_mcap_holds_every_message_in_the_order_of_simulated_time(self):
        self.assertEqual(self.call(self.folder / "run.lcmlog", "--format", "mcap"), (0, ""))
        times, counts = [], {}
        torques = []
        with open(self.folder / "run.mcap", "rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                times.append(message.log_time)
                counts[channel.topic] = counts.get(channel.topic, 0) + 1
                self.assertEqual((schema.encoding, channel.message_encoding), ("jsonschema", "json"))
                if channel.topic == "SENSORS":
                    self.assertEqual(json.loads(schema.data)["properties"]["slew_angle"]["description"], "rad")
                if channel.topic == "TORQUE":
                    torques.append(json.loads(message.data)["motor_torque"])
        self.assertEqual(times, sorted(times))
        for channel in ("ENCODER", "OPERATOR", "SENSORS", "TORQUE", "TRUTH"):
            self.assertEqual(counts[channel], len(self.sent(channel)))
        self.assertEqual(torques, [m.motor_torque for m in self.sent("TORQUE")])

    def test_a_second_export_replaces_the_first_but_nothing_else(self):
        self.assertEqual(self.call(self.folder, "--format", "csv")[0], 0)
        self.assertEqual(self.call(self.folder, "--format", "csv")[0], 0)
        precious = self.folder / "precious"
        precious.mkdir()
        (precious / "thesis.txt").write_text("mine")
        code, error = self.call(self.folder, "--format", "csv", "--out", precious)
        self.assertEqual(code, 1)
        self.assertIn("precious: is there already and is no earlier export", error)
        self.assertEqual((precious / "thesis.txt").read_text(), "mine")

    def test_no_log_is_an_error_and_leaves_nothing(self):
        code, error = self.call(self.folder / "other.lcmlog", "--format", "mcap")
        self.assertEqual(code, 1)
        self.assertIn("other.lcmlog: there is no such log", error)
        self.assertEqual([f.name for f in self.folder.iterdir()], ["run.lcmlog"])


if __name__ == "__main__":
    unittest.main()
