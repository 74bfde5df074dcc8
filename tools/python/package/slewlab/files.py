"""slewlab's own files, and what stands in a file of a user's: read by the C++ core alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

Changes = Mapping[str, Any]


def home() -> Path:
    """The folder that holds config/: of a wheel share/slewlab in the package itself, of a build the source tree, of an installation
    PREFIX/share/slewlab; $SLEWLAB_HOME before all of them."""
    package = Path(__file__).resolve().parent
    places = [package / "share" / "slewlab"]
    pointer = package.parents[1] / "slewlab_home"  # CMake leaves it in the build's folder
    if pointer.is_file():
        places.append((package.parents[1] / pointer.read_text().strip()).resolve())
    places += [parent / "share" / "slewlab" for parent in package.parents]
    if os.environ.get("SLEWLAB_HOME"):
        places = [Path(os.environ["SLEWLAB_HOME"])]
    for place in places:
        if (place / "config").is_dir():
            return place
    raise FileNotFoundError(f"no folder config in {', '.join(map(str, places))}; name its folder in SLEWLAB_HOME")


def path_of(given: str | os.PathLike[str], what: str) -> Path:
    """Where a file is asked for: no Machine, no Scenario, whose changes would be lost."""
    if not isinstance(given, (str, os.PathLike)):
        raise TypeError(f"found {given!r}, expected the path of {what}")
    return Path(given)


def config(name: str = "") -> Path:
    """A file of those that come with slewlab: config("cranes/thesis.yaml")."""
    path = home() / "config" / name
    if not path.exists():
        missing = path
        while not missing.parent.is_dir():
            missing = missing.parent
        known = sorted(each.name for each in missing.parent.iterdir() if each.is_dir() or each.suffix == ".yaml")
        raise FileNotFoundError(f"{path}: expected {_core.known_names_text(missing.name, known)}")
    return path


def text_of(value: Any) -> str:
    """A value of `changes` as a file would have it: 60, "60 t", True, [1, 2]; None takes a value away. TypeError where it is none of these."""
    if value is None:
        return "null"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(text_of, value)) + "]"
    if isinstance(value, (int, str, Path)):
        return str(value)
    if isinstance(value, Mapping) or np.ndim(value) > 0:
        raise TypeError(f"found {value!r}")
    return repr(float(value))


def pairs(changes: Changes | None) -> list[tuple[str, str]]:
    texts = []
    for key, value in (changes or {}).items():
        try:
            texts.append((key, text_of(value)))
        except (TypeError, ValueError):
            raise TypeError(f"{key}: found {value!r}, expected a number, a text with its unit, a truth value, a list of these, or None") from None
    return texts


def check(path: str | Path, changes: Changes | None = None) -> list[str]:
    """What `slewlab check` warns of, one line each. Raises InputError, one line per problem, where a run would refuse it."""
    problems, warnings = _core.check(path_of(path, "a file of slewlab"), pairs(changes))
    if problems:
        raise _core.InputError("\n".join(problems))
    return warnings


def values(path: str | Path, changes: Changes | None = None) -> pd.DataFrame:
    """Every value of a file, what it includes and what is changed: key as the index, value as it is written, unit, source,
    file and line."""
    import pandas as pd

    rows = _core.file_values(path_of(path, "a file of slewlab"), pairs(changes))
    return pd.DataFrame(rows, columns=["key", "value", "unit", "source", "file", "line"]).set_index("key")
