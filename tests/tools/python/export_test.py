import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet
import yaml
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

import export
import made_run
from new_map import map_text


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
        unit = (lambda text: f" [{text}]") if suffix == "csv" else (lambda text: "")
        np.testing.assert_array_equal(torque["time" + unit("s")], [m.simulated_time / 1e9 for m in sent])
        np.testing.assert_array_equal(torque["motor_torque_2" + unit("Nm")], [m.motor_torque[1] for m in sent])
        sensors = read(folder / f"SENSORS.{suffix}")
        np.testing.assert_array_equal(sensors["tip_acceleration" + unit("m/s^2")], [m.tip_acceleration for m in self.sent("SENSORS")])

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

    def test_every_column_of_csv_has_its_unit_in_its_name(self):
        self.assertEqual(self.call(self.folder, "--format", "csv"), (0, ""))
        names = {channel: list(pd.read_csv(self.folder / "run_csv" / f"{channel}.csv", nrows=0))
                 for channel in ("ENCODER", "TORQUE", "SENSORS", "TRUTH")}
        self.assertEqual(names["ENCODER"], ["time [s]", "sequence", "configuration_hash", "run_identity", "operator_sequence", "group_count",
                                            "shaft_speed_1 [rad/s]", "shaft_speed_2 [rad/s]", "shaft_position_1 [rad]", "shaft_position_2 [rad]"])
        for channel, name in (("TORQUE", "motor_torque_2 [Nm]"), ("SENSORS", "tip_acceleration [m/s^2]"), ("TRUTH", "supplied_work [J]")):
            self.assertIn(name, names[channel])
        # What is exported can be imported: its columns, units and groups are known again.
        told = yaml.safe_load(map_text(self.folder / "run_csv" / "ENCODER.csv"))
        self.assertEqual([(each["column"], each["unit"]) for each in told["shaft_speed"]],
                         [("shaft_speed_1 [rad/s]", "rad/s"), ("shaft_speed_2 [rad/s]", "rad/s")])
        self.assertEqual(told["time"], {"column": "time [s]", "unit": "s"})

    def test_a_killed_runs_log_is_taken_and_the_run_told_to_be_incomplete(self):
        (self.folder / "run.lcmlog").rename(self.folder / "run.lcmlog.partial")
        (self.folder / "run.json").write_text('{"end": "under way"}')
        for suffix, made in (("csv", "run_csv"), ("mcap", "run.mcap")):
            code, said = self.call(self.folder, "--format", suffix)
            self.assertEqual(code, 0, said)
            self.assertEqual(said, f"{self.folder.name}: this run ended before its time: it was broken off. The export has the part that was logged.\n")
            self.assertTrue((self.folder / made).exists())
        self.assertEqual(self.call(self.folder / "run.lcmlog.partial", "--format", "csv")[0], 0)
        self.assertFalse((self.folder / "run.lcmlog_csv").exists())

    def decoded(self, schema, message):
        """A Protobuf message by the schema that the file itself has."""
        if schema.name not in self.kinds:
            pool = descriptor_pool.DescriptorPool()
            for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(file)
            self.kinds[schema.name] = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
        return self.kinds[schema.name].FromString(message.data)

    def test_mcap_holds_every_field_of_every_message_in_the_order_of_simulated_time(self):
        for k in range(0, len(self.events) - 40, 40):  # late by up to 40 events
            self.events[k:k + 40] = self.events[k + 20:k + 40] + self.events[k:k + 20]
        made_run.write_log(self.folder / "run.lcmlog", self.events)
        self.assertEqual(self.call(self.folder / "run.lcmlog", "--format", "mcap"), (0, ""))
        self.kinds, times, read = {}, [], {}
        with open(self.folder / "run.mcap", "rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                times.append(message.log_time)
                self.assertEqual((schema.encoding, channel.message_encoding), ("protobuf", "protobuf"))
                if channel.topic == "SENSORS":
                    self.assertEqual(channel.metadata["slew_angle"], "rad")
                    self.assertIn(b" [rad]\n", schema.data)  # the comment behind the field
                values = self.decoded(schema, message)
                self.assertEqual((message.sequence, message.log_time), (values.sequence, values.simulated_time))
                read.setdefault(channel.topic, []).append(values)
        self.assertEqual(times, sorted(times))
        for channel in ("ENCODER", "OPERATOR", "SENSORS", "TORQUE", "TRUTH"):
            sent = sorted(self.sent(channel), key=lambda message: message.sequence)
            self.assertEqual(len(read[channel]), len(sent))
            for field in sent[0].__slots__:
                got = [getattr(m, field) for m in read[channel]]
                if sent[0].__dimensions__[sent[0].__slots__.index(field)]:
                    got = [list(each) for each in got]
                self.assertEqual(got, [getattr(m, field) for m in sent], (channel, field))

    def test_mcaps_indexes_find_a_moment(self):
        self.assertEqual(self.call(self.folder / "run.lcmlog", "--format", "mcap"), (0, ""))
        with open(self.folder / "run.mcap", "rb") as stream:
            reader = make_reader(stream)
            counts = reader.get_summary().statistics.channel_message_counts
            self.assertEqual(sum(counts.values()), len(self.events))
            found = [m.log_time for _, _, m in reader.iter_messages(["TRUTH"], starting_at=5 * 10**9, ending_before=5 * 10**9 + 30 * 10**6)]
        self.assertEqual(found, [5 * 10**9 + k * 10**7 for k in range(3)])

    def test_a_second_export_replaces_the_first_but_nothing_else(self):
        self.assertEqual(self.call(self.folder, "--format", "csv")[0], 0)
        self.assertEqual(self.call(self.folder, "--format", "csv")[0], 0)
        precious = self.folder / "other" / "precious"
        precious.mkdir(parents=True)
        (precious / "thesis.txt").write_text("mine")
        code, error = self.call(self.folder, "--format", "csv", "--out", precious)
        self.assertEqual(code, 2)
        self.assertIn("precious: is there already and is no earlier export", error)
        self.assertEqual((precious / "thesis.txt").read_text(), "mine")
        (self.folder / "run.json").write_text("{}")  # of slewlab run, which takes away what it knows
        code, error = self.call(self.folder, "--format", "csv", "--out", self.folder / "first_csv")
        self.assertEqual(code, 2)
        self.assertIn("in the folder of a run, where a later run would leave it beside its own log", error)
        self.assertFalse((self.folder / "first_csv").exists())

    def test_mcap_of_one_message_and_of_a_log_written_backwards(self):
        for name, events in (("one", self.events[:1]), ("backwards", self.events[::-1])):
            with self.subTest(log=name):
                made_run.write_log(self.folder / "run.lcmlog", events)
                self.assertEqual(self.call(self.folder / "run.lcmlog", "--format", "mcap"), (0, ""))
                with open(self.folder / "run.mcap", "rb") as stream:
                    times = [message.log_time for _, _, message in make_reader(stream).iter_messages(log_time_order=False)]
                self.assertEqual(times, sorted(time for _, time, _ in events))

    def test_no_log_is_an_error_and_leaves_nothing(self):
        code, error = self.call(self.folder / "other.lcmlog", "--format", "mcap")
        self.assertEqual(code, 2)
        self.assertIn("other.lcmlog: there is no such folder or log", error)
        self.assertEqual([f.name for f in self.folder.iterdir()], ["run.lcmlog"])


if __name__ == "__main__":
    unittest.main()
