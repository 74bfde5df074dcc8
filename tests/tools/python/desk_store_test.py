"""What a window of a store shows against the samples that it was filled with."""

import asyncio
import functools
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from run_log import message_types

from desk import charts
from desk.access import PATIENCE, Access, Joystick
from desk.diagnosis import Diagnosis, Minute
from desk.source import Incoming, fill, parse_events
from desk.store import CAPACITY, FACTOR, Channel, Store


def direct(time, values, first, last, bins):
    """Lowest and highest of each bin, sample by sample."""
    low, high = np.full(bins, np.nan), np.full(bins, np.nan)
    inside = (time >= first) & (time <= last)
    place = np.clip(((time[inside] - first) * (bins / (last - first))).astype(int), 0, bins - 1)
    for k in np.unique(place):
        low[k], high[k] = values[inside][place == k].min(), values[inside][place == k].max()
    return low, high


class StoreTest(unittest.TestCase):
    def filled(self, count, piece, capacity=CAPACITY):
        time = np.arange(count) * 1e-3
        values = np.random.default_rng(1).normal(size=count).astype(np.float32)
        channel = Channel(["a"], capacity)
        for first in range(0, count, piece):
            channel.append(time[first:first + piece], values[None, first:first + piece])
        return time, values, channel

    def test_a_short_window_is_drawn_from_the_samples_themselves(self):
        time, values, channel = self.filled(20_000, 37)
        for first, last, bins in ((0.0, 20.0, 1900), (3.2, 4.7, 300), (19.5, 21.0, 64)):
            low, high = channel.envelope(first, last, bins)
            expected = direct(time, values, first, last, bins)
            np.testing.assert_array_equal(low[0], expected[0])
            np.testing.assert_array_equal(high[0], expected[1])

    def test_no_peak_is_lost_of_a_long_window_however_few_pixels(self):
        time, values, channel = self.filled(200_000, 1013)
        values[123_456] = 77.0
        channel = Channel(["a"])
        channel.append(time, values[None])
        low, high = channel.envelope(0.0, 200.0, 100)
        self.assertEqual(np.nanmax(high), 77.0)
        self.assertEqual(int(np.nanargmax(high)), 61)  # 123.456 s of 200 s in 100 parts
        self.assertEqual(np.nanmin(low), values.min())
        # The newest samples, which no coarser level holds yet, are there as well.
        self.assertGreaterEqual(high[0, -1], values[-8:].max())

    def test_memory_is_bounded_and_what_was_forgotten_is_drawn_more_coarsely(self):
        capacity = 4096
        time, values, channel = self.filled(100_000, 500, capacity)
        for level in channel.levels:
            self.assertLessEqual(level.count, capacity)
            self.assertLessEqual(level.low.shape[1], 2 * capacity)
        low, high = channel.envelope(0.0, 100.0, 50)
        self.assertEqual(np.nanmax(high), values.max())
        self.assertEqual(np.nanmin(low), values.min())
        self.assertTrue(np.isfinite(low).all())

    def test_a_piece_larger_than_what_is_kept_loses_nothing(self):
        capacity = 512
        values = np.arange(40_000, dtype=np.float32)
        channel = Channel(["a"], capacity)
        channel.append(np.arange(7) * 1e-3, values[None, :7])
        channel.append(np.arange(7, 40_000) * 1e-3, values[None, 7:])
        low, high = channel.envelope(0.0, 40.0, 10)
        self.assertEqual((low[0, 0], high[0, -1]), (0.0, 39_999.0))
        # Every bin begins where the one before ended: items of 512 samples stand at their first one's time.
        self.assertTrue((low[0, 1:] - high[0, :-1] == 1.0).all())

    def test_a_value_stands_until_the_next(self):
        store = Store()
        store.append("OPERATOR", np.array([1.0, 3.0]), {"speed_request": np.array([0.5, -1.0])})
        self.assertTrue(np.isnan(store.at("OPERATOR.speed_request", 0.9)))
        self.assertEqual(store.at("OPERATOR.speed_request", 2.9), 0.5)
        envelope = store.envelopes(["OPERATOR.speed_request"], 2.0, 4.0, 4)["OPERATOR.speed_request"]
        store.hold("OPERATOR.speed_request", envelope, 2.0, 4.0)
        self.assertEqual(envelope[0][0], 0.5)
        self.assertEqual(envelope[0][2], -1.0)
        self.assertEqual(store.at("OPERATOR.speed_request", 3.5, True), -1.0)

    def test_levels_hold_the_samples_of_their_items(self):
        _, values, channel = self.filled(FACTOR * FACTOR + 3, 5)
        self.assertEqual([level.count for level in channel.levels[:4]], [67, 8, 1, 0])
        self.assertEqual(channel.levels[2].high[0, 0], values[:64].max())


class EventTest(unittest.TestCase):
    def event(self, channel, data):
        return b"\xed\xa1\xda\x01" + bytes(16) + len(channel).to_bytes(4, "big") + len(data).to_bytes(4, "big") + channel + data

    def test_a_log_that_grows_is_read_wherever_it_was_cut(self):
        whole = self.event(b"A", b"123") + self.event(b"BC", b"") + self.event(b"A", b"4")
        for cut in range(len(whole)):
            first, rest = parse_events(whole[:cut])
            second, rest = parse_events(rest + whole[cut:])
            self.assertEqual(first + second, [("A", b"123"), ("BC", b""), ("A", b"4")])
            self.assertEqual(rest, b"")

    def test_damage_is_skipped(self):
        events, rest = parse_events(b"xyz\xed\xa1" + self.event(b"A", b"1") + b"\xed\xa1\xda\x01" + b"\xff" * 30 + self.event(b"B", b"2"))
        self.assertEqual(events, [("A", b"1"), ("B", b"2")])
        self.assertEqual(rest, b"")


class IncomingTest(unittest.TestCase):
    def events(self, torque_time_offset=0, run_identity=1):
        """A second of ENCODER and TORQUE every 10 ms."""
        types = message_types()
        for k in range(100):
            for kind, channel in ((types.encoder_t, "ENCODER"), (types.torque_t, "TORQUE")):
                message = kind()
                message.run_identity, message.simulated_time, message.group_count = run_identity, k * 10_000_000, 1
                if channel == "ENCODER":
                    message.shaft_speed, message.shaft_position = [float(run_identity)], [0.0]
                else:
                    message.motor_torque = [5.0]
                    if k == 50:
                        message.simulated_time += torque_time_offset
                yield channel, message.encode()

    def test_an_answer_of_an_impossible_time_is_left_out(self):
        store = Store()
        Incoming(functools.partial(fill, store)).take(list(self.events(torque_time_offset=1 << 61)))
        self.assertAlmostEqual(store.last, 0.99)
        self.assertEqual(len(store.channels["TORQUE"].samples(-1.0, 1e12)[0]), 99)
        self.assertEqual(len(store.channels["ENCODER"].samples(-1.0, 1e12)[0]), 100)

    def test_another_run_on_the_bus_is_followed_in_place_of_the_first(self):
        store = Store()
        incoming = Incoming(functools.partial(fill, store), store.clear)
        incoming.take(list(self.events()))
        self.assertEqual(store.at("ENCODER.shaft_speed.0", 0.5), 1.0)
        incoming.take(list(self.events(run_identity=2))[:40])
        self.assertAlmostEqual(store.last, 0.19)
        self.assertEqual(store.at("ENCODER.shaft_speed.0", 0.1), 2.0)


class MinuteTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.minute = Minute()
        self.minute.take([("OPERATOR", b"begin"), ("PLANT_STATUS", b"ready"), ("ENCODER", b"0")], 0.0)
        for second in range(1, 100):
            moves = [("OPERATOR", b"moved at %d" % second)] if second in (30, 41) else []
            self.minute.take([*moves, ("ENCODER", b"%d" % second)], float(second))

    def written(self, later):
        path = self.folder / "minute.lcmlog"
        self.minute.write(path, later)
        return parse_events(path.read_bytes())[0]

    def test_what_stands_when_the_minute_begins_is_in_front_of_it(self):
        for later, move, first in ((0.0, b"moved at 30", b"39"), (1.5, b"moved at 30", b"41"), (3.0, b"moved at 41", b"42")):
            events = self.written(later)
            self.assertEqual({events[0], events[1]}, {("OPERATOR", move), ("PLANT_STATUS", b"ready")})
            self.assertEqual([data for channel, data in events if channel == "ENCODER"][0], first)
            self.assertEqual(events[-1], ("ENCODER", b"99"))

    def diagnosed(self, script):
        """The state and the tries of a diagnosis by a program of its own."""
        program = self.folder / "slewlab"
        program.write_text(f"#!/bin/sh\necho try >> {self.folder}/tries\n{script}\n")
        program.chmod(0o755)

        async def run():
            diagnosis = Diagnosis("crane.yaml", None, self.folder)
            diagnosis.minute = self.minute
            with unittest.mock.patch("desk.diagnosis.slewlab_program", lambda: program):
                await diagnosis.begin(None)
                await diagnosis.listening
            return diagnosis.state()

        return asyncio.run(run()), len((self.folder / "tries").read_text().split())

    def test_a_minute_that_is_refused_begins_later_and_what_cannot_be_told_is_no_failure(self):
        for script, state, tries in (("[ $(wc -l < TRIES) = 2 ] || exit 3", "done", 2), ("echo 'cannot tell, because'; exit 3", "cannot tell", 3),
                                     ("exit 1", "failed", 1)):
            (self.folder / "tries").unlink(missing_ok=True)
            found, count = self.diagnosed(script.replace("TRIES", f"{self.folder}/tries"))
            with self.subTest(state=state):
                self.assertEqual((found["state"], count), (state, tries))
        self.assertEqual(found["words"], [])


class AccessTest(unittest.TestCase):
    def test_only_its_own_pages_are_served(self):
        local = Access("127.0.0.1")
        self.assertIsNone(local.refuses(None, "127.0.0.1:8000"))
        self.assertIsNone(local.refuses("http://localhost:8000", "localhost:8000"))
        self.assertIn("evil.example", local.refuses("http://evil.example", "127.0.0.1:8000"))
        self.assertIn("127.0.0.1:9", local.refuses("http://127.0.0.1:9", "127.0.0.1:8000"))
        self.assertIn("evil.example", local.refuses("http://evil.example:8000", "evil.example:8000"))  # a name bent to loopback
        self.assertIn("null", local.refuses("null", "127.0.0.1:8000"))

    def test_what_a_token_allows(self):
        local, other = Access("127.0.0.1"), Access("0.0.0.0")
        self.assertEqual([local.may(t) for t in (None, "x", local.watching, local.steering)],
                         [(True, False), (True, False), (True, False), (True, True)])
        self.assertEqual([other.may(t) for t in (None, "x", local.steering, other.watching, other.steering)],
                         [(False, False), (False, False), (False, False), (True, False), (True, True)])

    def test_one_has_the_joystick_and_its_loss_lets_go(self):
        joystick = Joystick()
        self.assertTrue(joystick.take("a", 0.0))
        self.assertFalse(joystick.take("b", 0.1))
        joystick.move("b", 1.0, 0.1)
        self.assertEqual(joystick.request, 0.0)
        joystick.move("a", 0.7, 0.2)
        joystick.expire(0.2 + PATIENCE)
        self.assertEqual(joystick.request, 0.7)
        joystick.expire(0.21 + PATIENCE)
        self.assertEqual((joystick.request, joystick.holder), (0.0, None))
        self.assertIn("nothing was heard", joystick.lost)
        self.assertTrue(joystick.take("b", 1.0))
        joystick.stop = True
        self.assertFalse(joystick.release_stop("a"))
        self.assertTrue(joystick.stop)
        self.assertTrue(joystick.release_stop("b"))
        self.assertFalse(joystick.stop)
        joystick.move("b", -0.3, 1.1)
        joystick.give_back("b", "closed")
        self.assertEqual((joystick.request, joystick.lost), (0.0, "closed"))


class ChartsTest(unittest.TestCase):
    def titles(self, store):
        return {chart["title"]: [each["signal"] for each in chart["series"]] for chart in charts.charts({}, store)}

    def test_a_signal_is_drawn_that_begins_late_and_one_that_never_is_not(self):
        store = Store()
        difference = np.full(1000, np.nan)
        store.append("SENSORS", np.arange(1000) * 1e-3, {"tip_acceleration": np.zeros(1000), "house_acceleration": difference.copy()})
        difference[500:] = 0.1
        store.append("OBSERVER", np.arange(1000) * 1e-3, {"tip_difference": difference})
        found = self.titles(store)
        self.assertEqual(found["acceleration, measured minus observer"], ["OBSERVER.tip_difference"])
        self.assertEqual(found["acceleration, lateral"], ["SENSORS.tip_acceleration"])

    def test_an_axis_is_drawn_in_its_own_units_and_without_a_load(self):
        store, time = Store(), np.arange(10) * 0.01
        store.append("ENCODER", time, {"shaft_position": np.full((10, 1), 50.0), "shaft_speed": np.zeros((10, 1))})
        store.append("TRUTH", time, {"gearbox_torque": np.full((10, 1), 2e3), "rope_angle": np.zeros(10), "rod_angle": np.zeros(10)})
        axis = {"total_ratio": 80.0, "machine": {"kind": "axis", "ratio": 100.0, "position_unit": "m", "speed_unit": "m/s"}}
        shown = {chart["title"]: (chart["unit"], chart["series"][0]["scale"]) for chart in charts.charts(axis, store)}
        self.assertEqual(shown, {"speed of the axis": ("m/s", 0.01), "force on the axis": ("kN", 1e-3)})
        pose = charts.pose(axis, store, 0.05)
        self.assertEqual((pose["angle"], pose["rope"], pose["rod"]), (0.5, None, None))
        self.assertEqual(charts.quantities({})["gear"]["unit"], "MN m")

    def test_the_tip_is_where_it_is_against_the_boom_of_the_same_moment(self):
        # It turns with 0.02 rad/s and is bent by 30 mm at a radius of 25 m; TRUTH comes every 100 ms, SENSORS every 5 ms.
        store, fast, slow = Store(), np.arange(0.0, 9.96, 0.005), np.arange(0.0, 9.91, 0.1)
        store.append("SENSORS", fast, {"slew_angle": 0.02 * fast})
        store.append("TRUTH", slow, {"tip_displacement": 25.0 * 0.02 * slow + 0.03})
        for time in (5.03, 9.92, 9.955, 20.0):
            self.assertAlmostEqual(charts.pose({"tip_radius": 25.0}, store, time)["deflection"], 0.03, delta=1e-6)

    def test_a_signal_with_gaps_stays(self):
        store = Store(64)  # what is old is forgotten
        for k in range(20):
            time = 16 * k + np.arange(16.0)
            store.append("OBSERVER", time, {"tip_difference": np.full(16, 1.0 if k == 3 else np.nan)})
            self.assertEqual(charts.is_there("OBSERVER.tip_difference", store), k >= 3)

    def test_the_bands_of_the_play_compensation_are_drawn_once_it_has_acted(self):
        store = Store()
        time, torque = np.arange(100) * 0.01, np.zeros((100, 2))
        store.append("TORQUE", time, {"motor_torque": torque})
        store.append("CONTROLLER_STATE", time, {"average_torque": np.zeros(100), "offset_torque": np.zeros(100)})
        self.assertNotIn("compensation.high", self.titles(store)["motor torque"])
        store.append("CONTROLLER_STATE", time + 1.0, {"average_torque": np.zeros(100), "offset_torque": np.full(100, 25.0)})
        store.append("CONTROLLER_STATE", time + 2.0, {"average_torque": np.zeros(100), "offset_torque": np.zeros(100)})
        self.assertIn("compensation.high", self.titles(store)["motor torque"])


if __name__ == "__main__":
    unittest.main()
