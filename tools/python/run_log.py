"""Reads a run's log (run.lcmlog) as numpy arrays: a structured array per channel, a field per message field.

The log is decoded by slewlab-log-tables (tools/python/log_tables.cpp) beside this process, a stretch of the file at a time,
so that a log larger than memory can be gone through by stretches(); channel() holds a whole channel. Which messages are
the run follows msgs/run_order.h; what cannot be used is told in `remarks`, one line each.
"""

import contextlib
import importlib
import json
import os
import struct
import subprocess
import sys
import weakref
from dataclasses import dataclass
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]

# Records of slewlab-log-tables: number of the table and of its rows, or one of these.
RECORD = struct.Struct("=ii")
END_OF_STRETCH, END_OF_ANSWER, ERROR = -1, -2, -3


class LogProblem(Exception):
    """The log cannot be read or holds no run. The text says which file and why."""


class ReaderProblem(LogProblem):
    """The reader broke down: a fault of the program, whatever the log holds."""


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
    if not (folder / package).is_dir():
        raise LogProblem(f"{folder}: {what} not built; run tools/build")
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    return importlib.import_module(package)


def message_types():
    """The module that lcm-gen made."""
    return built_module("slewlab_msgs", "the messages for Python are")


def _table(described):
    names, types, offsets = [], [], []
    for name, kind, count, offset in described["fields"]:
        names.append(name)
        types.append(kind if count is None else (kind, (count,)))
        offsets.append(offset)
    dtype = np.dtype({"names": names, "formats": types, "offsets": offsets, "itemsize": described["row_bytes"]})
    return Table(dtype, described["rows"], described["first_time"] / 1e9, described["last_time"] / 1e9)


def _stop(process):
    process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout, process.stderr):
        with contextlib.suppress(BrokenPipeError):  # a request that was never read
            pipe.close()


class RunLog:
    """The run in the log. Where a file holds several, the one with the most messages is taken, and that is said.
    Messages are read when they are asked for: the file has to stay until then."""

    def __init__(self, path):
        self.path, self._whole = Path(path), {}
        program = messages_folder() / "slewlab-log-tables"
        if not program.is_file():
            raise LogProblem(f"{program}: the log's reader is not built; run tools/build")
        self._program = program
        self._start()
        self.remarks, self.lateness = self._described["remarks"], self._described["lateness"]
        self.tables = {each["channel"]: _table(each) for each in self._described["tables"]}

    def _start(self):
        self._process = subprocess.Popen([self._program, self.path], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         stderr=subprocess.PIPE)
        self._stopper = weakref.finalize(self, _stop, self._process)
        line = self._process.stdout.readline()
        if not line.endswith(b"\n"):
            said = self._process.stderr.read().decode(errors="replace").strip()
            refused = self._process.wait() == 1
            self._stopper()
            if refused:
                raise LogProblem(said)
            raise ReaderProblem(f"{self.path}: the log's reader broke down: {said}")
        self._described = json.loads(line)

    def has(self, name):
        return name in self.tables

    def _read(self, size):
        data = self._process.stdout.read(size)
        if len(data) < size:
            self._stopper()
            raise ReaderProblem(f"{self.path}: the log's reader broke down while it read")
        return data

    def stretches(self, *names):
        """The messages of these channels (none named: of all), a stretch of the file at a time: {name: messages}. Within a
        channel the keys rise; a message's time lies at most `lateness` [ns] before that of any stretch before it."""
        tables = list(self.tables.items())
        if not self._stopper.alive:
            self._start()
        with contextlib.suppress(BrokenPipeError):  # what follows says so
            self._process.stdin.write(" ".join(names or self.tables).encode() + b"\n")
            self._process.stdin.flush()
        complete = False
        try:
            stretch = {}
            while True:
                number, rows = RECORD.unpack(self._read(RECORD.size))
                if number == END_OF_STRETCH:
                    yield stretch
                    stretch = {}
                elif number == END_OF_ANSWER:
                    complete = True
                    return
                elif number == ERROR:
                    raise LogProblem(self._read(rows).decode(errors="replace"))
                else:
                    name, table = tables[number]
                    stretch[name] = np.frombuffer(self._read(rows * table.dtype.itemsize), table.dtype)
        finally:
            if not complete:
                self._stopper()

    def channel(self, name):
        """All of the channel's messages in the order of their sequence; LogProblem where the log has none."""
        if name not in self.tables:
            raise LogProblem(f"{self.path}: no usable {name} message in this log")
        if name not in self._whole:
            table = self.tables[name]
            whole, filled = np.empty(table.rows, table.dtype), 0
            for stretch in self.stretches(name):
                part = stretch[name]
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
