import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import score_report
from browser import Browser, contrast_of


def score(name, value, aim=None, reached=False):
    one = {"name": name, "value": value, "low": 0.5, "high": 0.75, "cases": 8}
    return one | ({"aim": aim, "reached": reached} if aim else {})


DATA = {
    "scores": [score("first cause right", 0.625, ">= 0.95"), score("false alarms", 0.0, "<= 0.02", True)],
    "also": [score("refused", None)],
    "confusion": {"droop": {"droop": 3, "other_gains": 1}, "droop + wind": {"wind": 1},
                  "tight_spot (no catalogue)": {"outside the catalogue": 2}},
    "sizes": [{"law": "droop", "effect": "droop", "size": 2.0, "visibility": 12.0, "detected": True, "credit": 1.0}],
    "calibration": [{"stated": 0.9, "right": 0.75, "cases": 8}],
    "failures": ["case_0003 (one effect): <droop> answered wrongly"],
    "set": {"cases": 8, "seed": 7, "purpose": "tune"},
}


class ScoreReportTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.file = Path(temporary.name) / "score.json"
        self.file.write_text(json.dumps(DATA))

    def call(self, *arguments):
        """Exit code, standard output and standard error of the program."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = score_report.main([str(a) for a in arguments])
        return code, out.getvalue(), err.getvalue()

    def test_the_page_stands_beside_the_scores_and_says_them(self):
        code, _, _ = self.call(self.file)
        self.assertEqual(code, 0)
        page = self.file.with_name("score.html").read_text()
        for words in ("8 cases, seed 7 (tune)", "<td class='number no'>0.625</td>", "<td class='number yes'>0.000</td>",
                      "other_gains × 1", "&lt;droop&gt; answered wrongly"):
            self.assertIn(words, page)

    def test_the_page_says_which_cases_and_of_what_laws(self):
        for change, words in (({"cases": 6}, "the first 6 of 8 cases, seed 7 (tune). Green"),
                              ({"cases": 3, "from": 4}, "cases 4 to 6 of 8, seed 7 (tune). Green"),
                              ({"set": DATA["set"] | {"laws": "known"}}, "what can be reached at best. Green")):
            with self.subTest(words=words):
                self.file.write_text(json.dumps(DATA | change))
                self.assertEqual(self.call(self.file)[0], 0)
                self.assertIn(words, self.file.with_name("score.html").read_text())

    def test_words_are_readable_in_light_and_dark_and_the_page_is_no_wider_than_its_window(self):
        self.call(self.file)
        with Browser() as browser:
            for width, dark in ((1400, False), (800, True), (420, True), (420, False)):
                page = browser.open(self.file.with_name("score.html").as_uri(), width, 900, dark)
                with self.subTest(width=width, dark=dark):
                    self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                    for words in ("svg text", "td", "td.no", "td.yes", "p", ".small"):
                        self.assertGreater(contrast_of(page, words), 4.5, words)  # WCAG 2.2, 1.4.3: contrast of text, level AA
                browser.close(page)

    def test_an_answer_in_no_catalogue_is_right_where_the_truth_is_in_none(self):
        self.assertTrue(score_report.right("tight_spot (no catalogue)", "outside the catalogue"))
        self.assertFalse(score_report.right("droop", "outside the catalogue"))

    def test_markdown_has_every_score_and_the_confusion_of_single_effects(self):
        code, out, _ = self.call(self.file, "--markdown")
        self.assertEqual(code, 0)
        self.assertFalse(self.file.with_name("score.html").exists())
        lines = out.splitlines()
        self.assertIn("| first cause right | 0.625 | 0.500 ... 0.750 | 8 | >= 0.95 (not reached) |", lines)
        self.assertIn("| false alarms | 0.000 | 0.500 ... 0.750 | 8 | <= 0.02 (reached) |", lines)
        self.assertIn("| refused | – |  | 8 |  |", lines)
        self.assertIn("| droop | droop 3, other_gains 1 |", lines)
        self.assertFalse([line for line in lines if line.startswith("| droop + wind")])

    def test_a_file_that_holds_no_scores_is_named(self):
        self.file.write_text("no json")
        code, _, err = self.call(self.file)
        self.assertEqual(code, 1)
        self.assertIn(str(self.file), err)
        self.assertFalse(self.file.with_name("score.html").exists())


if __name__ == "__main__":
    unittest.main()
