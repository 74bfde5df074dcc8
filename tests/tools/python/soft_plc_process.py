"""`slewlab soft-plc` for tests: there when the block begins, ended when it ends."""

import contextlib
import subprocess

from run_log import REPOSITORY, messages_folder

SLEWLAB = messages_folder().parent / "bin" / "slewlab"
MAPS = REPOSITORY / "config" / "plc"
CONTROLLER = REPOSITORY / "config" / "controllers" / "thesis.yaml"
PATIENCE = 100.0  # [s]


@contextlib.contextmanager
def soft_plc(plc_map):
    process = subprocess.Popen([SLEWLAB, "soft-plc", "--map", plc_map, "--controller", CONTROLLER], stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert line.startswith("soft-plc: "), line
        yield process
    finally:
        if process.returncode is None:
            process.terminate()
            process.communicate(timeout=PATIENCE)
