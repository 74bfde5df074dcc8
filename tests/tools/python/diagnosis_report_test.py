"""The page of a diagnosis, made of findings of a few lines."""

import json
import re
import resource
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import diagnosis_report
from browser import Browser, overlaps
from picture_page import unpacked
from run_log import REPOSITORY

COLUMNS = ("time_s", "speed", "missing_torque", "missing_torque_after", "torque", "torque_before", "torque_after", "tip",
           "tip_before", "tip_after")


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

    def test_a_controller_that_differs_with_its_effects_left_out_has_no_cause_to_draw(self):
        page = self.page()
        self.assertIn("The controller differs.", page)
        self.assertIn("with nothing added", page)

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
