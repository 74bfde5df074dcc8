"""Reads a run's log (run.lcmlog) as numpy arrays: a structured array per channel, a field per message field.

The log is decoded by slewlab._log in this process (tools/python/core/log_bindings.cpp), a stretch of the file at a time and ahead of
whoever computes with it, so that a log larger than memory can be gone through by stretches(); channel() holds a whole channel. Which
messages are the run follows msgs/run_order.h; what cannot be used is told in `remarks`, one line each.
"""

import importlib
import importlib.util
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]

class LogProblem(Exception):
    """The log cannot be read or holds no run. The text says which file and why."""


@dataclass(frozen=True)
class Table:
    """A channel's messages without their values."""

    dtype: np.dtype
    rows: int
    first: float  # [s] smallest simulated time
    last: float   # [s] largest


def seconds(messages):
    """[s] simulated time of each message."""
    return messages["simulated_time"] / 1e9


def messages_folder():
    """What the build made for Python of msgs/*.lcm. SLEWLAB_PYTHON_MESSAGES names another folder than build/release/python."""
    return Path(os.environ.get("SLEWLAB_PYTHON_MESSAGES", REPOSITORY / "build" / "release" / "python"))


def slewlab_program():
    """The command itself, for whoever runs it again."""
    return Path(os.environ.get("SLEWLAB_PROGRAM", messages_folder().parent / "bin" / "slewlab"))


def built_module(package, what):
    """A package that the build made for Python. `what` it is stands in the problem where it was not made."""
    folder = messages_folder()
    if (folder / package).is_dir():
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))
    elif importlib.util.find_spec(package) is None:  # of a wheel, whose interpreter has it
        raise LogProblem(f"{folder}: {what} not built; run tools/build")
    return importlib.import_module(package)


def message_types():
    """The module that lcm-gen made."""
    return built_module("slewlab_msgs", "the messages for Python are")


class RunLog:
    """The run in the log. Where a file holds several, the one with the most messages is taken, and that is said.
    Messages are read when they are asked for: the file has to stay until then."""

    def __init__(self, path):
        from extension_module import loaded  # which asks this module where the build is

        self.path, self._whole = Path(path), {}
        reader = loaded("_log")
        self._problem = reader.LogError
        try:
            self._log = reader.LogTables(self.path)
        except self._problem as error:
            raise LogProblem(str(error)) from None
        self.remarks, self.lateness = self._log.remarks, self._log.lateness
        self.tables = {}
        for channel in self._log.channels:
            rows, first, last = self._log.extent(channel)
            self.tables[channel] = Table(np.dtype(self._log.layout(channel)), rows, first / 1e9, last / 1e9)

    def has(self, name):
        return name in self.tables

    def stretches(self, *names):
        """The messages of these channels (none named: of all), a stretch of the file at a time: {name: messages}. Within a
        channel the keys rise; a message's time lies at most `lateness` [ns] before that of any stretch before it."""
        try:
            for stretch in self._log.stretches(list(names or self.tables)):
                yield {name: rows.view(self.tables[name].dtype) for name, rows in stretch.items()}
        except self._problem as error:
            raise LogProblem(str(error)) from None

    def channel(self, name):
        """All of the channel's messages in the order of their sequence; LogProblem where the log has none."""
        if name not in self.tables:
            raise LogProblem(f"{self.path}: no usable {name} message in this log")
        if name not in self._whole:
            table = self.tables[name]
            whole, filled = np.empty(table.rows, table.dtype), 0
            for stretch in self.stretches(name):
                part = stretch[name][:table.rows - filled]
                whole[filled:filled + len(part)] = part
                filled += len(part)
            if filled != table.rows:
                raise LogProblem(f"{self.path}: changed while it was read")
            self._whole[name] = whole
        return self._whole[name]


def read_run_log(path):
    path = Path(path)
    if not path.is_file():
        raise LogProblem(f"{path}: there is no such log")
    return RunLog(path)


# What a later run in a run's folder takes away (tools/commands/run_facts.cpp, remove_earlier_run): a picture or an export under another
# name would stay beside that run's log and be taken for its own.
OF_A_RUN = ("report.html", "run.html", "run.mcap", "run_parquet", "run_csv")


def beside_its_run(out):
    """`out`, where a picture or an export of a run is written; LogProblem where it would stay beside a later run's log."""
    folder = Path(out).parent
    is_a_run = (folder / "run.json").exists() and any((folder / log).exists() for log in ("run.lcmlog", "run.lcmlog.partial"))
    if is_a_run and Path(out).name not in OF_A_RUN:
        raise LogProblem(f"--out: found '{out}' in the folder of a run, where a later run would leave it beside its own log; "
                         f"expected one of {', '.join(OF_A_RUN)} there, or another folder")
    return out
