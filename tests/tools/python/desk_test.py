"""The desk in a headless Chromium."""

import os
import re
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import made_run
from browser import PATIENCE, Browser

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
        with DeskProcess(made_run.write_run(self.folder / "a")) as desk:
            page = self.open(desk.address)
            self.assertIn("slewing speed", page.value("document.body.innerText"))
            # The run's messages say: -50 N m of 250 before the stop at 10 s in group 2, 30 N m behind it; a request of 1 from 2 s on.
            for time, torque, request in ((1.0, -20.0, "0 %"), (5.0, -20.0, "100 %"), (15.0, 12.0, "100 %, emergency stop")):
                page.value(f"document.getElementById('scrub').value = {time}, "
                           "document.getElementById('scrub').dispatchEvent(new Event('input'))")
                page.until(f"Math.abs(desk.charts[1].cursor - {time}) < 0.001")
                page.until(f"Number([...document.querySelectorAll('.chart')].find(c => c.textContent.startsWith('motor torque'))"
                           f".querySelectorAll('b')[1].textContent) === {torque}")
                self.assertIn(f"request\n{request}\n", page.value("document.getElementById('facts').innerText"))
            # Played ten times as fast from 15 s on, it comes to its end at 20 s and stops there.
            page.value("document.getElementById('rate').value = '20', desk.play(true)")
            page.until("!desk.playing && Math.abs(desk.at - 20) < 0.001")


if __name__ == "__main__":
    unittest.main()
