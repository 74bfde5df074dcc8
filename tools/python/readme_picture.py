"""Makes docs/images/demo.png, the README's picture, out of the demo's two runs. Needs Chromium.

    .venv/bin/python tools/python/readme_picture.py runs/thesis_slew runs/thesis_slew_without_play_compensation
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import report
from run_log import REPOSITORY
from run_numbers import read_run

PANELS = ("slewing speed", "gearbox torque", "tip acceleration", "spectrum after the stop")
WIDTH = 1280  # [px]


def main(folders):
    runs = [read_run(folder) for folder in folders]
    picture = report.figure(runs, [panel for panel in report.panels(runs) if panel.title in PANELS])
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "picture.html"
        page.write_text("<style>body { margin: 8px }</style>" + picture.to_html(config={"displayModeBar": False}))
        subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
             f"--user-data-dir={folder}/profile", "--virtual-time-budget=8000",
             f"--window-size={WIDTH},{picture.layout.height + 16}",
             f"--screenshot={REPOSITORY / 'docs' / 'images' / 'demo.png'}", page.as_uri()],
            check=True, stderr=subprocess.DEVNULL, timeout=120)


if __name__ == "__main__":
    main(sys.argv[1:])
