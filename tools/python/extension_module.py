"""The extension modules of the package slewlab, of the build or the installation that the messages are of. The extensions alone: the
package around them takes pandas, for which a program that needs none does not wait."""

import importlib.machinery
import importlib.util
import sys
from pathlib import Path

from run_log import LogProblem, messages_folder


def loaded(name):
    full_name = f"slewlab.{name}"
    if full_name in sys.modules:
        return sys.modules[full_name]
    folder = messages_folder() / "slewlab"
    if not folder.is_dir():  # of a wheel, whose interpreter has the package
        package = importlib.util.find_spec("slewlab")
        folder = Path(package.submodule_search_locations[0]) if package else folder
    files = [folder / f"{name}{suffix}" for suffix in importlib.machinery.EXTENSION_SUFFIXES]
    file = next(filter(Path.exists, files), None)
    if file is None:
        raise LogProblem(f"{messages_folder()}: {full_name} is not built; run tools/build")
    spec = importlib.util.spec_from_file_location(full_name, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[full_name] = module
    spec.loader.exec_module(module)
    return module
