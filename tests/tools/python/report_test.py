import base64
import contextlib
import io
import json
import re
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

import made_run
import report
from browser import Browser, contrast_of, overlaps
from panel import slim
from picture_page import rounded, series_of, unpacked
from report import panels, ticks
from run_numbers import band_of, finding, numbers, read_run, table


class ReportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def call(self, *arguments):
        """Exit code, standard output and standard error of the program."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = report.main([str(a) for a in arguments])
        return code, out.getvalue(), err.getvalue()

    def test_numbers_are_those_the_log_was_made_of(self):
        values = numbers(read_run(made_run.write_run(self.folder / "a")))
        before, after = values["before the stop"], values["after the stop"]
        largest = max(abs(made_run.tip_acceleration(k * 1e-4)) for k in range(int(made_run.STOP * 1e4)))
        self.assertAlmostEqual(before["peak_tip_acceleration"], largest, delta=0.005 * largest)
        self.assertAlmostEqual(after["peak_tip_acceleration"], 0.80, delta=0.01)
        self.assertAlmostEqual(after["peak_house_acceleration"], 0.40, delta=0.005)
        for found, (frequency, amplitude) in zip(before["tip_frequencies"], [(1.3, 0.30), (5.2, 0.12)], strict=True):
            self.assertAlmostEqual(found[0], frequency, delta=0.02)
            self.assertAlmostEqual(found[1], amplitude, delta=0.02 * amplitude)
        self.assertEqual([round(f, 1) for f, _ in after["tip_frequencies"]], [1.3])
        self.assertEqual(before["play_crossings"], [2, 1])
        self.assertEqual(after["play_crossings"], [2, 1])  # the one in the stop's own moment is behind it
        self.assertAlmostEqual(before["largest_sidelead"], 0.0523599, places=5)
        self.assertAlmostEqual(after["largest_sidelead"], 0.1047198, places=5)
        self.assertEqual(before["largest_motor_torque"], 100.0)
        self.assertEqual(after["largest_motor_torque"], 240.0)

    def test_the_frequencies_looked_for_are_those_of_the_machine(self):
        """The thesis's run.json has 1.307 Hz first and 38.214 Hz fifth; four times the crane swings half as fast."""
        def facts(factor):
            return {"modes": [{"name": "load 1", "frequency": 0.074 * factor}, {"name": "bending 1", "frequency": 1.307 * factor},
                              {"name": "drive 1", "frequency": 1.797 * factor}, {"name": "bending 5", "frequency": 38.214 * factor},
                              {"name": "torsion 3", "frequency": 51.24 * factor}]}

        own, larger = band_of(facts(1.0)), band_of(facts(0.5))
        self.assertAlmostEqual(own.lowest, 0.5, delta=0.01)
        self.assertAlmostEqual(own.highest, 45.0, delta=0.2)
        self.assertAlmostEqual(own.segment, 5.0, delta=0.01)
        for name, ratio in (("lowest", 0.5), ("highest", 0.5), ("segment", 2.0)):
            self.assertAlmostEqual(getattr(larger, name), ratio * getattr(own, name), places=9)
        self.assertEqual(ticks(0.497, 49.6), [0.5, 1, 2, 5, 10, 20, 50])
        self.assertEqual(ticks(0.02, 0.6), [0.02, 0.05, 0.1, 0.2, 0.5])

    def test_a_value_that_no_sensor_gives_is_a_gap_and_not_a_complaint(self):
        """One bit of a double turned over is easily 1e200; single precision ends at 3e38."""
        events = made_run.messages()
        next(event[2] for event in events if event[0] == "SENSORS" and event[1] > 3e9).tip_acceleration = 1e200
        folder = made_run.write_run(self.folder / "a", events=events)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            code, _, err = self.call(folder)
        self.assertEqual((code, err), (0, ""))
        self.assertTrue(np.isnan(slim([1.0, 1e200, -1e200])[1:]).all())
        self.assertEqual(list(slim([1.0, -3e38])), [1.0, np.float32(-3e38)])

    def test_table_speaks_in_the_engineers_units(self):
        run = read_run(made_run.write_run(self.folder / "a", rated_torque=250.0))
        cells = {label: texts[0] for label, texts in table([run])}
        self.assertEqual(cells["largest motor torque, after the stop"], "96 % of T100")
        self.assertEqual(cells["largest sidelead, before the stop"], "3.0°")
        self.assertEqual(cells["crossings of the play, per gearbox, before the stop"], "2 / 1")
        self.assertEqual(cells["frequencies at the tip, before the stop"], "1.3, 5.2 Hz")
        self.assertEqual(cells["lockstep rate against real time"], "10.0 × (20 s in 2.0 s)")

    def test_the_page_is_whole_in_itself_and_has_every_panel(self):
        folder = made_run.write_run(self.folder / "a")
        code, out, err = self.call(folder)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("crossings of the play", out)
        text = (folder / "report.html").read_text()
        drawn = unpacked(text)
        self.assertIsNone(re.search(r"<(script|link|img)[^>]+(src|href)=", text), "the page loads something")
        for title in ("slewing speed", "motor torque", "gearbox torque", "tip acceleration", "house acceleration",
                      "load angles", "spectrum before the stop", "spectrum after the stop", "bending 1"):
            self.assertIn(title, drawn)
        self.assertIn("plotly.js", unpacked(text, "library")[:100])
        self.assertEqual(list(folder.glob("*.partial")), [])

    def test_a_run_without_a_stop_stands_before_the_others_stop(self):
        calm = made_run.messages()
        for _, _, message in calm:
            if hasattr(message, "emergency_stop"):
                message.emergency_stop = False
        made_run.write_run(self.folder / "calm", events=calm)
        made_run.write_run(self.folder / "stopped")
        code, out, err = self.call(self.folder / "calm", self.folder / "stopped", "--out", self.folder / "page.html")
        self.assertEqual((code, err), (0, ""))
        alone = read_run(self.folder / "calm").overview.largest[0]["tip_acceleration"]
        self.assertRegex(out, rf"peak tip acceleration, before the stop +{alone:.2f} m/s²  ")
        self.assertRegex(out, r"peak tip acceleration, after the stop +no stop  ")
        self.assertNotIn("not in the log", out)
        drawn = unpacked((self.folder / "page.html").read_text())
        before = panels([read_run(self.folder / name) for name in ("calm", "stopped")])[-2]
        self.assertEqual((before.title, len(before.draw(read_run(self.folder / "calm")))), ("spectrum before the stop", 2))
        self.assertIn("spectrum after the stop", drawn)

    def test_a_real_cranes_log_alone_is_drawn_as_far_as_it_goes(self):
        events = [e for e in made_run.messages() if e[0] in ("ENCODER", "TORQUE", "SENSORS")]
        for _, _, message in events:
            if hasattr(message, "house_acceleration"):
                message.house_acceleration = float("nan")  # no such sensor
        path = self.folder / "site.lcmlog"
        made_run.write_log(path, events)
        code, out, err = self.call(path)
        self.assertEqual((code, err), (0, ""))
        self.assertRegex(out, r"peak tip acceleration +0.80 m/s²")
        self.assertRegex(out, r"peak house acceleration +not in the log")
        self.assertRegex(out, r"crossings of the play, per gearbox +not in the log")
        self.assertRegex(out, r"largest motor torque +240 Nm per motor")
        drawn = unpacked((self.folder / "site.html").read_text())
        for title in ("motor speed", "motor torque", "tip acceleration", "spectrum"):
            self.assertIn(f"{title}<br", drawn)
        for title in ("slewing speed", "gearbox torque", "house acceleration", "load angles"):
            self.assertNotIn(f"{title}<br", drawn)

    def test_a_run_that_ended_early_says_so_before_anything_else(self):
        folder = made_run.write_run(self.folder / "a")
        facts = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps(facts | {"end": "the plant ended before its time: killed by signal 9"}))
        (folder / "run.lcmlog").rename(folder / "run.lcmlog.partial")
        code, out, _ = self.call(folder)
        said = "a: this run ended before its time: the plant ended before its time: killed by signal 9."
        self.assertEqual(code, 0)
        self.assertTrue(out.startswith(said), out[:200])
        text = (folder / "report.html").read_text()
        self.assertLess(text.index(said), text.index("<table>"))
        (folder / "run.json").unlink()  # killed before it could be written
        self.assertIn("a: this run ended before its time. ", self.call(folder)[1])

    def test_numbers_that_are_none_are_said_before_anything_else(self):
        events = made_run.messages()
        next(event[2] for event in events if event[0] == "ENCODER" and event[1] == 3_000_000_000).shaft_speed = [float("nan"), 100.0]
        folder = made_run.write_run(self.folder / "a", events=events)
        said = "a: shaft_speed of ENCODER is no finite number in 1 of 2000 messages, the first at 3.000 s."
        code, out, _ = self.call(folder)
        self.assertEqual(code, 0)
        self.assertTrue(out.startswith(said), out[:200])
        text = (folder / "report.html").read_text()
        self.assertLess(text.index(said), text.index("<table>"))

    def test_a_log_of_one_message_says_that_there_is_nothing_to_draw(self):
        folder = made_run.write_run(self.folder / "a", events=made_run.messages()[:1])
        code, out, err = self.call(folder)
        said = "a: no channel of this log has more than one message: there is nothing to draw."
        self.assertEqual((code, err), (0, ""))
        self.assertTrue(out.startswith(said), out[:200])
        self.assertIn(said, (folder / "report.html").read_text())

    def test_a_folder_without_a_log_is_an_error_and_leaves_nothing(self):
        code, _, err = self.call(self.folder)
        self.assertEqual(code, 2)
        self.assertIn("run.lcmlog: there is no such log", err)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_page_under_a_name_that_a_later_run_would_leave_is_refused_in_its_folder(self):
        folder = made_run.write_run(self.folder / "a")
        self.assertEqual(self.call(folder / "run.lcmlog")[0], 0)
        self.assertEqual(sorted(path.name for path in folder.glob("*.html")), ["report.html"])
        code, _, err = self.call(folder, "--out", folder / "first.html")
        self.assertEqual(code, 2)
        self.assertIn(f"--out: found '{folder / 'first.html'}' in the folder of a run", err)
        self.assertFalse((folder / "first.html").exists())
        for out in (folder / "report.html", folder / "run.html", self.folder / "first.html", folder / "pages" / "first.html"):
            self.assertEqual(self.call(folder, "--out", out)[0], 0, out)

    def test_runs_are_called_by_what_tells_them_apart(self):
        on = read_run(made_run.write_run(self.folder / "a"))
        off = read_run(made_run.write_run(self.folder / "b", play_compensation=False))
        other = read_run(made_run.write_run(self.folder / "c"))
        self.assertEqual(report.headings([on, off]), ["play compensation on", "play compensation off"])
        self.assertEqual(report.headings([on, other]), ["a", "c"])
        other.facts["controller_command"] = "./mine"
        other.facts["play_compensation"] = False
        self.assertEqual(report.headings([on, other]), ["a", "c"])
        self.assertEqual(report.headings([on]), ["play compensation on"])
        on.facts["machine"] = {"efforts": [{"name": "motor torque"}, {"name": "torque on the axis"}]}  # one motor group
        self.assertEqual(report.headings([on]), ["a"])

    def test_a_drawn_point_keeps_what_a_screen_can_show(self):
        values = np.array([1.0, -3.14159265, 1e-30, 0.0, np.nan, np.inf, -7.5e8])
        np.testing.assert_allclose(rounded(values), values, rtol=2.0**-15)
        even = series_of(np.arange(100) * 0.01, np.zeros(100))
        self.assertEqual((even["x0"], round(even["dx"], 9), "x" in even), (0.0, 0.01, False))
        self.assertIn("x", series_of(np.array([0.0, 1.0, 3.0]), np.zeros(3)))

    def views_of(self, *names):
        page = self.folder / "page.html"
        self.assertEqual(self.call(*(self.folder / name for name in names), "--out", page, "--quiet")[0], 0)
        return json.loads(unpacked(page.read_text()))[0]

    def points(self, told, view, name):
        """(x, y) of the first trace of that name in a view."""
        trace = next(trace for trace in told["views"][view]["traces"] if trace["name"] == name)
        drawn = told["series"][trace["series"]]
        y = np.frombuffer(base64.b64decode(drawn["y"]["bdata"]), "f4")
        return drawn["x0"] + drawn["dx"] * np.arange(len(y)) if "x0" in drawn else np.frombuffer(base64.b64decode(drawn["x"]["bdata"]), "f4"), y

    def test_two_runs_are_shown_side_by_side_over_each_other_and_as_their_difference(self):
        weaker = made_run.messages()
        for _, _, message in weaker:
            if hasattr(message, "tip_acceleration"):
                message.tip_acceleration *= 0.5
        made_run.write_run(self.folder / "a")
        made_run.write_run(self.folder / "b", events=weaker)
        told = self.views_of("a", "b")
        self.assertEqual(list(told["views"]), ["side by side", "over each other", "difference, A minus B"])
        self.assertEqual(told["views"]["side by side"]["instead"], "over each other")
        time, apart = self.points(told, "difference, A minus B", "tip")
        np.testing.assert_allclose(apart, [0.5 * made_run.tip_acceleration(t) for t in time], atol=1e-3)
        _, house = self.points(told, "difference, A minus B", "house")
        np.testing.assert_array_equal(house, 0.0)
        np.testing.assert_array_equal(self.points(told, "over each other", "A tip")[1], self.points(told, "side by side", "tip")[1])
        # Every series once, however often it is drawn.
        side, over = (told["views"][view]["traces"] for view in ("side by side", "over each other"))
        self.assertEqual({trace["series"] for trace in side}, {trace["series"] for trace in over})

    def test_side_by_side_a_longer_run_is_shown_to_its_end(self):
        made_run.write_run(self.folder / "short", events=[event for event in made_run.messages() if event[1] <= 6_000_000_000])
        made_run.write_run(self.folder / "long")
        told = self.views_of("short", "long")
        for width in ("wide", "narrow"):
            layout = told["views"]["side by side"][width]
            ranges = [layout[name]["range"] for name in layout if name.startswith("xaxis") and layout[name].get("type") != "log"]
            self.assertEqual(len(ranges), 2 * 6)
            for begin, end in ranges:
                self.assertEqual(begin, 0)
                self.assertAlmostEqual(end, made_run.END, places=6)

    def test_motor_groups_that_only_the_second_run_has_stand_in_every_legend(self):
        made_run.write_run(self.folder / "two", events=self.with_a_ramp(made_run.messages(), 2))
        made_run.write_run(self.folder / "four", events=self.with_a_ramp(made_run.messages(), 4))
        told = self.views_of("two", "four")
        names = [trace["name"] for trace in told["views"]["side by side"]["traces"] if trace["showlegend"]]
        for name in ("motors 3", "group 4", "gearbox 3", "4 crosses its play", "request", "motors 1"):
            self.assertEqual(names.count(name), 1, name)
        with Browser() as browser:
            page = browser.open((self.folder / "page.html").as_uri(), 420, 900)
            page.until("document.getElementById('picture').dataset.drawn === 'over each other'")
            shown = page.value("[...document.querySelectorAll('#picture .legend text')].map((e) => e.textContent)")
        # What the first run's entry says by its colour is not said again.
        self.assertEqual(shown, ["A request", "A motors 1", "A motors 2", "A house", "A ramp", "B motors 3", "B motors 4"])

    def test_the_difference_of_other_rates_is_taken_where_both_have_an_instant(self):
        made_run.write_run(self.folder / "a")
        half = made_run.messages()
        half = [event for event in half if event[0] != "SENSORS" or (event[1] // 5_000_000 % 2 == 0 and 4_000_000_000 <= event[1] <= 9_000_000_000)]
        made_run.write_run(self.folder / "b", events=half)
        time, apart = self.points(self.views_of("a", "b"), "difference, A minus B", "tip")
        self.assertAlmostEqual(float(time[0]), 4.0, places=6)
        self.assertAlmostEqual(float(time[-1]), 9.0, places=6)
        self.assertLess(np.max(np.abs(apart)), 0.002)  # a line through every other sample of 5.2 Hz: (w T)^2 / 8 of 0.12, with T = 10 ms

    def with_a_gap(self, first, last, channels=("ENCODER", "TORQUE", "SENSORS", "TRUTH")):
        """The run without what these channels say between the two times [s]."""
        return [event for event in made_run.messages() if event[0] not in channels or not first * 1e9 < event[1] < last * 1e9]

    def check_gap(self, series, first, last):
        """The series has points to both sides of its gap, and between them nothing that a line is drawn through."""
        time, values = series
        inside = (time > first + 1e-3) & (time < last - 1e-3)
        self.assertTrue(inside.any())
        self.assertTrue(np.isnan(values[inside]).all())
        known = time[np.isfinite(values)]
        self.assertAlmostEqual(float(known[known <= first + 1e-3].max()), first, delta=1e-3)
        self.assertAlmostEqual(float(known[known >= last - 1e-3].min()), last, delta=1e-3)
        self.assertEqual(np.count_nonzero(~np.isfinite(values[~inside])), 0)

    def test_where_messages_are_missing_there_is_a_gap_and_the_page_says_where(self):
        folder = made_run.write_run(self.folder / "a", events=self.with_a_gap(6.0, 13.0))
        code, out, err = self.call(folder)
        self.assertEqual((code, err), (0, ""))
        said = "a: ENCODER, TORQUE, SENSORS, TRUTH: no message between 6 s and 13 s"
        self.assertIn(said, out)
        self.assertIn(said, (folder / "report.html").read_text())
        told = json.loads(unpacked((folder / "report.html").read_text()))[0]
        for name in ("motors 1", "group 2", "gearbox 1", "house", "tip", "rope: sidelead"):
            with self.subTest(name):
                self.check_gap(self.points(told, "picture", name), 6.0, 13.0)

    def test_a_gap_of_either_run_is_one_of_their_difference(self):
        made_run.write_run(self.folder / "whole")
        made_run.write_run(self.folder / "gap", events=self.with_a_gap(6.0, 13.0))
        for names in (("whole", "gap"), ("gap", "whole")):
            told = self.views_of(*names)
            for name in ("motors 1", "group 2", "tip"):
                with self.subTest(names=names, name=name):
                    self.check_gap(self.points(told, "difference, A minus B", name), 6.0, 13.0)

    def test_a_few_lost_messages_are_no_gap_and_of_many_gaps_the_longest_are_named(self):
        lost = [event for event in made_run.messages() if event[0] != "SENSORS" or event[2].sequence % 100 not in (1, 2, 3, 4)]
        folder = made_run.write_run(self.folder / "a", events=lost)  # 25 ms instead of 5 ms
        _, out, _ = self.call(folder)
        self.assertNotIn("no message between", out)
        gaps = [(2.0, 2.1), (4.0, 5.0), (7.0, 9.0), (12.0, 12.2), (15.0, 18.0)]
        for first, last in gaps:
            lost = [event for event in lost if event[0] != "TRUTH" or not first * 1e9 < event[1] < last * 1e9]
        _, out, _ = self.call(made_run.write_run(self.folder / "b", events=lost))
        self.assertIn("b: TRUTH: no message between 4 s and 5 s, between 7 s and 9 s, between 15 s and 18 s, and in 2 shorter gaps\n", out)

    def test_a_page_is_small(self):
        made_run.write_run(self.folder / "a")
        self.views_of("a")
        self.assertLess((self.folder / "page.html").stat().st_size, 1_000_000)

    def test_no_label_lies_over_another_at_any_width_and_all_are_readable_in_the_dark(self):
        made_run.write_run(self.folder / "a")
        made_run.write_run(self.folder / "b_with_a_name_as_long_as_a_name_may_be")
        self.views_of("a", "b_with_a_name_as_long_as_a_name_may_be")
        with Browser() as browser:
            for width, dark in ((1400, False), (800, True), (420, True)):
                page = browser.open((self.folder / "page.html").as_uri(), width, 900, dark)
                page.until("document.getElementById('picture').dataset.drawn")
                names = page.value("[...document.querySelectorAll('.views button')].filter((b) => !b.hidden).map((b) => b.value)")
                self.assertEqual(len(names), 2 if width == 420 else 3)
                for name in names:
                    page.value(f"document.querySelector('button[value=\"{name}\"]').click()")
                    page.until(f"document.getElementById('picture').dataset.drawn === '{name}'")
                    with self.subTest(width=width, view=name):
                        self.assertEqual(overlaps(page), [])
                        self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                fill = page.value("getComputedStyle(document.querySelector('#picture .ytick text')).fill")
                back = page.value("getComputedStyle(document.body).backgroundColor")
                bright = [sum(map(int, re.findall(r"\d+", colour)[:3])) / 765 for colour in (fill, back)]
                self.assertGreater(bright[0] - bright[1] if dark else bright[1] - bright[0], 0.6, (fill, back))
                self.assertGreater(contrast_of(page, "#picture .annotation:last-child .annotation-text"), 4.5)  # WCAG 2.2, 1.4.3; the modes' names are the faintest
                self.assertEqual(page.complaints, [])
                browser.close(page)

    def with_a_ramp(self, events, groups=2):
        """The same run with CONTROLLER_STATE, and of so many motor groups."""
        made = []
        for channel, time, message in events:
            if hasattr(message, "group_count"):
                message.group_count = groups
                for name, dimensions in zip(message.__slots__, message.__dimensions__):
                    if dimensions == ["group_count"]:
                        setattr(message, name, [getattr(message, name)[group % 2] for group in range(groups)])
            made.append((channel, time, message))
            if channel == "TORQUE":
                state = made_run.types.controller_state_t()
                state.sequence, state.simulated_time, state.answered_sequence = message.sequence, time, message.sequence
                state.configuration_hash, state.run_identity = message.configuration_hash, message.run_identity
                state.group_count, state.proportional_torque, state.integral_torque = groups, [0.0] * groups, [0.0] * groups
                made.append(("CONTROLLER_STATE", time, state))
        return made

    def test_legends_have_room_however_many_runs_and_motor_groups_are_shown(self):
        for names, groups in (("abc", 2), ("de", 4)):
            for name in names:
                made_run.write_run(self.folder / name, events=self.with_a_ramp(made_run.messages(), groups))
            self.views_of(*names)
            with Browser() as browser:
                for width in (1400, 800, 420, 360):
                    page = browser.open((self.folder / "page.html").as_uri(), width, 900)
                    page.until("document.getElementById('picture').dataset.drawn")
                    for name in page.value("[...document.querySelectorAll('.views button')].filter((b) => !b.hidden).map((b) => b.value)"):
                        page.value(f"document.querySelector('button[value=\"{name}\"]').click()")
                        page.until(f"document.getElementById('picture').dataset.drawn === '{name}'")
                        with self.subTest(runs=names, width=width, view=name):
                            self.assertEqual(overlaps(page), [])
                            self.assertEqual(self.covered_legends(page), [])
                    self.assertEqual(page.complaints, [])
                    browser.close(page)

    def covered_legends(self, page):
        """Legends that lie over another one, or over the frame of a row that they do not belong to or stand above."""
        return page.value("""(() => { const found = [], picture = document.getElementById("picture");
            const legends = [...picture.querySelectorAll("g[class^=legend]")].filter((e) => /^legend[0-9]*$/.test(e.getAttribute("class")));
            const frames = [...picture.querySelectorAll(".cartesianlayer .plot, .bglayer .bg")].filter((e) => e.getBoundingClientRect().width > 0);
            const boxes = [...legends, ...frames].map((e) => e.getBoundingClientRect());
            for (let i = 0; i < legends.length; ++i) for (let k = i + 1; k < boxes.length; ++k) {
              const a = boxes[i], b = boxes[k];
              if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1)
                found.push([i, k]);
            }
            return found; })()""")

    def test_the_finding_says_what_the_numbers_say(self):
        quiet = made_run.messages()
        for _, _, message in quiet:
            if hasattr(message, "play_crossings"):
                message.play_crossings = [0, 0]
            if hasattr(message, "tip_acceleration"):
                message.tip_acceleration *= 0.5
        on = read_run(made_run.write_run(self.folder / "on", events=quiet))
        off = read_run(made_run.write_run(self.folder / "off", play_compensation=False))
        text = finding(on, off)
        self.assertIn("no gearbox crosses its play before the emergency stop", text)
        self.assertIn("2 and 1 times", text)
        self.assertIn("0.4 m/s² instead of 0.8 m/s², 50 % less", text)
        self.assertIn("100 % more", finding(off, on))


if __name__ == "__main__":
    unittest.main()
