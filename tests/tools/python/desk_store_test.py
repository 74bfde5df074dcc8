"""What a window of a store shows against the samples that it was filled with."""

import asyncio
import functools
import itertools
import json
import os
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from run_log import REPOSITORY, message_types

from desk import charts
from desk.access import PATIENCE, Access, Joystick
from desk.diagnosis import Diagnosis, Minute
from desk.gap import Gap, Nominal, read_nominal
from desk.recording import Recorder
from desk.server import Desk, spectra
from desk.source import Difference, Facts, Growing, Incoming, event_bytes, fill, last_event, parse_events, what_is_missing
from desk.steered_run import SteeredRun
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

    def test_the_value_at_a_time_is_the_samples_own_as_long_as_it_is_held(self):
        time, values, channel = self.filled(4000, 100, 1024)
        low, high = channel.range_at(3.7005)
        self.assertEqual((low[0], high[0]), (values[3700], values[3700]))
        low, high = channel.range_at(0.1)  # of which the newest level has forgotten the samples: what eight of them, or more, lie between
        self.assertLessEqual(low[0], values[100])
        self.assertGreaterEqual(high[0], values[100])
        self.assertLess(low[0], high[0])
        self.assertIsNone(channel.range_at(-1.0))

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

    def test_the_last_event_of_a_channel_is_found_from_behind(self):
        whole = self.event(b"OPERATOR", b"1") + self.event(b"OPERATOR", b"2") + self.event(b"A", b"of OPERATOR") + b"OPERATOR"
        cut = self.event(b"OPERATOR", b"3 is still being written")[:-1]
        self.assertEqual(last_event(whole + cut, "OPERATOR"), ("OPERATOR", b"2"))
        self.assertEqual(last_event(whole + cut, "A"), ("A", b"of OPERATOR"))
        self.assertIsNone(last_event(whole, "PLANT_STATUS"))

    def test_damage_is_skipped(self):
        events, rest = parse_events(b"xyz\xed\xa1" + self.event(b"A", b"1") + b"\xed\xa1\xda\x01" + b"\xff" * 30 + self.event(b"B", b"2"))
        self.assertEqual(events, [("A", b"1"), ("B", b"2")])
        self.assertEqual(rest, b"")


def events_of_a_second(torque_time_offset=0, run_identity=1, begin=0.0, groups=1):
    """A second of ENCODER and TORQUE every 10 ms."""
    types = message_types()
    for k in range(100):
        for kind, channel in ((types.encoder_t, "ENCODER"), (types.torque_t, "TORQUE")):
            message = kind()
            message.run_identity, message.simulated_time, message.group_count = run_identity, round(begin * 1e9) + k * 10_000_000, groups
            if channel == "ENCODER":
                message.shaft_speed, message.shaft_position = [float(run_identity)] * groups, [0.0] * groups
            else:
                message.motor_torque = [5.0] * groups
                if k == 50:
                    message.simulated_time += torque_time_offset
            yield channel, message.encode()


class IncomingTest(unittest.TestCase):
    def test_an_answer_of_an_impossible_time_is_left_out(self):
        store = Store()
        Incoming(functools.partial(fill, store)).take(list(events_of_a_second(torque_time_offset=1 << 61)))
        self.assertAlmostEqual(store.last, 0.99)
        self.assertEqual(len(store.channels["TORQUE"].samples(-1.0, 1e12)[0]), 99)
        self.assertEqual(len(store.channels["ENCODER"].samples(-1.0, 1e12)[0]), 100)

    def test_another_run_on_the_bus_is_followed_in_place_of_the_first(self):
        store = Store()
        incoming = Incoming(functools.partial(fill, store), store.clear)
        incoming.take(list(events_of_a_second()))
        self.assertEqual(store.at("ENCODER.shaft_speed.0", 0.5), 1.0)
        incoming.take(list(events_of_a_second(run_identity=2))[:40])
        self.assertAlmostEqual(store.last, 0.19)
        self.assertEqual(store.at("ENCODER.shaft_speed.0", 0.1), 2.0)

    def test_a_run_of_another_machine_may_have_another_number_of_motor_groups(self):
        for first, second in ((2, 1), (1, 3)):
            store = Store()
            incoming = Incoming(functools.partial(fill, store), store.clear)
            incoming.take([*events_of_a_second(groups=first), *list(events_of_a_second(run_identity=2, groups=second))[:20]])
            incoming.take(list(events_of_a_second(run_identity=2, groups=second))[20:])
            self.assertEqual([name for name in store.channels["TORQUE"].names if "torque" in name], [f"TORQUE.motor_torque.{group}" for group in range(second)])
            self.assertEqual((store.at(f"ENCODER.shaft_speed.{second - 1}", 0.5), round(store.last, 2)), (2.0, 0.99))


class FactsTest(unittest.TestCase):
    def test_of_another_run_in_the_folder_the_machine_is_told_anew(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        path, facts = folder / "run.json", Facts(folder / "run.lcmlog")
        self.assertEqual(facts.read(), {})
        for number, (text, known) in enumerate((('{"machine": 1}', 1), ('{"mach', 1), ('{"machine": 2}', 2), (None, 2))):  # half written, and taken away
            if text is None:
                path.unlink()
            else:
                path.write_text(text)
                os.utime(path, (1e9 + number,) * 2)  # whatever the clock of the file system can tell apart
            self.assertEqual(facts.read(), {"machine": known})


class GrowingTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.log = self.folder / "run.lcmlog"
        self.partial = self.folder / "run.lcmlog.partial"

    def followed(self):
        source = Growing(self.log)
        source.poll()
        self.addCleanup(lambda: source.file.close())
        return source

    def write(self, path, run_identity, count=200):
        path.write_bytes(b"".join(event_bytes(k, 0.0, *event) for k, event in enumerate(itertools.islice(events_of_a_second(run_identity=run_identity), count))))

    def test_another_run_in_the_same_folder_is_followed(self):
        self.write(self.partial, 1)
        source = self.followed()
        self.partial.rename(self.log)  # the run is complete
        self.assertFalse(source.poll())
        self.assertEqual(source.store.at("ENCODER.shaft_speed.0", 0.5), 1.0)
        # By slewlab run, or by whoever writes its log in another way; also the same run's once more, as of a folder that is copied again and again.
        for way, run_identity in (("removed", 2), ("kept", 2), ("copied", 1)):
            if way == "removed":
                self.log.unlink()
            self.write(self.partial, run_identity, 80)
            os.utime(self.partial, (2e9, 2e9))  # written later, whatever the clock of the file system can tell apart
            while source.poll():
                pass
            source.poll()
            with self.subTest(way=way):
                self.assertAlmostEqual(source.store.last, 0.39)
                self.assertEqual(source.store.at("ENCODER.shaft_speed.0", 0.1), run_identity)
            self.partial.unlink()
            self.write(self.log, 1)
            os.utime(self.log, (1e9, 1e9))
            source = self.followed()

    def test_of_two_logs_that_are_there_the_newer_one_is_followed(self):
        self.write(self.log, 1)
        self.write(self.partial, 2)
        for newer, speed in ((self.partial, 2.0), (self.log, 1.0)):
            for path in (self.log, self.partial):
                os.utime(path, (1e9 + (path == newer),) * 2)
            self.assertEqual(self.followed().store.at("ENCODER.shaft_speed.0", 0.5), speed)

    def test_a_log_that_is_written_anew_is_read_from_its_beginning(self):
        self.write(self.log, 1)
        source = self.followed()
        self.write(self.log, 2, 100)  # the same file
        source.poll()
        source.poll()
        self.assertEqual((source.store.at("ENCODER.shaft_speed.0", 0.1), round(source.store.last, 2)), (2.0, 0.49))


class RecorderTest(unittest.TestCase):
    def test_another_run_on_the_bus_ends_a_recording_where_the_first_one_ended(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        source, recorder = Said(1), Recorder(folder)
        source.waiting = [("OPERATOR", operator_of(1)), *events_of_a_second(begin=3.0)]
        recorder.attach(source)
        source.poll()
        recorder.begin()
        source.waiting = list(events_of_a_second(begin=4.0))
        source.poll()
        source.waiting = list(events_of_a_second(run_identity=2))
        source.poll()
        state = recorder.state()
        self.assertEqual((round(state["from"], 2), round(state["until"], 2), state["on"]), (3.99, 4.99, False))
        self.assertEqual(json.loads((folder / "recording_1" / "run.json").read_text())["recorded_until"], state["until"])
        self.assertEqual(len(parse_events((folder / "recording_1" / "run.lcmlog").read_bytes())[0]), 200 + 2)
        # What stood in the run before stands in no recording of the next one.
        recorder.begin()
        recorder.stop()
        events, _ = parse_events((folder / "recording_2" / "run.lcmlog").read_bytes())
        self.assertEqual([channel for channel, _ in events], ["TORQUE"])


def operator_of(run_identity):
    message = message_types().operator_t()
    message.run_identity = run_identity
    return message.encode()


class SteeredRunTest(unittest.TestCase):
    def test_the_play_compensation_is_offered_where_groups_can_work_against_each_other(self):
        run = SteeredRun("scenario.yaml", "runs", 10.0)
        run.compensation = []
        for groups, offered in ((1, None), (2, True)):
            efforts = [{"name": "motor force" if groups == 1 else f"motor torque of group {g + 1}", "unit": "N m"} for g in range(groups)]
            run.source = unittest.mock.Mock(facts={"play_compensation": True, "machine": {"efforts": [*efforts, {"name": "torque on the axis", "unit": "N m"}]}})
            self.assertEqual(run._compensates(), offered)


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


    def test_what_is_held_of_a_run_that_stands_still_is_bounded(self):
        with unittest.mock.patch("desk.diagnosis.MOST", 100):
            for number in range(1000):
                self.minute.take([("ENCODER", b"again %d" % number)], 99.0)
        events = self.written(0.0)
        self.assertEqual((len(events), events[-1]), (102, ("ENCODER", b"again 999")))
        self.assertEqual({events[0], events[1]}, {("OPERATOR", b"moved at 41"), ("PLANT_STATUS", b"ready")})


class Said:
    """A source of which everything that a run says in its first second waits to be heard."""

    is_live, name, remarks = True, "said", []

    def __init__(self, run_identity, facts=None):
        self.store, self.facts, self.waiting = Store(), facts or {}, list(events_of_a_second(run_identity=run_identity))
        self.incoming = Incoming(functools.partial(fill, self.store), self.store.clear)

    def poll(self):
        events, self.waiting = self.waiting, []
        return self.incoming.take(events)


NOMINAL = REPOSITORY / "config" / "cranes" / "thesis.yaml"
THESIS = Nominal(NOMINAL, 250.0, "N m")  # T100 of that crane's motors


class GapTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_an_observer_hears_all_of_its_run_and_nothing_of_another(self):
        observer, begin = self.folder / "slewlab-live-observer", asyncio.create_subprocess_exec
        observer.write_text("#!/bin/sh\nexec cat > $(mktemp $1.XXXXXX)\n")
        observer.chmod(0o755)
        minute, nominal = Minute(), Nominal(self.folder / "heard", 250.0, "N m")

        class Run:
            async def start(self, play_compensation):
                return Said(2)

            async def end(self):
                pass

        async def anew(third):
            async def slowly(*arguments, **options):
                for source in desk.sources:  # the desk goes on meanwhile
                    source.poll()
                return await begin(*arguments, **options)

            async def watch(source):
                gap = Gap(source, nominal, minute)
                with unittest.mock.patch("asyncio.create_subprocess_exec", slowly):
                    await gap.start()
                return gap

            desk = Desk([Said(1)], Access("127.0.0.1"), Run(), watch)
            desk.recorder = Recorder(self.folder)
            desk.recorder.attach(desk.sources[0])
            desk.gap = await watch(desk.sources[0])
            desk.sources[0].poll()
            await desk.start_anew(None)
            source = desk.sources[0]
            source.poll()
            self.assertTrue([event[1:] for event in minute.events] == list(events_of_a_second(run_identity=2)))
            for begin_at in third:
                source.waiting = list(events_of_a_second(run_identity=3, begin=begin_at))
                source.poll()
            await desk.gap.end()

        for run_identity, third in ((2, ()), (3, (0.0, 1.0))):  # the third one on the same bus, or in the same folder
            with unittest.mock.patch("desk.gap.messages_folder", lambda: self.folder):
                asyncio.run(anew(third))
            heard = [parse_events(path.read_bytes())[0] for path in self.folder.glob("heard.*")]
            expected = [event for begin_at in third or (0.0,) for event in events_of_a_second(run_identity=run_identity, begin=begin_at)]
            self.assertTrue(expected in heard, [len(each) for each in heard])

    def feeding(self, source):
        """A gap of a source, without its observer, and the minute that it keeps."""
        gap = Gap(source, THESIS, Minute())
        gap.process = unittest.mock.Mock()
        gap.process.stdin.is_closing.return_value = False
        gap.process.stdin.transport.get_write_buffer_size.return_value = 0
        source.incoming.taps.append(gap.feed)
        gap.block = 1.0
        return gap

    def test_of_another_run_on_the_bus_the_minute_and_the_usual_sizes_are_its_own(self):
        source = Said(1)
        gap = self.feeding(source)
        source.poll()
        self.tell(gap, 20, 0.5)
        gap._replace_observer = unittest.mock.AsyncMock()
        for run_identity, offset in ((2, 0.0), (2, -100.0)):  # also one that says again what was said: its time falls
            gap.beginning = unittest.mock.Mock()  # of another observer, which is not there yet
            gap.beginning.done.return_value = False
            source.waiting = [(channel, data) for channel, data in events_of_a_second(run_identity=run_identity, begin=100.0 + offset)]
            source.poll()
            self.assertEqual(gap.state()["signals"], [])
            self.assertEqual([event[1:] for event in gap.minute.events], list(events_of_a_second(run_identity=run_identity, begin=100.0 + offset)))
            self.tell(gap, 20, 0.5)

    def tell(self, gap, blocks, size):
        """Missing torques of so many characteristic times of 1 s, as the observer says them of a run that has come so far."""
        blocks_before = 0 if not gap.sizes else int(gap.sizes["missing_torque.0"][2].block) + 1
        time = blocks_before + np.arange(10 * blocks) / 10
        gap.source.store.last = max(gap.source.store.last, float(time[-1]))
        gap._take({"time": time.tolist(), "missing_torque": np.full((1, len(time)), size).tolist(), "acceleration_difference": {}})

    def test_a_gap_is_no_gap_below_a_share_of_the_nominal_machines_rated_torque(self):
        gap = self.feeding(Said(1))  # no run.json: of a bus, or a machine that is none of slewlab's runs
        self.tell(gap, 12, 3e-13)
        self.tell(gap, 2, 8e-4)
        self.assertIsNone(gap.since)
        self.tell(gap, 2, 4.9)  # 2 % of 250 N m are 5 N m
        self.assertIsNone(gap.since)
        self.tell(gap, 2, 5.1)
        self.assertAlmostEqual(gap.since, 17.9)
        self.assertEqual(read_nominal(NOMINAL), THESIS)

    def test_an_observer_that_begins_again_learns_anew_what_is_usual(self):
        for begins_again in (False, True):
            gap = self.feeding(Said(1))
            self.tell(gap, 20, 0.5)
            if begins_again:
                gap._learn_anew("gap of 0.501 s in ENCODER")
                self.assertEqual(gap.state()["signals"], [])
                self.assertIn("learned anew: gap of 0.501 s", gap.state()["remark"])
            self.tell(gap, 20, 50.0)
            self.assertEqual(gap.since is None, begins_again)

    def test_it_is_said_from_when_on_the_usual_size_is_known(self):
        gap = self.feeding(Said(1))
        self.tell(gap, 3, 0.5)
        self.assertEqual((gap.state()["signals"][0]["usual"], gap.state()["usual_from"]), (None, 10.0))
        self.tell(gap, 8, 0.5)  # a block is over when the next one begins
        self.assertEqual((gap.state()["signals"][0]["usual"], gap.state()["usual_from"]), (0.5, None))

    def test_what_a_linear_axis_lacks_is_a_force(self):
        axis = self.folder / "axis.yaml"
        axis.write_text("kind: axis\ndescription: A linear motor.\ncoordinate: {value: linear, source: test}\nmass: {value: 95, unit: kg, source: test}\n"
                        "rated_force: {value: 600, unit: N, source: test}\ntop_speed: {value: 0.3, unit: m/s, source: test}\n")
        gap = self.feeding(Said(1))
        gap.nominal = read_nominal(axis)
        self.tell(gap, 12, 0.1)
        self.assertEqual([(each["label"], each["unit"]) for each in gap.state()["signals"]], [("missing force of group 1", "N")])
        self.tell(gap, 2, 11.9)  # 2 % of 600 N
        self.assertIsNone(gap.since)
        self.tell(gap, 2, 12.1)
        self.assertIsNotNone(gap.since)


class ControllerTest(unittest.TestCase):
    """What the desk says of a controller that stops by itself."""

    def asked_and_answered(self, questions, answers, begin=0):
        """Events of ENCODER every 10 ms, the first of them answered."""
        types = message_types()
        for k in range(begin, begin + questions):
            for kind, channel in ((types.encoder_t, "ENCODER"), (types.torque_t, "TORQUE"))[:2 if k < begin + answers else 1]:
                message = kind()
                message.run_identity, message.simulated_time, message.group_count = 1, k * 10_000_000, 1
                if channel == "ENCODER":
                    message.sequence, message.shaft_speed, message.shaft_position = k, [0.0], [0.0]
                else:
                    message.answered_sequence, message.motor_torque = k, [0.0]
                yield channel, message.encode()

    def desk(self, is_repeated=False, run=None):
        self.now = 100.0
        self.enterContext(unittest.mock.patch("time.monotonic", lambda: self.now))
        self.source = Said(1)
        self.source.is_repeated, self.source.waiting = is_repeated, []
        return Desk([self.source], Access("127.0.0.1"), run)

    def later(self, desk, events=(), seconds=10.0):
        self.now += seconds
        self.source.waiting = list(events)
        desk.poll(self.source)
        return desk.trouble(self.source)

    def test_nothing_is_said_of_one_that_answers(self):
        desk = self.desk()
        for begin in range(0, 50, 10):
            self.assertEqual(self.later(desk, self.asked_and_answered(10, 10, begin)), "")
            # Against the wall clock, looked at between question and answer.
            self.assertEqual(self.later(desk, self.asked_and_answered(6, 5, begin + 10)), "")
        self.source.facts = {"end": "complete"}
        self.assertEqual(self.later(desk), "")

    def test_a_plant_that_waits_for_its_controller_says_since_when(self):
        for run, is_repeated, words in ((None, False, "The plant waits for it, or has ended."), (unittest.mock.Mock(), False, "The plant waits for it: the run stands still.")):
            desk = self.desk(is_repeated, run)
            self.assertEqual(self.later(desk, self.asked_and_answered(101, 100)), "")
            self.assertEqual(self.later(desk, seconds=1.9), "")
            self.assertEqual(self.later(desk, seconds=0.2), f"The controller has answered nothing since 0.990 s. {words}")
            self.assertEqual(self.later(desk, self.asked_and_answered(10, 10, 100)), "")

    def test_on_a_bus_the_question_is_heard_again_while_the_plant_is_there(self):
        desk = self.desk(is_repeated=True)
        self.later(desk, self.asked_and_answered(101, 100))
        again = list(self.asked_and_answered(1, 0, 100))
        self.assertEqual(self.later(desk, again), "The controller has answered nothing since 0.990 s. The plant waits for it: the run stands still.")
        self.assertEqual(self.later(desk), "")

    def test_against_the_wall_clock_questions_go_on_without_answers(self):
        desk = self.desk()
        self.later(desk, self.asked_and_answered(101, 100))
        self.assertEqual(self.later(desk, self.asked_and_answered(100, 0, 101)), "The controller has answered nothing since 0.990 s.")

    def test_one_that_never_answered_is_told_so(self):
        desk = self.desk()
        self.later(desk, self.asked_and_answered(1, 0))
        self.assertEqual(self.later(desk), "The controller has not answered at all. The plant waits for it, or has ended.")

    def test_a_process_that_ended_is_told_with_its_exit_code(self):
        desk = self.desk()
        self.source.facts = {"end": "the controller ended before its time: exit code 7 at 2.0 s of simulated time"}
        self.assertEqual(self.later(desk, self.asked_and_answered(10, 10)), "The controller ended before its time: exit code 7 at 2.0 s of simulated time.")


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
        # What a motor that does not turn gives is a force (run.json of an axis with rated_force); one that turns drives a linear axis by torque.
        store.append("TORQUE", time, {"motor_torque": np.full((10, 1), 300.0)})
        store.append("OBSERVER", time, {"missing_torque": np.full((10, 1), 1.0)})
        for name, unit, words in (("motor force", "N", ("motor force", "missing force", "N per motor", "% of the rated force")),
                                  ("motor torque", "N m", ("motor torque", "missing torque", "N m per motor", "% of T100"))):
            axis["machine"]["efforts"] = [{"name": name, "unit": unit}, {"name": "force on the axis", "unit": "N"}]
            for rated, shown_in in ((None, words[2]), (600.0, words[3])):
                shown = {chart["title"]: chart["unit"] for chart in charts.charts(axis | {"rated_torque": rated}, store)}
                self.assertEqual((shown[words[0]], shown[f"{words[1]}, of the machine against its nominal model"]), (shown_in, shown_in))
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

    def test_where_messages_are_missing_nothing_is_drawn_and_no_value_told(self):
        store, time = Store(), np.concatenate((np.arange(0, 500), np.arange(800, 2000))) * 0.01
        store.append("OPERATOR", np.array([0.0, 6.0]), {"speed_request": np.array([0.0, 1.0])})
        store.append("ENCODER", time, {"shaft_speed": time[:, None]})
        store.append("TORQUE", time, {"motor_torque": np.full((len(time), 1), 7.0)})
        signals = ["OPERATOR.speed_request", "ENCODER.shaft_speed.0", "TORQUE.motor_torque.0"]
        # Samples at 4.99 s and 8.00 s: of 100 columns over 20 s those from 5.0 to 8.0 s; of a window within it all of them.
        for first, last, columns in ((0.0, 20.0, [25, 40]), (6.0, 7.0, [0, 100]), (0.0, 5.0, None), (7.5, 8.5, [0, 50])):
            found = charts.holes(store, signals, first, last, 100)
            self.assertEqual(found, {} if columns is None else {signal: [columns] for signal in signals[1:]})
            envelopes = charts.envelopes(store, signals, first, last, 100)
            if columns:
                self.assertTrue(np.isnan(envelopes["TORQUE.motor_torque.0"][0][slice(*columns)]).all(), "a torque stands, but not for seconds")
        self.assertEqual(charts.values(store, signals, 4.995), {"OPERATOR.speed_request": (0.0, 0.0)})
        self.assertEqual(charts.values(store, signals, 7.0), {"OPERATOR.speed_request": (1.0, 1.0)})
        self.assertEqual(charts.values(store, signals, 9.006)["TORQUE.motor_torque.0"], (7.0, 7.0))
        self.assertAlmostEqual(charts.values(store, signals, 9.006)["ENCODER.shaft_speed.0"][0], 9.0, delta=1e-6)
        self.assertEqual(what_is_missing(store), ["messages are missing from 4.99 to 8.00 s"])
        store.append("TRUTH", np.arange(0, 2000) * 0.01, {"house_speed": np.zeros(2000)})
        self.assertEqual(what_is_missing(store), ["messages are missing of ENCODER, TORQUE from 4.99 to 8.00 s"])

    def stopped(self):
        """A controller that answers until 10 s and then no more; the plant goes on until 30 s."""
        store, time = Store(), np.arange(0, 3000) * 0.01
        early = time[time <= 10.0]
        store.append("ENCODER", time, {"shaft_speed": time[:, None]})
        store.append("SENSORS", early, {"slew_angle": early})
        store.append("TORQUE", early, {"motor_torque": np.full((len(early), 1), 30.0)})
        store.append("CONTROLLER_STATE", early, {"mode": np.ones(len(early))})
        return store

    def test_a_channel_that_has_stopped_has_no_value_and_no_line_from_then_on(self):
        store = self.stopped()
        signals = ["ENCODER.shaft_speed.0", "TORQUE.motor_torque.0"]
        for time, names in ((9.9, signals), (10.04, signals), (10.07, signals[:1]), (20.0, signals[:1]), (29.99, signals[:1])):
            self.assertEqual(list(charts.values(store, signals, time)), names, time)
        for first, last, columns in ((0.0, 20.0, [51, 100]), (12.0, 22.0, [0, 100]), (0.0, 10.0, None)):
            self.assertEqual(charts.holes(store, signals, first, last, 100), {} if columns is None else {signals[1]: [columns]})
            if columns:
                self.assertTrue(np.isnan(charts.envelopes(store, signals, first, last, 100)[signals[1]][0][slice(*columns)]).all())
        self.assertEqual([charts.pose({}, store, time)["angle"] for time in (9.0, 20.0)], [9.0, None])

    def test_a_controller_that_has_stopped_is_silent_from_then_on(self):
        store = self.stopped()
        self.assertEqual([charts.state(store, time)["silent"] for time in (9.9, 10.04, 10.07, 29.0)], [False, False, True, True])
        self.assertEqual(charts.state(store, 9.9)["controller"], "running")
        # Where nobody says anything, it is not the controller alone.
        store = Store()
        for begin in (0.0, 20.0):
            time = begin + np.arange(500) * 0.01
            store.append("ENCODER", time, {"shaft_speed": time[:, None]})
            store.append("TORQUE", time, {"motor_torque": time[:, None]})
            store.append("CONTROLLER_STATE", time, {"mode": np.ones(500)})
        self.assertEqual([(said["controller"], said["silent"]) for said in (charts.state(store, 10.0), charts.state(store, 22.0))],
                         [(None, False), ("running", False)])

    def test_an_observer_may_be_behind_the_run_as_far_as_it_waits_for_the_drives_state(self):
        for has_status in (True, False):
            store, signal = Store(), "OBSERVER.tip_difference"
            store.append("OBSERVER", np.arange(0, 910) * 0.01, {"tip_difference": np.zeros(910)})
            for name in ("ENCODER", "TORQUE"):
                store.append(name, np.arange(0, 1000) * 0.01, {"x": np.zeros(1000)})
            if has_status:
                store.append("PLANT_STATUS", np.arange(0.0, 10.0), {"drive_state": np.zeros(10)})
            self.assertIn(signal, charts.values(store, [signal], store.last))
            store.append("ENCODER", np.arange(1000, 1200) * 0.01, {"x": np.zeros(200)})
            if has_status:
                store.append("PLANT_STATUS", np.arange(10.0, 12.0), {"drive_state": np.zeros(2)})
            self.assertNotIn(signal, charts.values(store, [signal], store.last))

    def test_the_newest_sample_takes_part_in_the_spectrum_at_any_period(self):
        for period in (0.001, 0.004, 0.005, 0.007, 0.01):
            time = np.arange(round(40.0 / period)) * period
            for at in (30.0, 30.0 + 0.4 * period, 33.333):
                found = []
                for newest in (0.0, 1e6):
                    store, values = Store(), np.sin(2 * np.pi * 2.0 * time)
                    values[np.searchsorted(time, at, "right") - 1] += newest
                    store.append("SENSORS", time, {"tip_acceleration": values})
                    found.append(spectra(unittest.mock.Mock(facts={}, store=store), at)[0])
                self.assertNotEqual(found[0]["amplitude"], found[1]["amplitude"], (period, at))
                self.assertAlmostEqual(max(found[0]["amplitude"]), 1.0, delta=0.02)

    def test_a_trip_stands_from_its_time_on_as_soon_as_the_message_that_tells_it_is_there(self):
        store, time = Store(), np.arange(0.0, 6.0)

        def append(begin, end):
            store.append("PLANT_STATUS", time[begin:end], {field: np.array(values)[begin:end] for field, values in (
                ("drive_state", [1, 1, 1, 2, 1, 1]), ("trip_cause", [0, 0, 0, 13, 0, 0]), ("trip_time", [-1, -1, -1, 2.25e9, 2.25e9, 2.25e9]))})
        append(0, 3)
        self.assertEqual(charts.state(store, 2.9)["drive"], "running")
        append(3, 6)
        for at, drive, trip_time in ((1.9, "running", None), (2.2, "running", None), (2.25, "tripped", 2.25), (2.9, "tripped", 2.25), (3.0, "tripped", 2.25)):
            said = charts.state(store, at)
            self.assertEqual((said["drive"], said["trip_time"] and round(said["trip_time"], 6), bool(said["trip"])), (drive, trip_time, drive == "tripped"), at)
        for at in (4.5, 5.5):  # acknowledged
            self.assertEqual((charts.state(store, at)["drive"], charts.state(store, at)["trip"]), ("running", ""))

    def test_two_logs_have_no_difference_where_one_has_no_messages(self):
        whole, cut = np.arange(0, 2000) * 0.01, np.concatenate((np.arange(0, 500), np.arange(800, 2000))) * 0.01
        sources = [unittest.mock.Mock(facts={}, store=Store()) for _ in range(2)]
        for source, time, other in ((sources[0], whole, 1.0), (sources[1], cut, 0.0)):
            source.name = "log"
            source.store.append("OPERATOR", time[::1000], {"speed_request": np.full(len(time[::1000]), other)})
            source.store.append("ENCODER", time, {"shaft_speed": np.full((len(time), 1), other)})
            source.store.append("TORQUE", time, {"motor_torque": np.full((len(time), 1), other)})
        for pair, sign in ((sources, 1.0), (sources[::-1], -1.0)):
            found = Difference(*pair).store
            for signal in ("ENCODER.shaft_speed.0", "TORQUE.motor_torque.0"):
                self.assertEqual(charts.values(found, [signal], 4.0), {signal: (sign, sign)})
                self.assertEqual(charts.values(found, [signal], 6.0), {})
                self.assertEqual(charts.holes(found, [signal], 0.0, 20.0, 100), {signal: [[25, 40]]})
            self.assertIn("OPERATOR.speed_request", charts.values(found, ["OPERATOR.speed_request"], 6.0))

    def test_two_logs_have_no_difference_before_a_channel_of_one_begins_nor_behind_its_end(self):
        long, short = np.arange(0, 2000) * 0.01, np.arange(750, 1500) * 0.01
        sources = [unittest.mock.Mock(facts={}, store=Store()) for _ in range(2)]
        for source, time in ((sources[0], long), (sources[1], short)):
            source.name = "log"
            source.store.append("OPERATOR", np.array([0.0, 20.0]), {"speed_request": np.zeros(2)})  # in front of a recording, and behind it
            source.store.append("ENCODER", time, {"shaft_speed": time[:, None] ** 2})
            source.store.append("TORQUE", time, {"motor_torque": time[:, None] ** 2})
        for pair in (sources, sources[::-1]):
            found = Difference(*pair).store
            for channel in ("ENCODER", "TORQUE"):
                time, rows = found.channels[channel].samples(-np.inf, np.inf)
                self.assertEqual((time[0], time[-1], np.abs(rows).max()), (short[0], short[-1], 0.0))

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
