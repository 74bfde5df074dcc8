import tempfile
import unittest
from pathlib import Path

import numpy as np

import made_run
from run_log import LogProblem, read_run_log, seconds


class RunLogTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "run.lcmlog"

    def read(self, events):
        made_run.write_log(self.path, events)
        return read_run_log(self.path)

    def test_every_field_of_every_message_comes_back(self):
        events = made_run.messages()
        log = self.read(events)
        self.assertEqual(log.remarks, [])
        for channel in ("OPERATOR", "SENSORS", "TRUTH", "ENCODER", "TORQUE"):
            sent = [message for name, _, message in events if name == channel]
            read = log.channel(channel)
            self.assertEqual(len(read), len(sent))
            for field in sent[0].__slots__:
                np.testing.assert_array_equal(read[field], np.array([getattr(m, field) for m in sent]), field)

    def test_order_of_arrival_and_repeats_do_not_matter(self):
        events = made_run.messages()
        shuffled = list(events)
        for k in range(0, len(shuffled) - 1, 7):
            shuffled[k], shuffled[k + 1] = shuffled[k + 1], shuffled[k]
        repeated = next(event for event in events if event[0] == "TORQUE")
        log = self.read(shuffled + [repeated])
        self.assertTrue(np.all(np.diff(seconds(log.channel("SENSORS"))) > 0))
        self.assertEqual(len(log.channel("TORQUE")), sum(1 for e in events if e[0] == "TORQUE"))

    def test_what_cannot_be_used_is_told_and_left_out(self):
        events = made_run.messages()
        torque = next(event for event in events if event[0] == "TORQUE")[2].encode()
        log = self.read(events + [
            ("CAMERA", 0, b"\x01\x02"),
            ("TORQUE", 0, torque[:-3]),
            ("TORQUE", 0, b"\x00" * len(torque)),
        ])
        self.assertEqual(len(log.channel("TORQUE")), sum(1 for e in events if e[0] == "TORQUE"))
        told = "\n".join(log.remarks)
        self.assertIn("channel CAMERA is not slewlab's: 1 events", told)
        self.assertRegex(told, r"TORQUE: 2 messages could not be decoded \(last: other version\), the first at byte \d+")

    def test_messages_whose_arrays_have_other_lengths_than_most_are_told_and_left_out(self):
        events = made_run.messages()
        odd = [message for name, _, message in events if name == "TORQUE"][700]
        odd.group_count, odd.motor_torque = 1, [1.0]
        log = self.read(events)
        self.assertEqual(len(log.channel("TORQUE")), sum(1 for e in events if e[0] == "TORQUE") - 1)
        self.assertRegex("\n".join(log.remarks), r"TORQUE: 1 messages whose arrays are of another length .* left out, at byte \d+")

    def test_stretches_are_the_channels_a_piece_at_a_time(self):
        events = made_run.messages()
        for spoiled in (False, True):  # in order; with a stray, for which the log's order has to be found
            if spoiled:
                next(message for name, _, message in events if name == "SENSORS").simulated_time = 1 << 60
            log = self.read(events * 20 if not spoiled else events)
            for names in (("TORQUE", "SENSORS"), ()):
                pieces = {}
                for stretch in log.stretches(*names):
                    for name, messages in stretch.items():
                        pieces.setdefault(name, []).append(messages)
                self.assertEqual(set(pieces), set(names or log.tables))
                for name, parts in pieces.items():
                    np.testing.assert_array_equal(np.concatenate(parts), log.channel(name))

    def test_a_reading_that_is_broken_off_leaves_the_next_one_alone(self):
        log = self.read(made_run.messages())
        for _ in log.stretches("TRUTH"):
            break
        self.assertEqual(len(log.channel("SENSORS")), log.tables["SENSORS"].rows)

    def test_of_several_runs_in_a_file_the_longest_is_taken(self):
        long, short = made_run.messages(), made_run.messages()[:2000]
        with self.subTest("the same configuration twice"):
            log = self.read(short + long)
            self.assertEqual(len(log.channel("SENSORS")), sum(1 for e in long if e[0] == "SENSORS"))
            self.assertIn("holds 2 runs", " ".join(log.remarks))
        with self.subTest("two configurations"):
            log = self.read(long + made_run.messages(configuration_hash=77)[:500])
            self.assertEqual(set(log.channel("SENSORS")["configuration_hash"]), {made_run.HASH})

    def test_no_bit_of_a_torques_head_splits_a_run(self):
        torques = sum(1 for event in made_run.messages() if event[0] == "TORQUE")
        for field in ("simulated_time", "configuration_hash", "run_identity", "answered_sequence"):
            for bit in (12, 45, 63):
                with self.subTest(field=field, bit=bit):
                    events = made_run.messages()
                    torque = [event for event in events if event[0] == "TORQUE"][700][2]
                    changed = (getattr(torque, field) ^ (1 << bit)) & (1 << 64) - 1
                    setattr(torque, field, changed - (1 << 64) if changed >> 63 else changed)
                    log = self.read(events)
                    self.assertEqual(len(log.channel("TORQUE")), torques - 1)
                    self.assertEqual(len(log.channel("ENCODER")), torques)
                    self.assertRegex("\n".join(log.remarks), "TORQUE: 1 messages .* left out, at byte")
                    self.assertNotIn("runs", "\n".join(log.remarks))

    def test_the_operator_of_the_next_run_does_not_land_in_the_one_before(self):
        for run_identity in (made_run.RUN, made_run.RUN + 1):
            with self.subTest(run_identity=run_identity):
                first = [e for e in made_run.messages() if e[1] <= 15_000_000_000 and e[0] != "OPERATOR"]
                log = self.read(first + made_run.messages(run_identity=run_identity))
                self.assertIn("holds 2 runs", " ".join(log.remarks))
                self.assertEqual(len(log.channel("OPERATOR")), 3)
                log = self.read(made_run.messages() + made_run.messages(run_identity=run_identity)[:2000])
                self.assertEqual(len(log.channel("OPERATOR")), 3)
                self.assertEqual(len(log.channel("ENCODER")), 2000)

    def test_names_of_channels_are_shown_as_text(self):
        log = self.read(made_run.messages() + [("\x1b[2J\x07", 0, b"")] + [(f"C{k}", 0, b"") for k in range(50)])
        told = "\n".join(log.remarks)
        self.assertTrue(all(c == "\n" or " " <= c <= "~" for c in told), told)
        self.assertIn("\\x1b[2J\\x07", told)
        self.assertLess(len(log.remarks), 15)

    def test_a_length_that_reaches_over_other_events_swallows_none(self):
        events = [event for event in made_run.messages() if event[0] == "SENSORS"][:6]
        made_run.write_log(self.path, events)
        whole = bytearray(self.path.read_bytes())
        size = len(whole) // 6
        for longer in (1, 40, size, 2 * size):
            damaged = bytearray(whole)
            damaged[2 * size + 24:2 * size + 28] = (int.from_bytes(whole[2 * size + 24:2 * size + 28], "big") + longer).to_bytes(4, "big")
            self.path.write_bytes(bytes(damaged))
            log = read_run_log(self.path)
            np.testing.assert_array_equal(log.channel("SENSORS")["sequence"], [0, 1, 3, 4, 5])
            self.assertIn(f"{size} at byte {2 * size} behind 0.005 s", " ".join(log.remarks))

    def test_a_log_cut_off_at_any_byte_is_read_up_to_there(self):
        events = [event for event in made_run.messages() if event[0] == "SENSORS"][:3]
        made_run.write_log(self.path, events)
        whole = self.path.read_bytes()
        event_size = len(whole) // 3
        for size in range(event_size, len(whole)):
            self.path.write_bytes(whole[:size])
            self.assertEqual(len(read_run_log(self.path).channel("SENSORS")), size // event_size, size)

    def test_behind_a_damaged_piece_reading_goes_on(self):
        events = [event for event in made_run.messages() if event[0] == "SENSORS"][:4]
        made_run.write_log(self.path, events)
        whole = self.path.read_bytes()
        event_size = len(whole) // 4
        self.path.write_bytes(whole[:event_size] + b"????" + whole[event_size + 4:])  # the second's sync word
        log = read_run_log(self.path)
        np.testing.assert_array_equal(log.channel("SENSORS")["sequence"], [0, 2, 3])
        self.assertIn(f"{event_size} bytes in 1 place are no event and were skipped: {event_size} at byte {event_size}", " ".join(log.remarks))

    def test_a_log_that_is_cut_off_while_it_is_read_is_told(self):
        log = self.read(made_run.messages())
        self.path.write_bytes(self.path.read_bytes()[:100_000])
        with self.assertRaisesRegex(LogProblem, "changed while it was read"):
            log.channel("SENSORS")
        self.path.unlink()
        with self.assertRaises(LogProblem):
            log.channel("TRUTH")

    def test_a_reading_that_is_under_way_does_not_hinder_another_of_the_same_log(self):
        log = self.read(made_run.messages() * 20)
        first = log.stretches("SENSORS")
        some = next(first)["SENSORS"]
        self.assertEqual(len(log.channel("SENSORS")), log.tables["SENSORS"].rows)
        rest = np.concatenate([some, *(stretch["SENSORS"] for stretch in first)])
        np.testing.assert_array_equal(rest, log.channel("SENSORS"))

    def test_no_log_and_no_message_are_told_apart(self):
        with self.assertRaisesRegex(LogProblem, "no such log"):
            read_run_log(self.path)
        self.path.write_bytes(b"")
        with self.assertRaisesRegex(LogProblem, "holds no message that slewlab can read"):
            read_run_log(self.path)
        made_run.write_log(self.path, [made_run.messages()[0]])
        with self.assertRaisesRegex(LogProblem, "no usable TRUTH message"):
            read_run_log(self.path).channel("TRUTH")


if __name__ == "__main__":
    unittest.main()
