"""slewlab._core, the C++ core in this process, of the build or the installation that the messages are of. The extension alone: the
package around it takes pandas, for which a program that needs none does not wait."""

import importlib.machinery
import importlib.util
import sys
from pathlib import Path

from run_log import LogProblem, messages_folder

NAME = "slewlab._core"


def _load():
    if NAME in sys.modules:
        return sys.modules[NAME]
    files = [messages_folder() / "slewlab" / f"_core{suffix}" for suffix in importlib.machinery.EXTENSION_SUFFIXES]
    file = next(filter(Path.exists, files), None)
    if file is None:
        raise LogProblem(f"{messages_folder()}: the package slewlab is not built; run tools/build")
    spec = importlib.util.spec_from_file_location(NAME, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[NAME] = module
    spec.loader.exec_module(module)
    return module


core = _load()
