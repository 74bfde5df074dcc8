import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

from run_log import REPOSITORY, read_run_log, seconds


class ReadmeTest(unittest.TestCase):
    def test_the_controller_printed_there_drives_the_crane(self):
        code = re.search(r"```python\n(.*?)```", (REPOSITORY / "README.md").read_text(), re.DOTALL).group(1)
        binaries = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin"
        with tempfile.TemporaryDirectory() as folder:
            controller = Path(folder) / "my_controller.py"
            controller.write_text(code)
            run = subprocess.run(
                [REPOSITORY / "tools" / "in-private-network", binaries / "slewlab", "run",
                 REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml", "--set", "duration=20",
                 "--out", folder, "--controller", f"{sys.executable} {controller}"],
                env=os.environ | {"PYTHONPATH": os.environ["SLEWLAB_PYTHON_MESSAGES"]},
                stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            facts = json.loads((Path(folder) / "run.json").read_text())
            self.assertEqual(facts["end"], "complete")
            encoder = read_run_log(Path(folder) / "run.lcmlog").channel("ENCODER")
        # A proportional gain of 20 Nm s/rad holds the shaft within what the load asks of it, 100 Nm at most: 5 rad/s
        # of the 137 that top speed means.
        settled = encoder["shaft_speed"][seconds(encoder) > 12.0].mean(axis=0) / facts["total_ratio"]
        np.testing.assert_allclose(settled, facts["top_speed"], rtol=0.04)


if __name__ == "__main__":
    unittest.main()
