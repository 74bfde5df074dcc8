"""Messages as tables: a row per message, indexed by simulated time [s], arrays as columns name_1, name_2, ..., units in
`table.attrs["units"]`."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, _log
from .installed import installed_module

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

HEAD = ("sequence", "simulated_time", "configuration_hash", "run_identity")  # of every message


def factor(unit: str, to: str) -> float:
    """What a number in `unit` is multiplied by to be one in `to`: factor("deg", "rad")."""
    return _core.factor(unit, to)


@functools.cache
def unit_text(unit: str) -> str:
    """A unit as all tables have it, with blanks between its factors: "N m" of "Nm"."""
    try:
        known = [spelling for spelling, _ in _core.spellings(unit)]
    except ValueError:  # none that files know: J
        return unit
    return next((each for each in known if each.replace(" ", "") == unit.replace(" ", "")), unit)


def row_type(layout: dict[str, Any]) -> np.dtype:
    """Of a row of messages, as the core describes it."""
    described: Any = layout  # numpy's own types name no dictionary that is not spelled out
    return np.dtype(described)


def frame(channel: str, messages: np.ndarray, units_of: dict[str, str], head: bool = False) -> pd.DataFrame:
    """`units_of`: of the channel's fields. `head`: with sequence number, configuration and run as columns."""
    import pandas as pd

    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for name in messages.dtype.names or ():
        if name in HEAD and not (head and name != "simulated_time"):
            continue
        values = messages[name]
        if values.ndim == 1:
            columns[name], units[name] = values, unit_text(units_of[name])
            continue
        for entry in range(values.shape[1]):
            columns[f"{name}_{entry + 1}"] = values[:, entry]
            units[f"{name}_{entry + 1}"] = unit_text(units_of[name])
    table = pd.DataFrame(columns, index=pd.Index(messages["simulated_time"] * 1e-9, name="time"))
    table.attrs["units"] = units | {"time": "s"}
    table.attrs["channel"] = channel
    return table


class Channels:
    """Tables by the name of their channel, made when they are asked for."""

    def __init__(self) -> None:
        self._frames: dict[str, pd.DataFrame] = {}

    @property
    def channels(self) -> list[str]:
        raise NotImplementedError

    @property
    def units(self) -> dict[str, dict[str, str]]:
        """{channel: {field: unit}}, of the machine that the messages are of."""
        raise NotImplementedError

    def messages(self, channel: str) -> np.ndarray:
        """The channel's messages as one structured array, a field per message field."""
        raise NotImplementedError

    def require(self, channel: str) -> None:
        """KeyError, with the near name, where there is no such channel."""
        if channel not in self.channels:
            raise KeyError(f"no {channel} here, expected {_core.known_names_text(channel, self.channels)}")

    def __getitem__(self, channel: str) -> pd.DataFrame:
        if channel not in self._frames:
            self._frames[channel] = frame(channel, self.messages(channel), self.units[channel])
        return self._frames[channel]

    def __contains__(self, channel: str) -> bool:
        return channel in self.channels

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)


class Log(Channels):
    """The longest run of a log. `remarks` says what of the file could not be used."""

    def __init__(self, path: str | Path) -> None:
        super().__init__()
        path = Path(path)
        if path.is_dir():
            names = [path / "run.lcmlog", path / "run.lcmlog.partial"]
            path = next(filter(Path.exists, names), None) or names[0]
            if not path.exists():
                raise _log.LogError(f"{path.parent}: found a folder without run.lcmlog, expected a log, or the folder of a run")
        self.path = path
        self._tables = _log.LogTables(path)
        self.remarks: list[str] = self._tables.remarks

    @property
    def channels(self) -> list[str]:
        return self._tables.channels

    @functools.cached_property
    def units(self) -> dict[str, dict[str, str]]:
        """With what stands beside the log of its machine: run.json of a run, or what `slewlab import` wrote."""
        if not any(self.path.parent.glob("*.json")):
            return _log.signals()
        try:
            return installed_module("signals").units_of(installed_module("run_numbers").facts_beside(self.path))
        except FileNotFoundError as missing:  # the package alone, without the programs that know a machine by what stands beside its log
            self.remarks.append(f"units are those of a crane, whatever machine the log is of: {missing}")
            return _log.signals()

    def messages(self, channel: str) -> np.ndarray:
        self.require(channel)
        return self._tables.rows(channel).view(row_type(self._tables.layout(channel)))

    def stretches(self, *channels: str) -> Iterator[dict[str, np.ndarray]]:
        """The messages of these channels, or of all, a stretch of the file at a time: for a log that is larger than memory."""
        for channel in channels:
            self.require(channel)
        dtypes = {channel: row_type(self._tables.layout(channel)) for channel in channels or self.channels}
        for stretch in self._tables.stretches(list(dtypes)):
            yield {channel: rows.view(dtypes[channel]) for channel, rows in stretch.items()}

    def __repr__(self) -> str:
        return f"<Log {self.path}: {', '.join(self.channels)}>"


def open_log(path: str | Path) -> Log:
    """A log, or the folder of a run. Raises LogError where it cannot be read or holds no run."""
    return Log(path)
