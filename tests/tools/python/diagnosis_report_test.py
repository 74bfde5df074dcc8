"""The page of a diagnosis, made of findings of a few lines."""

import html
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import diagnosis_report
import diagnosis_words
import effect_words
from browser import Browser, contrast_of, overlaps
from picture_page import unpacked
from run_log import REPOSITORY

COLUMNS = ("time_s", "speed", "missing_torque", "missing_torque_after", "torque", "torque_before", "torque_after", "tip",
           "tip_before", "tip_after")

# Findings as the command writes them, a few lines of each: (summary.txt, what of diagnosis.json differs).
VALIDATION = {"nominal": {"residual_variance_ratio": 110.8}, "parameters": {"residual_variance_ratio": 73.36},
              "cause": {"residual_variance_ratio": 0.891}, "holds": True}
SURE = ("dragging_brake, 97 %; it explains 100.0 % of the gap on data that were not fitted.\n\nIs there a gap?  Yes.\n",
        {"causes": [{"effects": ["dragging_brake"], "probability": 0.97, "explained_share": 0.9996, "or": [], "cannot_be_told_from": [], "validation": VALIDATION,
                     "sizes": [{"parameter": "dragging_brake.torque", "value": 12.04, "unit": "N m", "low_90": 11.05, "high_90": 13.03},
                               {"parameter": "dragging_brake.unevenness", "value": -0.000319, "unit": "-", "low_90": -0.003296, "high_90": 0.002658}]},
                    {"effects": ["dragging_brake", "wind"], "probability": 0.0099, "explained_share": 1.0, "sizes": []}],
         "probability_unknown": 0.0, "gaps_on": "b.lcmlog (not fitted; simulated from the operator's commands alone)",
         "gaps": [{"signal": "torque of group 1", "unit": "Nm", "measured_rms": 85.6, "before": 13.73, "after": 0.102}]})
DOUBTFUL = ("Not sure: command_loss, 68 % (59 % alone, the rest beside what these records may hide); these records cannot tell it from wind.\n\n"
            "Next manoeuvre    next_manoeuvre.yaml (a reversal at full speed without a stop): 0.37 of the 0.37 bits that are open are expected of it; command_loss and "
            "wind differ most in the shaft speed of group 2, by 9 times its noise. Run it, and give its log on top of these.\n",
            {"causes": [{"effects": ["command_loss"], "probability": 0.591, "explained_share": 0.994, "validation": VALIDATION | {"holds": False},
                         "cannot_be_told_from": [{"cause": "wind", "signature_apart": 0.04}],
                         "sizes": [{"parameter": "command_loss.probability", "value": 0.7601, "unit": "-", "low_90": 0.33, "high_90": 0.99}]},
                        {"effects": ["wind"], "probability": 0.08, "explained_share": 0.9, "sizes": []}],
             "probability_unknown": 0.28, "moments": [{"log": "wind/a.lcmlog"}],
             "unseen": [{"log": "wind/u.lcmlog", "cause": "command_loss", "validation": VALIDATION,
                         "missing_torque_rms_nm": {"nominal": 8.014, "parameters": 7.66, "cause": 1.179}}],
             "told_apart_by": [{"from": "wind", "advice": "a slew there and back at full speed would: tip acceleration 0.054 m/s^2 apart, 11 times its noise"}]})
OUTSIDE = ("Outside the catalogue (unknown), 70 %: no known effect explains the gap on data that were not fitted; the missing torque follows the speed (87 % of "
           "what is slower than the structure).\n",
           {"causes": [{"effects": ["gear_friction"], "probability": 0.086, "explained_share": 0.371, "sizes": []}], "probability_unknown": 0.7})
NOTHING_MISSING = ("No effect is missing: parameters within their spread explain the records.\n",
                   {"gap": False, "causes": [{"effects": [], "probability": 0.908, "explained_share": 0.0, "sizes": []}], "probability_unknown": 0.0,
                    "probability_hidden": 0.092, "gaps_on": "b.lcmlog (fitted)",
                    "gaps": [{"signal": "torque of group 1", "unit": "Nm", "measured_rms": 85.6, "before": 13.73, "after": 13.5}]})
TWO_NAMES = ("Not sure: torque_ripple with dead_time or torque_ripple with command_delay, 62 %, indistinguishable in these records.\n",
             {"causes": [{"effects": ["torque_ripple", "dead_time"], "or": [["torque_ripple", "command_delay"]], "probability": 0.54, "explained_share": 1.0,
                          "sizes": [{"parameter": "dead_time.delay", "value": 0.003727, "unit": "s", "low_90": 0.0016, "high_90": 0.0058}]}],
              "probability_unknown": 0.2})
NOISE_LEFT = ("rope_length, 98 %; it explains 100.0 % of the gap on data that were not fitted.\n",
              {"causes": [{"effects": ["rope_length"], "probability": 0.98, "explained_share": 0.024, "sizes": []}], "probability_unknown": 0.0,
               "residual_variance_ratio_parameters": 0.7722})
MADE = {"sure": SURE, "noise left": NOISE_LEFT, "doubtful": DOUBTFUL, "outside": OUTSIDE, "nothing missing": NOTHING_MISSING, "two names": TWO_NAMES}
CUT = """[...document.querySelectorAll(".picture text")].filter((e) => e.textContent.trim()).filter((e) => {
    const a = e.getBoundingClientRect(), b = e.closest(".picture").getBoundingClientRect(); return a.left < b.left - 1 || a.right > b.right + 1; }).map((e) => e.textContent)"""


def words(page):
    """What is read of HTML."""
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", page)).split())


class DiagnosisReportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.found = {"verdict": "The controller differs.", "causes": [], "modes": [],
                      "spectrogram": {"highest_hz": 10.0, "window_s": 1.0},
                      "probability_unknown": 1.0}
        (self.folder / "summary.txt").write_text("Is there a gap? Yes.\n")
        rows = [",".join(COLUMNS)] + [",".join([f"{0.01 * n:.2f}"] + ["0.5"] * (len(COLUMNS) - 1)) for n in range(500)]
        (self.folder / "series.csv").write_text("\n".join(rows) + "\n")

    def page(self):
        (self.folder / "diagnosis.json").write_text(json.dumps(self.found))
        page = diagnosis_report.page(str(self.folder))
        return page + unpacked(page)

    def make(self, name, **differs):
        """All of the page that stands above the summary, but for the pictures' script."""
        self.write(name, **differs)
        found = json.loads((self.folder / "diagnosis.json").read_text())
        return diagnosis_words.head(found, MADE[name][0], str(self.folder))

    def write(self, name, **differs):
        summary, made = MADE[name]
        (self.folder / "summary.txt").write_text(summary)
        found = self.found | {"gap": True, "crane": "/cranes/thesis.yaml"} | made | differs
        (self.folder / "diagnosis.json").write_text(json.dumps(found))

    def test_a_controller_that_differs_with_its_effects_left_out_has_no_cause_to_draw(self):
        (self.folder / "summary.txt").write_text("The controller differs.\n\nIs there a gap? Yes.\n")
        page = self.page()
        self.assertIn("<h1>The controller differs.</h1>", page)
        self.assertIn("with nothing added", page)

    def test_the_first_sentence_is_the_summarys_with_its_doubt_and_says_what_an_effect_is(self):
        doubtful, sure = self.make("doubtful"), self.make("sure")
        self.assertIn("Not sure: command_loss (commands get lost on the way to the drives), 68 % (59 % alone", words(doubtful))
        self.assertTrue(words(sure).startswith("dragging_brake (brakes that do not open fully rub on the motors), 97 %; it explains 100.0 %"), words(sure))
        for name in ("doubtful", "sure"):
            self.write(name)
            page = diagnosis_report.page(str(self.folder))
            self.assertEqual(page.count("<h1>"), 1)
            self.assertIn(self.make(name) + f"<pre>{html.escape(MADE[name][0])}</pre>", page)

    def test_names_of_both_are_told_where_two_are_indistinguishable(self):
        told = words(self.make("two names"))
        for name in ("torque_ripple", "dead_time", "command_delay"):
            self.assertIn(f"{name} ({effect_words.words_of(name)})", told)
        self.assertIn("torque_ripple with dead_time or torque_ripple with command_delay", told.partition("Cause ")[2])

    def test_an_effect_that_a_logs_folder_is_called_like_is_not_taken_for_it(self):
        sentences = diagnosis_words.Sentences(DOUBTFUL[1])
        for path in ("wind/u.lcmlog", "logs/wind/u.lcmlog", "logs/wind.lcmlog", "high-wind/u.lcmlog"):
            self.assertEqual(sentences.html(f"It does not predict {path} better."), f"It does not predict {path} better.")
        self.assertEqual(words(sentences.html("These records cannot tell it from wind.")), "These records cannot tell it from wind (steady wind pushes boom and load).")

    def test_what_to_do_next_stands_behind_the_answer(self):
        (self.folder / "next_manoeuvre.yaml").write_text("controller: nowhere.yaml\n")
        page = self.make("doubtful")
        told = words(page)
        self.assertIn("Next manoeuvre: next_manoeuvre.yaml (a reversal at full speed without a stop): 0.37 of the 0.37 bits", told)
        self.assertIn("Run it, and give its log on top of these.", told.partition("Cause ")[0])
        self.assertIn("What would tell it from wind ? A slew there and back at full speed would: tip acceleration", told)
        self.assertIn('<a href="next_manoeuvre.yaml">', page)
        self.assertNotIn("Next manoeuvre", words(self.make("nothing missing")))

    def test_the_table_has_sizes_with_intervals_and_the_validation(self):
        told = words(self.make("sure"))
        # 12.04, 110.8 and 13.73 of the findings in three digits.
        for part in ("97.0 %", "torque 12 N m (11.1 to 13)", "unevenness -0.000319 (-0.0033 to 0.00266)", "100.0 %",
                     "On data that were not fitted it holds: residual variance ratio 111 \u2192 0.891 (parameters alone 73.4)",
                     "RMS error on b.lcmlog (not fitted; simulated from the operator's commands alone):", "torque of group 1 13.7 \u2192 0.102 Nm",
                     "outside the catalogue (unknown) 0.0 %", "Causes of less than 1 % are left out."):
            self.assertIn(part, told)
        self.assertNotIn("dragging_brake with wind", told)

    def test_the_table_says_what_does_not_hold_and_what_was_not_validated(self):
        told = words(self.make("doubtful"))
        self.assertIn("it does not hold : residual variance ratio 111 \u2192 0.891", told)
        self.assertIn("On wind/u.lcmlog, which had no part in the answer, it holds: residual variance ratio 111 \u2192 0.891 (parameters alone 73.4), missing torque 8.01 \u2192 1.18 Nm RMS", told)
        self.assertIn("90.0 % not validated", told)
        self.assertIn("these records cannot tell it from wind (signature 4.0 % apart)", told)
        self.assertLess(told.index("outside the catalogue (unknown) 28.0 %"), told.index("8.0 %", told.index("28.0 %") + 4))

    def test_a_share_of_noise_is_none_of_the_gap(self):
        told = words(self.make("noise left"))
        self.assertIn("98.0 %", told)
        self.assertNotIn("2.4 %", told)
        self.assertIn("2.4 %", words(self.make("noise left", residual_variance_ratio_parameters=1.2)))

    def test_nothing_missing_has_the_nominal_machines_errors_alone(self):
        told = words(self.make("nothing missing"))
        self.assertIn("nothing is missing: the nominal machine, its parameters within their spread 90.8 %", told)
        self.assertIn("RMS error on b.lcmlog (fitted), of the nominal machine: torque of group 1 13.7 Nm", told)
        self.assertIn("an effect that is too small for these records 9.2 % - - - outside the catalogue (unknown) 0.0 %", told)

    def test_effects_lead_to_their_pages_where_the_manual_is(self):
        page = self.make("doubtful")
        for name in ("command_loss", "wind"):
            self.assertIn(f'<a href="{(REPOSITORY / "docs" / "effects" / name).as_uri()}.md">{name}</a>', page)
        with mock.patch.object(effect_words, "REPOSITORY", self.folder):  # as installed, without the manual
            page = self.make("doubtful")
        self.assertNotIn("<a href", page)
        self.assertIn("<b>command_loss</b>", page)

    def test_without_the_command_a_page_is_made_all_the_same(self):
        self.addCleanup(effect_words.machine_effects.cache_clear)
        effect_words.machine_effects.cache_clear()
        with mock.patch.object(effect_words, "slewlab_program", lambda: self.folder / "none"):
            told = words(self.make("sure"))
        self.assertIn("dragging_brake (brakes that do not open fully rub on the motors), 97 %", told)  # as the manual's page has it
        self.assertNotIn("page by", told)

    def test_every_effect_of_the_manual_has_the_catalogues_words(self):
        pages = [page.stem for page in (REPOSITORY / "docs" / "effects").glob("*.md") if page.stem != "README"]
        self.assertGreater(len(effect_words.machine_effects()), 40)
        self.assertEqual(sorted(set(effect_words.machine_effects()) - set(pages)), [])
        for name in pages:
            self.assertTrue(effect_words.words_of(name), name)

    def test_it_says_of_what_it_was_made_and_when_by_no_clock(self):
        log = self.folder / "a.lcmlog"
        log.touch()
        os.utime(log, (1772600760, 1772600760))  # date -u -d @1772600760
        (self.folder / "run").mkdir()
        (self.folder / "run" / "run.lcmlog").touch()
        os.utime(self.folder / "run" / "run.lcmlog", (1772600700, 1772600700))
        made_of = {"logs": [str(log)], "unseen_logs": [str(self.folder / "run")], "controller": "/controllers/thesis.yaml"}
        page = self.make("outside", **made_of)
        self.assertIn(f"Logs: {log}, {self.folder / 'run'} (not fitted) · newest log written: 2026-03-04 05:06 UTC · crane: /cranes/thesis.yaml · "
                      f"controller: /controllers/thesis.yaml · page by: slewlab ", words(page))
        self.assertEqual(page, self.make("outside", **made_of))
        told = words(self.make("outside", logs=[str(log), "b.lcmlog"]))
        self.assertIn(f"Logs: {log}, b.lcmlog · crane: /cranes/thesis.yaml · controller: not given", told)  # b.lcmlog is not there

    def test_numbers_as_people_write_them(self):
        for value, text in ((0, "0"), (12.04, "12"), (1483.0, "1480"), (141200.0, "141000"), (3.969e6, "3.97e6"), (6.93e-5, "6.93e-5"), (-0.5224, "-0.522"), (None, "-")):
            self.assertEqual(diagnosis_words.number(value), text)

    def test_nothing_is_cut_in_a_wide_window_and_on_a_telephone(self):
        with Browser() as browser:
            for name in MADE:
                self.write(name)
                (self.folder / "page.html").write_text(diagnosis_report.page(str(self.folder)))
                for width, dark in ((1400, False), (420, True)):
                    page = browser.open((self.folder / "page.html").as_uri(), width, 900, dark)
                    page.until("[...document.querySelectorAll('.picture')].every((each) => each.dataset.drawn)")
                    with self.subTest(name=name, width=width):
                        self.assertEqual(page.complaints, [])
                        self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                        self.assertEqual(page.value(CUT), [])
                        self.assertEqual([pair for pair in overlaps(page) if re.search("[a-z]", pair)], [])
                        self.assertEqual(page.value("(() => { const e = document.querySelector('.causes .wide'); return e.scrollWidth - e.clientWidth; })()"), 0)
                        self.assertLessEqual(page.value("document.querySelector('.picture').getBoundingClientRect().right"), width)  # bars: not scrolled
                        for selector in ("h1", ".origin", "td", "td .faint", "h1 a", ".next"):
                            if page.value(f"Boolean(document.querySelector({json.dumps(selector)}))"):
                                self.assertGreater(contrast_of(page, selector), 4.5, selector)  # WCAG 2.2, 1.4.3
                    browser.close(page)

    def test_a_cause_is_named(self):
        self.found |= {"causes": [{"effects": ["dragging_brake"], "probability": 0.97}], "probability_unknown": 0.03}
        self.assertIn("dragging_brake", self.page())

    def test_no_words_of_a_picture_lie_over_each_other(self):
        self.found |= {"causes": [{"effects": ["dragging_brake"], "probability": 0.97}], "probability_unknown": 0.03}
        curve = {"missing_torque_nm": [-0.4, 0.3, 0.1], "deviation_nm": [0.2, 0.1, 0.2]}
        self.found["discrepancies"] = [
            {"follows": follows, "unit": unit, "share": 0.4,
             "curves": [curve | {"part": part, "at": [0.0001, end / 2, end]} for part in ("forward", "backward")]}
            for follows, unit, end in (("speed", "rad/s", 0.0452), ("angle of the axis", "rad", 1.2345), ("time", "s", 59.95), ("torque", "N m", 123.4))]
        self.page()
        (self.folder / "page.html").write_text(diagnosis_report.page(str(self.folder)))
        with Browser() as browser:
            for width, dark in ((1400, False), (800, False), (420, True)):
                page = browser.open((self.folder / "page.html").as_uri(), width, 900, dark)
                page.until("[...document.querySelectorAll('.picture')].every((each) => each.dataset.drawn)")
                with self.subTest(width=width):
                    # The last numbers of two axes may touch in their corner.
                    self.assertEqual([pair for pair in overlaps(page) if re.search("[a-z]", pair)], [])
                    self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                browser.close(page)

    def test_a_page_for_which_there_is_no_room_is_refused_in_words(self):
        self.page()
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))  # the page alone is larger
        ended = subprocess.run([sys.executable, REPOSITORY / "tools" / "python" / "diagnosis_report.py", self.folder],
                               preexec_fn=limit, capture_output=True, text=True, check=False)
        self.assertEqual(ended.returncode, 1)
        self.assertIn(f"cannot write {self.folder / 'diagnosis.html'}", ended.stderr)
        self.assertNotIn("Traceback", ended.stderr)
        self.assertEqual(sorted(f.name for f in self.folder.iterdir()), ["diagnosis.json", "series.csv", "summary.txt"])


if __name__ == "__main__":
    unittest.main()
