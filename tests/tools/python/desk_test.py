"""The desk in a headless Chromium."""

import asyncio
import contextlib
import io
import json
import os
import re
import signal
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import made_run
from desk_store_test import THESIS, Said, events_of_a_second
from browser import PATIENCE, Browser, contrast_of, overlaps
from desk import charts
from desk.access import Access, Joystick
from desk.diagnosis import Minute
from desk.gap import Gap
from desk.recording import Recorder
from desk.server import Desk
from desk.source import HELD, parse_events
from desk.steered_run import SteeredRun, motion_requests, moves_under_a_stop
from desk.store import Store
from run_log import REPOSITORY, message_types, read_run_log, seconds

RATED_TORQUE = 250.0  # [N m] T100 of config/controllers/thesis.yaml
SLEWLAB = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin" / "slewlab"


class DeskProcess:
    """`slewlab desk` with the address that it prints."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([SLEWLAB, "desk", *map(str, arguments)], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        self.address = re.search(r"http://\S+", line).group(0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(PATIENCE)
        self.process.stdout.close()


HEAD_BEFORE_HASHES, HEAD = 24, 40  # [bytes] fingerprint, sequence, time; configuration hash and run identity


def messages(log):
    """(channel, bytes without the two hashes of the configuration) of a log."""
    events, rest = parse_events(Path(log).read_bytes())
    assert rest == b""
    return [(channel, data[:HEAD_BEFORE_HASHES] + data[HEAD:]) for channel, data in events]


def origin_is_refused(address, origin):
    """Whether a WebSocket from a page of that origin is turned away, with 403."""
    try:
        with connect(address.replace("http:", "ws:").split("#")[0] + "socket", origin=origin):
            return False
    except InvalidStatus as refusal:
        return refusal.response.status_code == 403


def steered_to_its_end(scenario, out, duration, wishes):
    """A SteeredRun as fast as it goes, to its end; `wishes`: (speed request, emergency stop) one after the other, each once the one before
    was obeyed."""
    async def run():
        steered, joystick = SteeredRun(scenario, out, duration), Joystick()
        await steered.start()
        await steered.begins()
        for joystick.request, joystick.stop in wishes:
            steered.operate(joystick)
            while not any(move[1:3] == (joystick.request, joystick.stop) for move in steered.source.incoming.moves):
                steered.source.poll()
                await asyncio.sleep(0)
        await steered.command("speed", {"speed": 0})
        await steered.listening
        await steered.end()
        steered.source.file.close()
        return steered

    return asyncio.run(run())


class PartsTest(unittest.TestCase):
    """Parts of the desk, without a page."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_a_run_whose_crane_hoists_luffs_and_travels_is_done_again_to_the_bit(self):
        scenario = self.folder / "moves.yaml"
        scenario.write_text(f"include: {REPOSITORY}/config/scenarios/moves_while_slewing.yaml\n"
                            "operator:\n"
                            "  - {time: {value: 600, unit: ms, source: test}, hoisting_request: {value: 1, unit: '-', source: test}, speed_request: {value: 1, unit: '-', source: test}}\n"
                            "  - {time: {value: 1.001, unit: s, source: test}, luffing_request: {value: -1, unit: '-', source: test}}\n"
                            "  - {time: {value: 2, unit: s, source: test}, emergency_stop: {value: true, source: test}}\n"
                            "  - {time: {value: 3, unit: s, source: test}, emergency_stop: {value: false, source: test}, travelling_request: {value: 1, unit: '-', source: test}}\n")
        run = steered_to_its_end(scenario, self.folder / "runs", 5.0, [(0.0, False), (0.5, False)])
        again = subprocess.run([SLEWLAB, "run", run.folder / "steered.yaml", "--out", self.folder / "again"], stdin=subprocess.DEVNULL,
                               capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        motion = read_run_log(run.folder / "run.lcmlog").channel("MOTION")
        self.assertGreater(motion["travelled"][-1], 0.05)
        self.assertLess(motion["boom_angle"][-1], motion["boom_angle"][0])
        recorded, repeated = messages(run.folder / "run.lcmlog"), messages(self.folder / "again" / "run.lcmlog")
        self.assertEqual(len(recorded), len(repeated))
        self.assertTrue(recorded == repeated, "a message differs")

    def test_the_tip_of_a_boom_that_luffs_is_bent_against_the_radius_of_the_moment(self):
        # The house stands at 1.7 rad. The boom, 40 m from a pivot at 3 m, goes down from 1 rad by 0.02 rad/s in stretches of 10 ms, each at the
        # angle of its middle, and is bent by 30 mm.
        shape = {"pivot_radius": 3.0, "boom_length": 40.0, "boom_angle": 1.0, "rope_length": 50.0, "rod_length": 1.0}
        store, time = Store(), np.arange(0, 1000) * 0.01
        radius = 3.0 + 40.0 * np.cos(1.0 - 0.02 * (time - 0.005))
        store.append("SENSORS", time, {"slew_angle": np.full(1000, 1.7)})
        store.append("TRUTH", time, {"tip_displacement": 1.7 * radius + 0.03})
        store.append("MOTION", time, {"boom_angle": 1.0 - 0.02 * time, "rope_length": 50.0 - time, "travelled": 0.0 * time})
        facts = {"geometry": shape, "tip_radius": 3.0 + 40.0 * np.cos(1.0), "controller_period": 0.01}
        for at in (1.0, 5.003, 9.99, 20.0):
            pose = charts.pose(facts, store, at)
            self.assertAlmostEqual(pose["deflection"], 0.03, delta=1e-4)  # of a store's single precision
            self.assertAlmostEqual(pose["motion"]["rope_length"], 50.0 - min(at, 9.99), delta=1e-4)
        bent = facts | {"tip_radius": facts["tip_radius"] + 1.0}
        self.assertIsNone(charts.pose(bent, store, 5.0)["deflection"])
        self.assertIsNone(charts.pose({}, store, 5.0)["deflection"])

    def test_a_machine_that_moves_otherwise_than_by_slewing_is_not_compared(self):
        def motion_of(run_identity, time, **fields):
            message = message_types().motion_t()
            message.run_identity, message.simulated_time = run_identity, round(time * 1e9)
            for field, value in ({"rope_length": 60.0, "boom_angle": 0.9, "travelled": 0.0} | fields).items():
                setattr(message, field, value)
            return "MOTION", message.encode()

        def said(begin):  # a size that jumps
            return {"time": [begin + 0.1 * k for k in range(10)], "missing_torque": [[0.5 if begin < 30 else 90.0] * 10], "acceleration_difference": {}}

        shape = {"boom_angle": 0.9, "rope_length": 60.0}
        for facts, fields, does in (({"geometry": shape}, {"boom_angle": 0.89}, "luffs"), ({}, {"rope_length": 59.0, "travelled": 0.01}, "hoists and travels"),
                                    ({}, {}, None)):
            source = Said(1, facts)
            gap = Gap(source, THESIS, Minute())
            gap.process, gap.block = unittest.mock.Mock(), 1.0
            gap.process.stdin.is_closing.return_value = False
            gap.process.stdin.transport.get_write_buffer_size.return_value = 0
            source.incoming.taps.append(gap.feed)
            source.waiting += [motion_of(1, 0.0), motion_of(1, 20.0)]
            source.poll()
            for begin in range(30):
                gap._take(said(begin))
            self.assertEqual((gap.state()["problem"], gap.state()["since"]), ("", None))
            source.waiting = [motion_of(1, 31.0, **fields)]
            source.poll()
            for begin in range(30, 40):
                gap._take(said(begin))
            state = gap.state()
            with self.subTest(does=does):
                if does is None:
                    self.assertEqual((state["problem"], [each["open"] for each in state["signals"]]), ("", [True]))
                    continue
                self.assertIn(f"the machine {does}, and so moves otherwise than by slewing: from 31.0 s on it is not compared", state["problem"])
                self.assertEqual((state["signals"], state["since"]), ([], None))
                self.assertLess(source.store.channels["OBSERVER"].last_time, 31.0)

    def test_a_recording_tells_how_its_run_ended(self):
        killed = "the plant ended before its time: killed by signal 9 (Killed)"
        for number, (at_its_end, told) in enumerate((("under way", "complete"), ("complete", "complete"), (killed, killed)), 1):
            source, recorder = Said(1, {"end": "under way"}), Recorder(self.folder)
            recorder.attach(source)
            source.poll()
            recorder.begin()
            source.waiting = list(events_of_a_second(begin=1.0))
            source.poll()
            source.facts = {"end": at_its_end}
            recorder.stop()
            folder = self.folder / f"recording_{number}"
            self.assertEqual(json.loads((folder / "run.json").read_text())["end"], told)
            report = subprocess.run([SLEWLAB, "report", folder], capture_output=True, text=True, timeout=PATIENCE)
            self.assertEqual(killed in (folder / "report.html").read_text(), told == killed, report.stderr)

    def test_a_recording_of_a_log_that_is_followed_ends_with_its_run(self):
        now = self.enterContext(unittest.mock.patch("time.monotonic", return_value=100.0))
        source = Said(1, {"end": "under way"})
        desk = Desk([source], Access("127.0.0.1"))
        desk.recorder = Recorder(self.folder)
        desk.recorder.attach(source)

        def later(seconds, events=()):
            now.return_value += seconds
            source.waiting = list(events)
            desk.end_recording(desk.poll(source))
            return desk.recorder.state()["on"]

        desk.poll(source)
        desk.recorder.begin()
        self.assertTrue(later(0.1, events_of_a_second(begin=1.0)))
        self.assertTrue(later(60.0), "a run that says nothing goes on")
        source.facts = {"end": "the plant ended before its time: exit code 1"}
        self.assertTrue(later(1.0, events_of_a_second(begin=2.0)))
        self.assertTrue(later(1.0))
        self.assertFalse(later(1.0))
        self.assertEqual(json.loads((self.folder / "recording_1" / "run.json").read_text())["end"], "the plant ended before its time: exit code 1")
        self.assertEqual([path.name for path in (self.folder / "recording_1").glob("run.lcmlog*")], ["run.lcmlog"])

    def test_a_request_that_names_two_hosts_or_origins_is_refused_in_words(self):
        desk, own = Desk([], Access("127.0.0.1")), ("Host", "127.0.0.1:8000")
        for more, status in (((), 200), ((own,), 400), ((("host", "evil.example"),), 400), ((("Origin", "http://127.0.0.1:8000"), ("Origin", "http://evil.example")), 400),
                             ((("Origin", "http://evil.example"),), 403)):
            answer = desk.answer_http(None, unittest.mock.Mock(headers=Headers([own, *more]), path="/"))
            self.assertEqual(answer.status_code, status, more)
        for headers, path, status in ((Headers(), "/", 403), (Headers([("Host", "[")]), "/", 400), (Headers([own]), "//[", 400)):
            self.assertEqual(desk.answer_http(None, unittest.mock.Mock(headers=headers, path=path)).status_code, status)

    def test_moves_that_an_emergency_stop_of_the_desk_does_not_end_are_refused_as_a_scenario(self):
        def entry(time, **requests):
            return {"time": {"value": time, "unit": "s"}} | {f"{motion}_request": {"value": value, "unit": "-"} for motion, value in requests.items()}

        requests = motion_requests([entry(2, hoisting=1), entry(4, hoisting=0, luffing=-1), entry(6, luffing=0)])
        for pressed, released, found in ((1, 2, []), (1, 3, ["hoisting"]), (3, 3.5, ["hoisting"]), (4, 5, ["luffing"]), (3, None, ["hoisting", "luffing"]), (6, None, [])):
            moves = [(0, False), (round(pressed * 1e9), True), *([(round(released * 1e9), False)] if released else [])]
            self.assertEqual(moves_under_a_stop(requests, moves, 10e9), found, (pressed, released))
        self.assertEqual(moves_under_a_stop(requests, [(0, False), (10**9, True)], 2e9), [])
        scenario = REPOSITORY / "config" / "scenarios" / "moves_while_slewing.yaml"
        with contextlib.redirect_stderr(io.StringIO()) as told:
            run = steered_to_its_end(scenario, self.folder / "runs", 3.0, [(0.0, False), (0.5, True)])
        self.assertIn("no scenario does the same: the machine went on hoisting while the emergency stop of the desk was pressed", told.getvalue())
        self.assertFalse((run.folder / "steered.yaml").exists())
        self.assertEqual(asyncio.run(run.command("save", {}))["type"], "refused")


class DeskTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Browser())

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def open(self, address, **options):
        page = self.browser.open(address, **options)
        self.addCleanup(lambda: self.assertEqual(page.complaints, []))
        page.until("desk.drawn > 0")
        return page

    def test_a_recorded_log_is_scrubbed(self):
        events = made_run.messages()
        for channel, time, message in events:
            if channel == "TORQUE":  # group 2 by 2 % of T100 more every 10 ms, and from the beginning again every 100 ms
                message.motor_torque = [message.motor_torque[0], message.motor_torque[1] + 5.0 * (time // 10_000_000 % 10)]
        with DeskProcess(made_run.write_run(self.folder / "a", events=events)) as desk:
            page = self.open(desk.address)
            self.assertIn("slewing speed", page.value("document.body.innerText"))
            page.value("desk.seek(NaN), desk.send({type: 'view', from: null, to: 1, at: 1, pixels: 100, signals: []})")
            page.until("document.getElementById('notice').innerText.includes('not understood')")
            # Its spectrum is of the last place that was asked for, however soon after the first. The tip swings with 1.3 and 5.2 Hz.
            page.value("desk.seek(15)")
            page.until("desk.spectrumChart")
            page.until("(() => { const [f, tip] = desk.spectrumChart.plot.data, at = (x) => tip[f.findIndex((each) => each >= x)];"
                       " return at(1.3) > 10 * at(0.6) && at(5.2) > 10 * at(9); })()")
            # Modes that the axis does not show are named beside it.
            self.assertRegex(page.value("desk.spectrumChart.legend.innerText"), r"off the axis: load 1 0\.07")
            self.assertNotIn("bending 1", page.value("desk.spectrumChart.legend.innerText"))
            # The run's messages say: -50 N m of 250 before the stop at 10 s in group 2, 30 N m behind it, and what it changes by; a request of
            # 1 from 2 s on. What is told is the message at the cursor or before it, however many of them a column of pixels holds.
            for width, span in ((1400, 20), (1400, 0), (420, 2), (420, 0)):
                page.size(width, 900)
                page.value(f"document.getElementById('span').value = '{span}', document.getElementById('span').dispatchEvent(new Event('change'))")
                for time, torque, request in ((1.0, -20.0, "0 %"), (5.094, -2.0, "100 %"), (9.999, -2.0, "100 %"), (15.025, 16.0, "100 %, emergency stop")):
                    page.value(f"document.getElementById('scrub').value = {time}, "
                               "document.getElementById('scrub').dispatchEvent(new Event('input'))")
                    page.until(f"Math.abs(desk.charts[1].cursor - {time}) < 0.0001")
                    shown = page.value("[...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque')).querySelectorAll('b')[1].textContent")
                    self.assertEqual(float(shown), torque, (width, span, time))
                    self.assertIn(f"request\n{request}\n", page.value("document.getElementById('facts').innerText"))
                # Two numbers at least say what a chart's height is.
                self.assertEqual(page.value("desk.charts.filter(c => new Set(c.plot.axes[1]._values.filter(Boolean)).size < 2).map(c => c.description.title)"), [])
            page.size(1400, 900)
            # A part that was zoomed to is left by a double click.
            page.value("document.getElementById('span').value = '20', document.getElementById('span').dispatchEvent(new Event('change'))")
            x, y, width = page.middle(".chart .u-over")
            page.mouse("mousePressed", x - 0.2 * width, y)
            page.mouse("mouseMoved", x, y)
            page.mouse("mouseReleased", x + 0.2 * width, y)
            page.until("desk.charts[0].plot.scales.x.max - desk.charts[0].plot.scales.x.min < 10")
            for count in (1, 2):
                for kind in ("mousePressed", "mouseReleased"):
                    page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=count)
            page.until("desk.window === null && desk.charts[0].plot.scales.x.max - desk.charts[0].plot.scales.x.min === 20")
            page.value("desk.seek(15)")
            # Played ten times as fast from 15 s on, it comes to its end at 20 s and stops there.
            page.value("document.getElementById('rate').value = '20', desk.play(true)")
            page.until("!desk.playing && Math.abs(desk.at - 20) < 0.001")

    def test_a_crane_that_hoists_luffs_and_travels_is_drawn_as_it_stands(self):
        subprocess.run([SLEWLAB, "run", REPOSITORY / "config" / "scenarios" / "moves_while_slewing.yaml", "--out", self.folder / "a", "--set", "duration=24s"],
                       stdin=subprocess.DEVNULL, capture_output=True, check=True, timeout=PATIENCE)
        motion = read_run_log(self.folder / "a" / "run.lcmlog").channel("MOTION")
        with DeskProcess(self.folder / "a") as desk:
            page = self.open(desk.address)
            page.value("const draw = desk.picture.shape; desk.picture.shape = function (...of) { return window.shape = draw.apply(this, of); }, desk.seek(24)")
            page.until("window.shape && desk.at === 24")
            told = "(/boom angle\\n([\\d.]+)°/.exec(document.getElementById('facts').innerText) || [])[1]"
            page.until(f"Math.abs({told} - {np.degrees(motion['boom_angle'][-1])}) < 0.01")  # what is told of the time before the seek has gone
            shown = page.value("document.getElementById('facts').innerText")
            self.assertIn("travelled\n", shown)
            # 10 deg lower, the tip 7 m farther out at a slew angle of 0.8 rad; the boom itself bends by some centimetres.
            self.assertLess(abs(float(re.search(r"tip deflection\n(-?\d+) mm", shown).group(1))), 100)
            geometry = json.loads((self.folder / "a" / "run.json").read_text())["geometry"]
            reach = geometry["pivot_radius"] + geometry["boom_length"] * np.cos(motion["boom_angle"][-1])
            page.until(f"Math.abs(shape.reach - {reach}) < 1e-3")
            self.assertAlmostEqual(page.value("shape.low"), geometry["boom_length"] * np.sin(motion["boom_angle"][-1]) - motion["rope_length"][-1] - geometry["rod_length"], delta=1e-3)

    def test_where_messages_are_missing_no_line_is_drawn_and_it_is_said(self):
        events = [event for event in made_run.messages() if not 5_000_000_000 <= event[1] < 8_000_000_000]
        with DeskProcess(made_run.write_run(self.folder / "a", events=events)) as desk:
            page = self.open(desk.address)
            self.assertIn("messages are missing from 4.99 to 8.00 s", page.value("document.getElementById('notice').innerText"))
            page.value("desk.seek(6)")
            page.until("desk.at === 6 && desk.charts[0].cursor === 6")
            for title, drawn in (("slewing speed", "1"), ("motor torque", "0"), ("acceleration, lateral", "0")):
                # Of the columns between those two times every one is empty; the request alone stands on, and is told.
                page.until(f"(() => {{ const chart = desk.charts.find(c => c.description.title === '{title}'), [times, ...lines] = chart.plot.data;"
                           f" const isEmpty = (line) => times.every((t, k) => t < 5.1 || t > 7.9 || line[k] === null);"
                           f" return lines.length > {drawn} && lines.slice({drawn}).every(isEmpty) && lines.every(line => line[0] !== null)"
                           f" && chart.values.slice({drawn}).every(value => value.textContent === '–'); }})()")

    def test_a_line_goes_through_all_that_its_columns_hold_in_few_points(self):
        draw, count, height = np.random.default_rng(1), 400, 150.0
        noise = np.sort(draw.normal(75.0, 20.0, (count, 2)), axis=1)
        smooth = np.repeat(75.0 + 60.0 * np.sin(np.arange(count)[:, None] / 60.0), 2, axis=1)
        held = np.full((count, 2), np.nan)
        held[[0, 100, 250]] = [[10.0, 10.0], [90.0, 90.0], [40.0, 40.0]]
        broken = smooth.copy()
        broken[150:200] = np.nan
        spike = np.full((count, 2), 20.0)
        spike[123, 1] = 140.0
        cases = {"noise": (noise, [], False, 2 * count), "smooth": (smooth, [], False, count / 8), "a spike": (spike, [], False, 8),
                 "held": (held, [], True, 8), "broken": (broken, [[150, 200]], False, count / 8)}
        with DeskProcess(made_run.write_run(self.folder / "a")) as desk:
            page = self.open(desk.address)
            page.value("window.pathOf = (columns, holes, isHeld, height) => { const kept = Path2D, points = [], count = columns.length / 2;"
                       " window.Path2D = class { moveTo(x, y) { points.push([]); this.lineTo(x, y); } lineTo(x, y) { points.at(-1).push([x, y]); } };"
                       " const times = Array.from({length: 2 * count}, (_, k) => Math.floor(k / 2) + 0.5);"
                       " const plot = {bbox: {left: 0, top: 0, width: count, height}, scales: {x: {min: 0, max: count}, y: {min: 0, max: height}}, series: [{}, {scale: 'y'}], data: [times]};"
                       " linePath(() => ({columns: columns.map((value) => value ?? NaN), holes, scale: 1}), isHeld)(plot, 1); window.Path2D = kept; return points; }, 0")
            for name, (columns, holes, is_held, most) in cases.items():
                told = [None if np.isnan(value) else value for value in columns.ravel().tolist()]
                lines = [np.array(line) for line in page.value(f"pathOf({json.dumps(told)}, {holes}, {json.dumps(is_held)}, {height})")]
                with self.subTest(name):
                    self.assertLessEqual(sum(map(len, lines)), most)
                    self.assertEqual(len(lines), 1 + len(holes))
                    for column in np.flatnonzero(np.isfinite(columns[:, 0]) & (not is_held)):
                        x, (low, high) = column + 0.5, columns[column]
                        line = next(each for each in lines if each[0, 0] <= x <= each[-1, 0])
                        values = height - np.concatenate((line[line[:, 0] == x, 1], [np.interp(x, line[:, 0], line[:, 1])] if x not in line[:, 0] else []))
                        self.assertLessEqual(max(abs(values.min() - low), abs(values.max() - high)), 0.51)
            # A value that is held goes on until the next one, and steps there.
            line = np.array(page.value(f"pathOf({json.dumps([None if np.isnan(v) else v for v in held.ravel().tolist()])}, [], true, {height})")[0])
            np.testing.assert_allclose(line, [[0.5, 140.0], [100.5, 140.0], [100.5, 60.0], [250.5, 60.0], [250.5, 110.0]], atol=1e-5)
            # What is out of sight is drawn when it comes into it.
            page.size(420, 500)
            page.value("scrollTo(0, 0), desk.seek(3)")
            page.until("desk.charts[0].cursor === 3 && desk.charts[3].latest && !desk.charts[3].isSeen")
            page.value("desk.charts[3].element.scrollIntoView()")
            page.until("desk.charts[3].isSeen && !desk.charts[3].latest")

    def test_what_a_picture_lacks_is_said_within_it(self):
        with DeskProcess(made_run.write_run(self.folder / "a"), made_run.write_run(self.folder / "b")) as desk:
            page = self.open(desk.address, width=800)
            page.value("window.written = [], CanvasRenderingContext2D.prototype.fillText = function (text, x) {"
                       " if (this.canvas.id === 'above') written.push([text, x + this.measureText(text).width <= this.canvas.clientWidth]); }, desk.seek(3)")
            page.until("written.length > 1")
            self.assertEqual(page.value("written.filter(([, fits]) => !fits)"), [])
            self.assertIn("second log: the crane's shape is not in this log", page.value("written.map(([text]) => text).join(' ')"))

    def test_two_logs_are_drawn_over_each_other_and_as_their_difference(self):
        other = made_run.messages()
        for channel, _, message in other:
            if channel == "TORQUE":
                message.motor_torque = [value + 25.0 for value in message.motor_torque]  # 10 % of T100
        first, second = made_run.write_run(self.folder / "a"), made_run.write_run(self.folder / "b", events=other)
        with DeskProcess(first, second) as desk:
            page = self.open(desk.address)
            page.value("desk.seek(15)")
            values = ("[...[...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque'))"
                      ".querySelectorAll('b')].map(b => Number(b.textContent))")
            page.until(f"JSON.stringify({values}) === '[-96,12,-86,22]'")
            page.until("desk.spectrumChart && desk.spectrumChart.legend.innerText.includes('tip, b')")
            page.until("Math.max(...desk.spectrumChart.plot.data[1]) > 0 && desk.spectrumChart.plot.data[3].join() === desk.spectrumChart.plot.data[1].join()")
            page.value("document.getElementById('compare').value = 'difference', "
                       "document.getElementById('compare').dispatchEvent(new Event('change'))")
            page.until(f"JSON.stringify({values}) === '[-10,-10]'")
            self.assertIn("motor torque, difference", page.value("document.body.innerText"))
        # A log whose run.json tells no T100 and no end, as of a run that was killed: its torques are N m, in a chart of their own.
        (second / "run.json").write_text('{"end": "under way"}')
        with DeskProcess(first, second) as desk:
            page = self.open(desk.address)
            page.value("desk.seek(15)")
            page.until(f"JSON.stringify({values}) === '[-96,12]'")
            self.assertIn("b: this run was broken off", page.value("document.getElementById('notice').innerText"))
            headings = "[...document.querySelectorAll('.chart')].filter(c => c.textContent.startsWith('motor torque')).map(c => c.querySelector('h2').textContent)"
            self.assertEqual(page.value(headings), ["motor torque [% of T100]", "motor torque [N m per motor]"])
            page.until(values.replace(".find(", ".findLast(") + ".join() === '-215,55'")
            page.value("document.getElementById('compare').value = 'difference', "
                       "document.getElementById('compare').dispatchEvent(new Event('change'))")
            self.assertIn("No difference: a in % of T100, b in N m per motor. A log does not tell its machine", page.value("document.body.innerText"))
        with DeskProcess(first, second, "--same-machine") as desk:
            page = self.open(desk.address)
            page.value("desk.seek(15), document.getElementById('compare').value = 'difference', "
                       "document.getElementById('compare').dispatchEvent(new Event('change'))")
            page.until(f"JSON.stringify({values}) === '[-10,-10]'")

    def test_a_log_that_has_ended_says_so_and_shows_no_values_beyond_its_end(self):
        short = [event for event in made_run.messages() if event[1] < 12_000_000_000]
        first, second = made_run.write_run(self.folder / "short", events=short), made_run.write_run(self.folder / "long")
        with DeskProcess(first, second) as desk:
            page = self.open(desk.address)
            values = ("[...[...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque'))"
                      ".querySelectorAll('b')].map(b => b.textContent).join()")
            page.value("desk.seek(11)")
            page.until(f"{values} === '-96.00,12.00,-96.00,12.00'")
            page.value("desk.seek(15)")
            page.until(f"{values} === '–,–,-96.00,12.00'")
            page.until("document.getElementById('facts').innerText.includes('this log ended at\\n12.0 s')")
            # A chart that grows with its window has a column for every pixel at once.
            page.value("document.getElementById('charts').style.maxWidth = '300px', dispatchEvent(new Event('resize'))")
            page.until("desk.charts[0].plot.data[0].length === 2 * desk.charts[0].plot.over.clientWidth")
            page.value("document.getElementById('charts').style.maxWidth = '', dispatchEvent(new Event('resize'))")
            page.until("desk.charts[0].plot.over.clientWidth > 300 && desk.charts[0].plot.data[0].length === 2 * desk.charts[0].plot.over.clientWidth")

    def test_a_log_that_grows_is_followed_and_a_bus_is_heard(self):
        scenario = REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml"
        # In the tests' own network: nobody else is on the bus.
        bus = "udpm://239.255.76.67:7667?ttl=0"
        with DeskProcess("--bus", bus) as desk:
            page = self.browser.open(desk.address)
            sides = [subprocess.Popen([SLEWLAB.parent / f"slewlab-{side}", *more, "--bus", bus], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
                     for side, more in (("controller", ["--config", REPOSITORY / "config" / "controllers" / "thesis.yaml", "--period-ms", "10"]),
                                        # Against the wall clock: nobody waits for a listener, and in lockstep a burst is more than its
                                        # socket holds.
                                        ("plant", ["--scenario", scenario, "--log", self.folder / "run.lcmlog", "--realtime", "--set", "duration=4s"]))]
            self.assertEqual(sides[1].wait(PATIENCE), 0)
            sides[0].terminate()
            sides[0].wait(PATIENCE)
            page.until("desk.drawn > 0 && desk.last > 3.5")  # near the run's end: a bus may lose its last word
            page.until("document.body.innerText.includes('motor speed')")
        with DeskProcess(self.folder / "run.lcmlog", "--follow", "--out", self.folder / "out") as desk:
            page = self.open(desk.address)
            page.until("Math.abs(desk.last - 4) < 0.011")
            page.value("desk.send({type: 'record', on: true})")
            page.until("document.getElementById('recording').innerText.startsWith('Recording from')")
            self.state(page, "nothing new for")
            page.click("#record")  # what was begun can be ended
            page.until("document.getElementById('recording').innerText.startsWith('Recorded from') && document.getElementById('record').disabled")
            self.assertTrue((self.folder / "out" / "recording_1" / "run.lcmlog").is_file())
            (self.folder / "run.json").write_text('{"end": "the plant was killed"}')
            self.state(page, "run ended")
            page.until("document.getElementById('notice').innerText.includes('the plant was killed')")

    def pull(self, page, share):
        """The lever by the mouse, and held there."""
        x, y, width = page.middle("#lever")
        page.mouse("mousePressed", x, y)
        page.mouse("mouseMoved", x + share * (width / 2 - 27), y)

    def steered(self, *more):
        return DeskProcess(REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml", "--out", self.folder / "runs",
                           "--let-go-after", "5", *more)  # a browser may stand still for a while on a machine with other work

    def speed_up(self, page):
        """Ten times as fast as the clock: what is waited for comes soon, and reactions still fall into the same second."""
        page.value("desk.send({type: 'speed', speed: 10})")

    def state(self, page, words):
        page.until(f"document.querySelector('header').innerText.includes({json.dumps(words)})")

    def test_what_the_operator_did_is_done_again_to_the_bit(self):
        effects = ("[{effect: bearing_viscous, coefficient: {value: 1e6, unit: N m s/rad, source: test}, "
                   "asymmetry: {value: 0, unit: '-', source: test}}, "
                   "{effect: boom_damping, factor: {value: 2, unit: '-', source: test}}]")
        with self.steered("--set", f"crane.effects={effects}") as desk:
            page = self.open(desk.address)
            self.assertIn("Take the joystick", page.value("document.body.innerText"))
            page.until("desk.charts.length > 0 && document.getElementById('live').classList.contains('on') && desk.charts[0].plot.scales.x.min >= 0")
            # Damping is a parameter of the machine as it is assembled.
            self.assertFalse(page.value("document.getElementById('effect_boom_damping')"))
            page.click("#take")
            page.until("desk.steering.mine")
            self.speed_up(page)
            self.pull(page, 0.5)
            page.until("document.getElementById('facts').innerText.includes('request\\n50 %')")
            self.state(page, "controller running")
            page.mouse("mouseReleased", *page.middle("#lever")[:2])
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
            page.key("keyDown", "ArrowRight", "ArrowRight")  # the lever by a key, held until it is at its end
            page.until("document.getElementById('request').textContent === '1.00'")
            page.until("document.getElementById('facts').innerText.includes('request\\n100 %')")
            page.click("#stop")
            self.state(page, "controller emergency stop")
            page.key("keyUp", "ArrowRight", "ArrowRight")
            # The same key stops behind a click on a box, and where a choice has the focus, and does nothing else there.
            page.click("#stop")
            page.until("!desk.steering.stopPressed")
            page.click("#fault_some_torque")
            page.until("document.getElementById('fault_some_torque').checked && desk.steering.on.fault.some_torque")
            page.key("keyDown", " ", "Space")
            page.key("keyUp", " ", "Space")
            page.until("desk.steering.stopPressed")
            page.value("document.getElementById('pace').focus()")
            page.key("keyDown", "ArrowRight", "ArrowRight")
            page.until("document.getElementById('request').textContent !== '0.00'")
            page.key("keyUp", "ArrowRight", "ArrowRight")
            self.assertEqual(page.value("[document.getElementById('request').textContent, document.getElementById('fault_some_torque').checked]"), ["0.00", True])
            moved = page.value("desk.at")
            page.until(f"desk.at > {moved} + 2")
            page.click("#fault_some_torque")
            page.until("!desk.steering.on.fault.some_torque")
            page.click("#effect_bearing_viscous")
            page.until("desk.steering.on.effect.bearing_viscous === false")
            # The groups are held against each other (thesis Table 3.4) until the play compensation is switched off, and again later.
            held = ("Number([...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque'))"
                    ".querySelectorAll('b')[0].textContent)")
            for on in (False, True):
                page.click("#compensation")
                page.until(f"document.getElementById('compensation').checked === {json.dumps(on)} && desk.steering.compensation === {json.dumps(on)}")
                switched = page.value("desk.at")
                page.until(f"desk.at > {switched} + 1")
                page.until(f"Math.abs({held}) {'>' if on else '<'} 5")
            page.click("#save")
            page.until("document.getElementById('notice').textContent.startsWith('written: ')")
        folder = self.folder / "runs" / "1"
        again = self.folder / "again"
        run = subprocess.run([SLEWLAB, "run", folder / "steered.yaml", "--out", again], stdin=subprocess.DEVNULL, capture_output=True,
                             text=True, timeout=PATIENCE)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        recorded, repeated = messages(folder / "run.lcmlog"), messages(again / "run.lcmlog")
        self.assertEqual(len(recorded), len(repeated))
        self.assertTrue(recorded == repeated, "a message differs")
        operator = read_run_log(folder / "run.lcmlog").channel("OPERATOR")
        self.assertIn(0.5, operator["speed_request"])
        self.assertIn(1.0, operator["speed_request"])
        self.assertTrue(operator["emergency_stop"].any())
        state = read_run_log(folder / "run.lcmlog").channel("CONTROLLER_STATE")
        # At T100, which an emergency stop reaches, the map of thesis Table 3.4 leaves no offset either.
        offset = state["offset_torque"][np.abs(state["average_torque"]) < 0.99 * RATED_TORQUE]
        changes = np.flatnonzero(np.diff((offset == 0.0).astype(int)))
        self.assertEqual(len(changes), 2, "off, and on again")
        status = read_run_log(folder / "run.lcmlog").channel("PLANT_STATUS")
        self.assertGreater(status["stale_commands"][-1], 0)  # of the fault

    def test_a_trip_is_said_in_words_and_acknowledged_at_rest(self):
        with self.steered() as desk:
            page = self.open(desk.address)
            page.click("#take")
            page.until("desk.steering.mine")
            self.speed_up(page)
            page.click("#fault_silence")
            self.state(page, "drive braked")  # tripped, and at rest at once
            self.assertIn("no command came from the controller in time", page.value("document.getElementById('trip').innerText"))
            page.click("#fault_silence")
            page.until("!desk.steering.on.fault.silence")
            x, y, _ = page.middle("#acknowledge")
            page.mouse("mousePressed", x, y)
            self.state(page, "drive running")
            page.mouse("mouseReleased", x, y)
            page.until("document.getElementById('trip').hidden")

    def test_a_controller_that_stops_by_itself_is_said_in_words(self):
        number = self.folder / "process"
        controller = (f"echo $$ > {number}; exec {SLEWLAB.parent}/slewlab-controller --config {REPOSITORY}/config/controllers/thesis.yaml "
                      "--period-ms 10")
        with self.steered("--controller", controller) as desk:
            page = self.open(desk.address)
            process = int(number.read_text())
            page.until("document.getElementById('trip').hidden && desk.at > 0.5")
            os.kill(process, signal.SIGSTOP)
            self.state(page, "controller silent")
            words = page.value("document.getElementById('trip').innerText")
            self.assertRegex(words, r"^The controller has answered nothing since \d+\.\d+ s\. The plant waits for it: the run stands still\.$")
            os.kill(process, signal.SIGCONT)
            self.state(page, "controller stopped")  # its lever is at zero
            page.until("document.getElementById('trip').hidden")
            os.kill(process, signal.SIGKILL)
            self.state(page, "run ended")
            page.until("document.getElementById('trip').innerText.includes('The controller ended before its time: killed by signal 9 (Killed) at ')")
            self.assertNotIn("plant is process", page.value("document.getElementById('notice').innerText"))

    def test_one_page_has_the_joystick_and_its_end_lets_go(self):
        with self.steered("--let-go-after", "30") as desk:  # it is its end that lets go, not that two pages are slow on a machine with other work
            first, second = self.open(desk.address), self.open(desk.address)
            first.click("#take")
            second.until("document.getElementById('take').disabled")
            self.assertIn("Another page has the joystick", second.value("document.body.innerText"))
            self.speed_up(first)
            self.pull(first, 1.0)
            second.until("document.getElementById('facts').innerText.includes('request\\n100 %')")
            self.pull(second, -1.0)  # has none
            self.assertEqual(second.value("desk.steering.request"), 0)
            self.state(second, "controller running")
            self.browser.close(first)
            second.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
            second.until("document.getElementById('notice').innerText.includes('the page that had the joystick was closed')")
            self.state(second, "controller stopped")  # the ramp has come to its end
            second.until("!document.getElementById('take').disabled")
            second.click("#take")
            second.until("desk.steering.mine")
            # A page that is not closed but says no more: its script stands still.
            self.pull(second, 0.4)
            second.until("document.getElementById('facts').innerText.includes('request\\n40 %')")
            second.value("desk.steering.beat = () => {}")
            second.until("document.getElementById('notice').innerText.includes('nothing was heard')")
            second.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
        operator = read_run_log(self.folder / "runs" / "1" / "run.lcmlog").channel("OPERATOR")
        self.assertEqual(operator["speed_request"][-1], 0.0)
        encoder = read_run_log(self.folder / "runs" / "1" / "run.lcmlog").channel("ENCODER")
        self.assertGreater(seconds(encoder)[-1], 1.0)

    def test_a_tab_that_is_hidden_or_put_to_sleep_lets_the_lever_go(self):
        with self.steered() as desk:
            page, other = self.open(desk.address), self.open(desk.address)
            for way in ("hidden", "asleep"):
                page.click("#take")
                page.until("desk.steering.mine")
                self.pull(page, 0.4)
                other.until("document.getElementById('facts').innerText.includes('request\\n40 %')")
                if way == "hidden":
                    page.value("Object.defineProperty(document, 'hidden', {value: true, configurable: true}), "
                               "document.dispatchEvent(new Event('visibilitychange')), delete document.hidden")
                else:  # as a browser puts away what was long out of sight: no timer, no message
                    page.call("Page.setWebLifecycleState", state="frozen")
                other.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
                other.until("document.getElementById('notice').innerText.includes('The lever was let go: ')")
                page.call("Page.setWebLifecycleState", state="active")
                page.mouse("mouseReleased", *page.middle("#lever")[:2])
            other.click("#stop")  # who has no joystick may press it, and not release it
            other.until("desk.steering.stopPressed && document.getElementById('stop').disabled")
            other.value("desk.send({type: 'stop', pressed: false})")
            other.until("document.getElementById('notice').innerText.includes('released by who has the joystick')")
            self.assertTrue(other.value("desk.steering.stopPressed"))
            other.click("#take")
            other.until("desk.steering.mine")
            other.click("#stop")
            other.until("!desk.steering.stopPressed")

    def test_a_page_whose_desk_is_gone_says_what_does_not_reach_the_run_any_more(self):
        with self.steered() as desk:
            page = self.browser.open(desk.address)  # which complains, rightly
            page.until("desk.drawn > 0")
            page.click("#take")
            page.until("desk.steering.mine")
            self.pull(page, 0.4)
            page.until("document.getElementById('facts').innerText.includes('request\\n40 %')")
            page.value("window.tried = 0, desk.connect = function () { tried += 1; Desk.prototype.connect.call(this); }, 0")
            desk.process.terminate()
            desk.process.wait(PATIENCE)
            for tried in (0, 3):  # whose end is heard by then
                page.until(f"tried >= {tried} && document.getElementById('notice').innerText.includes('out of reach')")
                for words in ("The lever was let go.", "The emergency stop of this page does not reach the run."):
                    self.assertIn(words, page.value("document.getElementById('notice').innerText"), tried)

    def test_a_run_is_paused_and_goes_on_cycle_by_cycle(self):
        with self.steered("--duration", "60") as desk:
            page = self.open(desk.address)
            page.click("#take")
            page.until("desk.steering.mine")
            page.click("#pause")
            self.state(page, "paused")
            page.until("(async () => { const a = desk.at; await new Promise(r => setTimeout(r, 600)); return desk.at === a; })()")
            before = page.value("desk.at")
            page.click("#cycle")
            # One controller period of the scenario is 10 ms; the log's newest message is the SENSORS at its end.
            page.until(f"Math.abs(desk.at - {before} - 0.01) < 1e-6")
            page.click("#pause")
            page.until(f"desk.at > {before} + 1")
            self.pull(page, 0.3)
            silent = page.value("desk.heard -= 5000, desk.listen(), document.body.innerText")
            for words in ("nothing heard for 5 s", "The lever was let go: the desk does not answer."):
                self.assertIn(words, silent)
            page.mouse("mouseReleased", *page.middle("#lever")[:2])
            page.value("desk.socket.close()")
            page.until("document.getElementById('notice').innerText.includes('out of reach')")
            self.state(page, "drive")
            page.click("#take")
            page.until("desk.steering.mine")
            page.value("desk.send({type: 'speed', speed: 0})")
            self.state(page, "run ended")
            self.state(page, "drive last running")
            page.until("!desk.steering.mine && document.getElementById('take').disabled")
            page.until("document.getElementById('notice').innerText.includes('The run has ended.')")

    def test_a_gap_to_the_nominal_machine_opens_while_the_run_goes_on(self):
        # The machine that runs loses the second of its two motor groups and goes on with the first: from then on each motor of the lost
        # group lacks what it is commanded, and the nominal machine, which does as it is told, has to be held back there.
        nominal = REPOSITORY / "config" / "cranes" / "thesis.yaml"
        with self.steered("--nominal", nominal, "--set", "crane.drive_protection.trip_on_group_lost=false") as desk:
            page = self.open(desk.address)
            page.click("#take")
            page.until("desk.steering.mine")
            page.value("desk.send({type: 'speed', speed: 4})")
            self.pull(page, 0.6)
            page.until("document.getElementById('gap').innerText.includes('No gap beyond the usual') && desk.at > 14")
            page.value("desk.send({type: 'fault', name: 'group_1', on: true})")
            page.until("document.getElementById('gap').innerText.includes('A gap has opened')")
            self.assertIn("missing torque of group 2", page.value("document.getElementById('gap').innerText"))
            page.mouse("mouseReleased", *page.middle("#lever")[:2])
            page.click("#diagnose")
            page.until("['under way', 'done', 'cannot tell'].some(s => document.getElementById('gap').innerText.includes('Diagnosis ' + s))")
        log = read_run_log(self.folder / "runs" / "diagnosis_1" / "last_minute.lcmlog")
        self.assertGreater(len(log.channel("ENCODER")), 1000)

    def test_a_run_that_begins_anew_is_watched_and_diagnosed_alone(self):
        with self.steered("--nominal", REPOSITORY / "config" / "cranes" / "thesis.yaml") as desk:
            page = self.open(desk.address)
            self.speed_up(page)
            page.until("document.getElementById('gap').innerText.includes('Not known yet whether there is a gap: what size is usual is known from about ') && desk.at > 3")
            self.assertNotIn("usual –", page.value("document.getElementById('gap').innerText"))
            page.click("#anew")
            page.until("document.getElementById('name').textContent === 'thesis_slew, 2' && desk.at > 0 && desk.at < desk.last + 1")
            self.speed_up(page)
            page.until("document.getElementById('gap').innerText.includes('missing torque of group 2') && desk.at > 3")
            page.click("#diagnose")
            page.until("['under way', 'done', 'cannot tell'].some(s => document.getElementById('gap').innerText.includes('Diagnosis ' + s))")
        runs = self.folder / "runs"
        held, second = (read_run_log(log).channel("ENCODER") for log in (runs / "diagnosis_1" / "last_minute.lcmlog", runs / "2" / "run.lcmlog"))
        self.assertEqual(set(held["run_identity"]), {second["run_identity"][0]})
        self.assertLessEqual(set(held["simulated_time"]), set(second["simulated_time"]))
        self.assertTrue((np.diff(held["simulated_time"]) > 0).all())

    def test_the_lever_follows_a_finger_and_a_gamepad(self):
        with self.steered() as desk:
            page = self.open(desk.address, width=420)
            page.click("#take")
            page.until("desk.steering.mine")
            x, y, width = page.middle("#lever")
            page.touch("touchStart", x, y)
            page.touch("touchMove", x - 0.4 * (width / 2 - 27), y)
            page.until("document.getElementById('facts').innerText.includes('request\\n-40 %')")
            page.touch("touchEnd")
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
            # A browser shows a gamepad as these numbers: left stick, at first held to the right; button B (1) at first not pressed.
            page.value("window.pad = {connected: true, axes: [0.6, 0], buttons: [{pressed: false}, {pressed: false}]}, "
                       "navigator.getGamepads = () => [window.pad]")

            def stick_is(held, request):
                page.value(f"window.pad.axes[0] = {held}, new Promise((done) => setTimeout(done, 2.5 * BEAT))")
                self.assertEqual(page.value("desk.steering.request"), request)

            stick_is(0.6, 0)  # held before it was seen at rest
            stick_is(0.02, 0)
            stick_is(0.6, 0.6)
            page.until("document.getElementById('facts').innerText.includes('request\\n60 %')")
            page.value("dispatchEvent(new Event('blur'))")
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
            self.assertIn("the window lost the focus", page.value("document.getElementById('let_go').innerText"))
            stick_is(0.02, 0)
            stick_is(0.6, 0)  # nobody looks at this window
            page.value("dispatchEvent(new Event('focus'))")
            stick_is(0.6, 0)
            stick_is(0.02, 0)
            stick_is(0.6, 0.6)
            page.value("navigator.getGamepads = () => []")
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %')")
            self.assertIn("the gamepad is gone", page.value("document.getElementById('let_go').innerText"))
            page.value("navigator.getGamepads = () => [window.pad]")
            stick_is(0.02, 0)
            stick_is(0.6, 0.6)
            page.until("document.getElementById('facts').innerText.includes('request\\n60 %') && document.getElementById('let_go').hidden")
            page.value("window.pad.buttons[1].pressed = true")
            page.until("document.getElementById('facts').innerText.includes('request\\n60 %, emergency stop')")
            page.value("window.pad.axes[0] = 0.02")  # a stick at rest is never quite at zero
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %, emergency stop')")
            self.assertIn("PULL TO RELEASE", page.value("document.getElementById('stop').innerText"))

    def test_the_emergency_stop_takes_a_second_finger_a_mouse_and_a_key_once_each(self):
        with self.steered() as desk:
            page = self.open(desk.address, width=420)
            page.click("#take")
            page.until("desk.steering.mine")
            page.value("window.said = [], desk.steering.stop = (pressed) => { said.push(pressed); Steering.prototype.stop.call(desk.steering, pressed); }")
            x, y, width = page.middle("#lever")
            held = x - 0.4 * (width / 2 - 27), y, 1
            self.fingers(page, "touchStart", (x, y, 1))
            self.fingers(page, "touchMove", held)
            page.until("document.getElementById('facts').innerText.includes('request\\n-40 %')")
            self.fingers(page, "touchStart", held, (*page.middle("#stop")[:2], 2))
            page.until("document.getElementById('facts').innerText.includes('request\\n-40 %, emergency stop')")
            self.fingers(page, "touchEnd")
            page.until("document.getElementById('facts').innerText.includes('request\\n0 %, emergency stop')")

            def tap():
                self.fingers(page, "touchStart", (*page.middle("#stop")[:2], 1))
                self.fingers(page, "touchEnd")

            def enter():
                page.value("document.getElementById('stop').focus()")
                for repeats in (False, True, True):  # held for a while
                    page.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", text="\r", windowsVirtualKeyCode=13, autoRepeat=repeats)
                page.call("Input.dispatchKeyEvent", type="keyUp", key="Enter", code="Enter", windowsVirtualKeyCode=13)

            expected = [True]
            for press in (tap, tap, lambda: page.click("#stop"), lambda: page.click("#stop"), enter, enter,
                          lambda: page.value("document.getElementById('stop').click()")):  # as a screen reader presses it
                expected.append(not expected[-1])
                press()
                page.until(f"desk.steering.stopPressed === {json.dumps(expected[-1])}")
            page.value("document.getElementById('stop').focus()")
            page.key("keyDown", " ", "Space")
            page.key("keyUp", " ", "Space")
            page.until("desk.steering.stopPressed")
            self.assertEqual(page.value("said"), [*expected, True])

    def fingers(self, page, kind, *places):
        """(x, y, number of the finger) of each that touches the page."""
        page.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": number} for x, y, number in places])

    def test_the_page_is_readable_in_three_widths_light_and_dark(self):
        texts = ("h1", ".badge", ".clock", ".chart h2", ".chart h2 small", ".legend", ".legend b", "figcaption", "dt", "dd", ".hint", "#take", "fieldset label", "#record", ".stop")
        with self.steered() as desk:
            page = self.open(desk.address)
            self.speed_up(page)
            page.until("desk.last > 3")
            page.value("document.getElementById('record').click()")
            page.until("!document.getElementById('recording').hidden")
            page.value("desk.send({type: 'stop', pressed: true})")
            page.until("document.getElementById('stop').getAttribute('aria-pressed') === 'true'")
            for width in (1400, 800, 420):
                for dark in (False, True):
                    page.size(width, 900, dark)
                    drawn = page.value("desk.drawn")
                    page.until(f"desk.drawn > {drawn} + 1")
                    with self.subTest(width=width, dark=dark):
                        self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                        self.assertEqual(overlaps(page, "button, label, h1, h2, figcaption, .badge, .clock, .legend span, .request, .hint, dt, dd, p.notice"), [])
                        for selector in texts:
                            self.assertGreaterEqual(contrast_of(page, selector), 4.5, selector)
            page.value("document.querySelector('.chart h2').style.marginBottom = '-1.2em'")
            self.assertNotEqual(overlaps(page, "h2, .legend span"), [], "what lies over each other would not be noticed")

    def test_a_part_of_a_run_is_recorded_from_here(self):
        with self.steered() as desk:
            page = self.open(desk.address)
            page.click("#take")
            page.until("desk.steering.mine")
            self.speed_up(page)
            self.pull(page, 0.6)
            page.until("desk.last > 5")
            page.value("document.getElementById('record').click()")  # the mouse holds the lever
            page.until("document.getElementById('recording').innerText.startsWith('Recording from') && document.getElementById('record').innerText === 'Stop recording'")
            began = page.value("desk.last")
            page.until(f"desk.last > {began} + 3")
            page.value("document.getElementById('record').click()")
            page.until("document.getElementById('recording').innerText.startsWith('Recorded from') && document.getElementById('record').innerText === 'Record from here'")
            page.value("desk.send({type: 'record', on: true})")  # another one, which the run's end ends
            page.until("document.getElementById('recording').innerText.includes('recording_2')")
            page.mouse("mouseReleased", *page.middle("#lever")[:2])
        whole = messages(self.folder / "runs" / "1" / "run.lcmlog")
        for number in (1, 2):
            folder = self.folder / "runs" / f"recording_{number}"
            facts, log = json.loads((folder / "run.json").read_text()), read_run_log(folder / "run.lcmlog")
            self.assertEqual(log.remarks, [])
            time, position = seconds(log.channel("ENCODER")), 0
            self.assertGreaterEqual(time[0], facts["recorded_from"])
            self.assertAlmostEqual(time[-1], facts["recorded_until"], delta=0.011)
            for message in messages(folder / "run.lcmlog"):  # all of the run's, and in their order; what stood before comes first
                position = whole.index(message, position if message[0] not in HELD else 0) + (message[0] not in HELD)
            counts = [sum(channel == "ENCODER" for channel, _ in each) for each in (messages(folder / "run.lcmlog"), whole[:position])]
            self.assertEqual(counts[0], round((time[-1] - time[0]) / 0.01) + 1)
            self.assertEqual(facts["total_ratio"], json.loads((self.folder / "runs" / "1" / "run.json").read_text())["total_ratio"])
            self.assertNotIn("duration", facts)
            report = subprocess.run([SLEWLAB, "report", folder], capture_output=True, text=True, timeout=PATIENCE)
            self.assertEqual((report.returncode, report.stderr), (0, ""))

    def test_a_run_begins_anew_without_play_compensation(self):
        with self.steered() as desk:
            page = self.open(desk.address)
            self.speed_up(page)
            page.until("desk.at > 3 && document.getElementById('compensation').checked")
            page.click("#compensation")
            page.click("#anew")
            page.until("document.getElementById('name').textContent === 'thesis_slew, 2' && desk.at > 0 && desk.at < desk.last + 1")
            page.until("document.getElementById('compensation').checked === false")
            self.speed_up(page)
            page.until("desk.at > 3")
        # At rest the two groups work against each other by a tenth of T100, 25 N m, or not at all (thesis 3.5, 4.4).
        for number, torque in (("1", 25.0), ("2", 0.0)):
            commands = read_run_log(self.folder / "runs" / number / "run.lcmlog").channel("TORQUE")
            at = int((seconds(commands) < 3.0).sum()) - 1
            self.assertAlmostEqual(float(commands["motor_torque"][at][0]), torque, delta=0.5)
            self.assertTrue((self.folder / "runs" / number / "steered.yaml").is_file())

    def test_who_has_no_token_watches_and_a_foreign_page_not_even_that(self):
        with self.steered() as desk:
            bare = desk.address.split("#")[0]
            for address in (bare, bare + "#wrong"):
                page = self.open(address)
                self.assertTrue(page.value("document.getElementById('take').disabled && document.getElementById('stop').disabled"))
                page.until("document.getElementById('notice').innerText.includes('only watches')")
                page.value("desk.notice('')")
                page.value("desk.send({type: 'take'}), desk.send({type: 'stop', pressed: true}), desk.send({type: 'joystick', request: 1})")
                page.until("document.getElementById('notice').innerText.includes('only watches')")
            for origin in ("http://evil.example", "null", "http://127.0.0.1:1", "https" + bare[4:-1]):
                self.assertTrue(origin_is_refused(bare, origin), origin)
            self.assertFalse(origin_is_refused(bare, bare[:-1]))
        operator = read_run_log(self.folder / "runs" / "1" / "run.lcmlog").channel("OPERATOR")
        self.assertEqual(len(operator), 1)
        self.assertFalse(operator["emergency_stop"].any())

    def test_what_cannot_begin_is_said_and_no_page_is_served(self):
        wrong, scenario = self.folder / "wrong.yaml", REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml"
        wrong.write_text((REPOSITORY / "config" / "cranes" / "thesis.yaml").read_text())
        axis, thesis, one_group = (REPOSITORY / "config" / name for name in ("axes/example_axis.yaml", "cranes/thesis.yaml", "cranes/one_group.yaml"))
        followed = made_run.write_run(self.folder / "followed")
        (followed / "run.json").write_text('{"machine": {"kind": "axis", "efforts": [{"name": "motor torque", "unit": "N m"}]}}')
        of_a_run = scenario, "--out", self.folder / "runs", "--nominal"
        for arguments, words in (((*of_a_run, axis, "--nominal-controller", REPOSITORY / "config" / "controllers" / "thesis.yaml"),
                                  f"{axis}: found an axis, expected no --nominal-controller beside it"),
                                 ((*of_a_run, axis), f"{axis}: found an axis with 1 motor group, expected a crane with 2 motor groups, as the machine that runs"),
                                 ((*of_a_run, one_group), f"{one_group}: found a crane with 1 motor group, expected a crane with 2 motor groups"),
                                 ((followed, "--follow", "--nominal", thesis), f"{thesis}: found a crane with 2 motor groups, expected an axis with 1 motor group"),
                                 ((wrong, "--out", self.folder / "runs"), f"{wrong}:1:7: key 'kind': found crane, expected scenario"),
                                 ((made_run.write_run(self.folder / "a"), "--controller", "./mine"), "--controller: of a scenario that the desk runs; this one shows a log"),
                                 ((scenario, "--out", self.folder / "runs", "--nominal", scenario), f"{scenario}:1:7: key 'kind': found scenario, expected crane or axis"),
                                 ((self.folder / "a", "--port", "70000"), "found '70000', expected a number from 0 to 65535")):
            end = subprocess.run([SLEWLAB, "desk", *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
            with self.subTest(words=words):
                self.assertEqual((end.returncode, end.stdout), (2, ""))
                self.assertIn(words, end.stderr)

    def test_elsewhere_than_on_loopback_even_who_watches_needs_a_token(self):
        with DeskProcess(made_run.write_run(self.folder / "a"), "--host", "0.0.0.0") as desk:
            port = re.search(r":(\d+)/", desk.address).group(1)
            token = desk.address.split("#")[1]
            for given, may in ((None, False), ("wrong", False), (token, True)):
                with connect(f"ws://127.0.0.1:{port}/socket") as socket:
                    socket.send(json.dumps({"token": given}))
                    try:
                        socket.send(json.dumps({"type": "layout"}))
                        answer = json.loads(socket.recv(PATIENCE))["type"]
                    except ConnectionClosed as closed:
                        answer = closed.rcvd.code
                self.assertEqual(answer, "layout" if may else 4401)

    def test_of_a_recorded_log_a_controller_that_has_stopped_is_silent(self):
        events = [event for event in made_run.messages() if event[0] != "TORQUE" or event[1] < 10_000_000_000]
        with DeskProcess(made_run.write_run(self.folder / "a", events=events)) as desk:
            page = self.open(desk.address)
            values = ("[...[...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque'))"
                      ".querySelectorAll('b')].map(b => b.textContent).join()")
            for time, told, is_silent in ((9, "40.00,-20.00", False), (15, "–,–", True)):
                page.value(f"desk.seek({time})")
                page.until(f"{values} === '{told}'")
                self.assertEqual(page.value("document.getElementById('controller').innerText === 'controller silent'"), is_silent)

    def test_the_difference_of_two_logs_has_the_lines_of_both_and_words_for_the_others(self):
        def events(compensates):
            found = made_run.messages()
            for k in range(200):
                state = types.controller_state_t()
                state.mode, state.average_torque, state.offset_torque = 1, 20.0, 50.0 if compensates else 0.0
                state.sequence = state.answered_sequence = k
                state.simulated_time, state.configuration_hash, state.run_identity = k * 100_000_000, made_run.HASH, made_run.RUN
                found.append(("CONTROLLER_STATE", state.simulated_time, state))
            return sorted(found, key=lambda event: event[1])

        types = message_types()
        labels = ("[...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque, difference'))"
                  "?.querySelector('.legend').innerText.replace(/\\s+/g, ' ')")
        a = made_run.write_run(self.folder / "a", events=events(True))
        # Of one that compensates and one that does not, and of two that do alike.
        for name, compensates in (("b", False), ("c", True)):
            with DeskProcess(a, made_run.write_run(self.folder / name, events=events(compensates))) as desk:
                page = self.open(desk.address)
                page.value("desk.seek(5), document.getElementById('compare').value = 'difference', document.getElementById('compare').dispatchEvent(new Event('change'))")
                groups = "group 1 0.0000 group 2 0.0000"
                words = (f"{groups} compensation, upper 0.0000 compensation, lower 0.0000" if compensates
                         else f"{groups} left out: “compensation, upper”, “compensation, lower” (only in a)")
                page.until(f"{labels}.trim() === {json.dumps(words)}")


if __name__ == "__main__":
    unittest.main()
