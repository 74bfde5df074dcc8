"""slewlab._core, the C++ core in this process, of the build or the installation that the messages are of."""

import sys

from run_log import LogProblem, messages_folder


def load():
    folder = messages_folder()
    if not (folder / "slewlab").is_dir():
        raise LogProblem(f"{folder}: the package slewlab is not built; run tools/build")
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    from slewlab import _core

    return _core


core = load()
