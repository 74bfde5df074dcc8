"""The programs of an installation (tools/python) as modules."""

from __future__ import annotations

import functools
import importlib
import sys
from types import ModuleType

from .files import home


@functools.cache
def installed_module(name: str) -> ModuleType:
    """One of them. Its neighbours' names (report, panel, ...) stay free for the user's own."""
    folder = home() / "tools" / "python"
    names = [path.stem for path in folder.glob("*.py")]
    if not names:
        raise FileNotFoundError(f"{folder}: found no programs that draw, expected those of an installation (docs/install.md)")
    hidden = {each: sys.modules.pop(each) for each in names if each in sys.modules}
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))
        for each in names:
            sys.modules.pop(each, None)
        sys.modules.update(hidden)
