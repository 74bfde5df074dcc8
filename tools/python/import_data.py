"""Makes a log of the wire out of measured data, by a map that says what its columns mean (docs/import.md).

    slewlab import --map MAP.yaml FILE.csv|FILE.parquet [--out LOG.lcmlog]

Row k becomes ENCODER k, the TORQUE that answers it, SENSORS k where a sensor is mapped, and an OPERATOR message where
the operator's wish changes. Signals in the messages' units and axes:

    shaft angle or speed = sign * scale * (column - offset) * ratio, or / metres_per_radian of a linear axis
    motor torque         = sign * scale * (column - offset) / (ratio * motors), or * metres_per_radian

Of a plain axis (`machine: axis.yaml` in the map, docs/axis.md) ratio and travel are its file's, and a column says whether
it stands on the axis or on the shaft.

Sensors that are not mapped are NaN in SENSORS. The log appears when it is complete, or not at all. The data may be larger than
memory: they are read a stretch at a time, and what the map asks of them is kept as columns on disk until the log is written.
"""

import bisect
import csv
import hashlib
import io
import json
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet

import input_map
from arguments import ArgumentParser
from column_shelf import NoRoom, Shelf, median_of_steps
from event_rows import event_type, fill_heads
from input_map import InputProblems, is_scalar, nearest
from machine import read_axis
from run_log import LogProblem, message_types
from signals import measured, unit_of
from unit import SPELLINGS, factor_to_si, quantity_of, spellings_of
from whole_file import growing

FLAGS = ("emergency_stop", "enable", "brake")
DERIVATIVES = ("two_sample_mean", "central_difference", "backward_difference")
MOST_GROUPS = 8           # sim/model/crane_parameters.h
UNEVEN = 0.25             # [periods] by which a row may miss the even grid
LONGEST_GAP = 5.5         # [usual intervals] that interpolation may bridge
MOST_DENSE = 100          # [new rows per row] that resampling may make
SHORTEST_PERIOD = 1e-6    # [s] between two rows of a log, whose times are whole nanoseconds
ROWS_AT_ONCE = 20_000     # that are written together
NANOSECONDS = 1_000_000_000
MOST_CELLS = 2_000_000    # of a CSV that are read together
MOST_COLUMNS = 10_000     # a recorder has hundreds of channels; rows and columns are taken for each other
LONGEST_HEADER = 2_000_000  # [characters] of a CSV's line of names
WORTH_TELLING = 50        # [MB] of data that take so long that a person wants to know
ONE_OF_DERIVATIVES = f"a column with its unit, or {{derive: one of {', '.join(DERIVATIVES)}}}"


@dataclass
class Signal:
    name: str             # message field, and [group] where there are several
    column: str | None    # None: derived
    reader: object        # where it stands in the map, for complaints
    factor: float = 1.0   # of (column - offset), to the message's unit
    offset: float = 0.0   # in the column's unit
    derive: str | None = None
    inverted: bool = False
    unit: str = ""        # of the message's field


@dataclass
class ImportMap:
    path: Path
    reader: object
    lines: list           # problems
    separator: str
    decimal: str
    skip_lines: int
    first_row: int
    last_row: int | None
    time: object          # reader of the map's part
    time_column: str | None
    time_factor: float | None   # None: date and time
    origin: float | None        # [s]; None: first row
    period: float | None        # [s]; None: as the rows are
    resample: str | None
    signals: dict         # message field: list of Signal, one per group
    machine: object = None  # an axis; None: ratios stand in the map


ANGULAR_AND_LINEAR = {"position": ("angle", "length"), "speed": ("angular speed", "speed"), "torque": ("torque", "force")}
# Of what kind a signal is, and the message's field that says so.
FIELD_OF_KIND = {"position": ("ENCODER", "shaft_position"), "speed": ("ENCODER", "shaft_speed"), "torque": ("TORQUE", "motor_torque"),
                 "number": ("OPERATOR", "speed_request")}


def wire_unit(name, kind):
    return measured("SENSORS").get(name) or unit_of(*FIELD_OF_KIND[kind])


def axis_factor(reader, kind, unit, factor, machine):
    """The factor to the motor shaft of a column on the axis or on the shaft of a plain axis."""
    for key in ("ratio", "metres_per_radian"):
        if reader.has(key):
            reader.report(key, f"'{key}' beside a machine", "what the machine's file says; 'on: axis' for a column on the axis")
    angular, linear = ANGULAR_AND_LINEAR[kind]
    on_axis, on_shaft = (linear if machine.is_linear else angular), (linear if machine.is_shaft_linear else angular)
    place = reader.choice("on", ("axis", "shaft"))
    if factor is None:
        return None
    is_of_axis, is_of_shaft = (factor_to_si(quantity, unit) is not None for quantity in (on_axis, on_shaft))
    if place is None:
        if is_of_axis and is_of_shaft and machine.gear != 1.0:
            reader.report("on", "nothing", f"axis or shaft: {unit} may be either of the two, {machine.gear:.6g} apart")
            return None
        place = "axis" if is_of_axis else "shaft"
    if not (is_of_axis if place == "axis" else is_of_shaft):
        quantity = on_axis if place == "axis" else on_shaft
        reader.report("unit", f"{unit} on the {place}", f"a unit of {quantity}: {spellings_of(quantity)}")
        return None
    gear = machine.gear if place == "axis" else 1.0
    return factor / gear if kind == "torque" else factor * gear


def read_signal(reader, name, kind, machine=None):
    """One signal of the map: column, unit and what leads from the column to the message."""
    column = reader.text("column", "the name of a column of the data")
    found = Signal(name, column, reader)
    sign = reader.choice("sign", ("1", "+1", "-1"), "1")
    if kind == "flag":
        found.inverted = reader.flag("inverted")
        reader.finish()
        return found
    unit = reader.text("unit", "the column's unit")
    scale = reader.number("scale", "number", 1.0)
    found.offset = 0.0
    angular, linear = ANGULAR_AND_LINEAR.get(kind, (kind, None))
    if machine and name == "load_position" and machine.is_linear:
        angular = "length"
    factor = reader.factor(unit, angular, linear) if linear else reader.factor(unit, angular)
    if reader.has("offset"):
        offset = reader.number("offset", quantity_of(unit or "-") or "number", 0.0, positive=False)
        found.offset = offset / (factor or 1.0)
    is_linear = linear is not None and factor is not None and factor_to_si(linear, unit) is not None
    if machine and linear:
        factor = axis_factor(reader, kind, unit, factor, machine)
        motors = reader.integer("motors", 1, 1) if kind == "torque" else 1
        factor = None if factor is None else factor / motors
    elif linear:
        travel = reader.number("metres_per_radian", "length", None)
        ratio = reader.number("ratio", "number", None)
        if is_linear and travel is None and not reader.has("metres_per_radian"):
            reader.report("metres_per_radian", f"nothing, beside a column in {unit}",
                          "the axis's travel per radian of the motor shaft: {value: 0.01, unit: m, source: ...}")
        if is_linear and reader.has("ratio"):
            reader.report("ratio", f"a gear ratio beside a column in {unit}", "metres_per_radian alone on a linear axis")
        if not is_linear and factor is not None and reader.has("metres_per_radian"):
            reader.report("metres_per_radian", f"a travel per radian beside a column in {unit}",
                          f"a column in a unit of {linear}: {spellings_of(linear)}")
        gear = 1.0 / (travel or 1.0) if is_linear else (ratio or 1.0)
        motors = reader.integer("motors", 1, 1) if kind == "torque" else 1
        factor = None if factor is None else (factor / (gear * motors) if kind == "torque" else factor * gear)
    elif kind == "angle" and not machine:
        factor = None if factor is None else factor * reader.number("ratio", "number", 1.0)
    found.factor = (factor or 1.0) * scale * (-1.0 if sign == "-1" else 1.0)
    of_axis = machine.units() if machine else {}
    found.unit = of_axis.get("slew_angle" if name == "load_position" else name) or wire_unit(name, kind)
    reader.finish()
    return found


def read_map(path):
    if not path.is_file():
        raise InputProblems([f"{path}: there is no such map"])
    root, lines = input_map.load(path)
    machine = machine_named(root)
    return read_root(root, lines, path, None if machine is None else read_axis(path.parent / machine))


def machine_named(root):
    return root.text("machine", "the axis's file") if root.has("machine") else None


def read_root(root, lines, path, machine):
    """The map below its root; `machine` is the axis that it names. map_schema asks it for its keys."""
    kind = root.text("kind", "import_map")
    if kind not in (None, "import_map"):
        root.report("kind", kind, "import_map")
    root.has("description")

    table = root.map("csv", "") if root.has("csv") else None
    separator = table.choice("separator", (",", ";", "tab"), ",") if table else ","
    decimal = table.choice("decimal", (".", ","), ".") if table else "."
    skip_lines = table.integer("skip_lines", 0, 0) if table else 0
    if table:
        table.finish()
    rows = root.map("rows", "") if root.has("rows") else None
    first_row = rows.integer("first", 1, 1) if rows else 1
    last_row = rows.integer("last", 1, None) if rows else None
    if rows:
        if last_row is not None and last_row < first_row + 2:
            rows.report("last", str(last_row), f"at least {first_row + 2}, three rows from rows.first on")
        rows.finish()

    time = root.map("time", "{column: NAME, unit: one of s, ms, us, min, h, datetime}: the times of the rows")
    time_column = time_factor = origin = None
    if time:
        time_column = time.text("column", "the name of the column that holds the time")
        unit = time.text("unit", f"one of {spellings_of('time')}, datetime")
        if unit != "datetime":
            time_factor = time.factor(unit, "time")
        if time.has("origin") and not time.says("origin", "first_row"):
            origin = time.number("origin", "time", None, positive=False)
        time.finish()
    rate = root.number("rate", "frequency", None)
    resample = root.choice("resample", ("linear", "mean"))

    signals = {}
    for name, signal_kind in (("shaft_position", "position"), ("shaft_speed", "speed"), ("motor_torque", "torque")):
        expected = "a list with one entry per motor group, each with column and unit"
        if name == "shaft_speed":
            expected = f"a list with one entry per motor group, each with {ONE_OF_DERIVATIVES}"
        signals[name] = []
        for reader in root.maps(name, expected):
            if name == "shaft_speed" and reader.has("derive"):
                derive = reader.choice("derive", DERIVATIVES)
                if reader.has("column"):
                    reader.report("column", "a column beside derive", "one of the two")
                reader.finish()
                unit = machine.units()[name] if machine else wire_unit(name, signal_kind)
                signals[name].append(Signal(name, None, reader, derive=derive, unit=unit))
            else:
                signals[name].append(read_signal(reader, name, signal_kind, machine))
    for name, unit in () if machine else measured("SENSORS").items():
        if root.has(name):
            signals[name] = [read_signal(root.map(name, ""), name, quantity_of(unit))]
    if machine and root.has("load_position"):
        if not machine.has_load_encoder:
            root.report("load_position", "a load-side encoder", "load_encoder: {value: true, source: ...} in the machine's file")
        signals["slew_angle"] = [read_signal(root.map("load_position", ""), "load_position", "angle", machine)]
    if root.has("speed_request"):
        signals["speed_request"] = [read_signal(root.map("speed_request", ""), "speed_request", "number")]
    for name in FLAGS:
        if root.has(name):
            signals[name] = [read_signal(root.map(name, ""), name, "flag")]
    root.finish()

    groups = len(signals["shaft_position"])
    if machine and groups > 1:
        root.report("shaft_position", f"{groups} groups", "one: the motor of the axis")
    if groups > MOST_GROUPS:
        root.report("shaft_position", f"{groups} groups", f"at most {MOST_GROUPS}")
    for name in ("shaft_speed", "motor_torque"):
        count = len(signals[name])
        if count and groups and count != groups:
            root.report(name, f"{count} groups", f"{groups}, as many as shaft_position has")
    for name in ("shaft_position", "shaft_speed", "motor_torque"):
        for group, entry in enumerate(signals[name]):
            entry.name = f"{name}[{group + 1}]"
    used = {time_column: "time"}
    for entry in (e for entries in signals.values() for e in entries if e.column is not None):
        if entry.column in used:
            entry.reader.report("column", f"'{entry.column}', which is {used[entry.column]} already",
                                "a column of its own for each signal")
        used[entry.column] = entry.name
    return ImportMap(path, root, lines, separator, decimal, skip_lines, first_row, last_row, time, time_column,
                     time_factor, origin, None if rate is None else 1.0 / rate, resample, signals, machine)


def fail_if_wrong(mapping):
    if mapping.lines:
        raise InputProblems(mapping.lines)


def column_names(mapping, path):
    if path.suffix == ".parquet":
        return pyarrow.parquet.read_schema(path).names
    with open(path, newline="", encoding="utf-8-sig") as stream:
        for _ in range(mapping.skip_lines):
            stream.readline()
        header = stream.readline(LONGEST_HEADER)
        while header.count('"') % 2 and len(header) < LONGEST_HEADER:  # a name with a line break in it
            more = stream.readline(LONGEST_HEADER)
            if not more:
                break
            header += more
        if len(header) >= LONGEST_HEADER:
            raise LogProblem(f"{path}: the line of column names has more than {LONGEST_HEADER} characters; expected one "
                             f"row per moment and at most {MOST_COLUMNS} columns")
    separator = "\t" if mapping.separator == "tab" else mapping.separator
    header = next(csv.reader(io.StringIO(header, newline=""), delimiter=separator), [])
    return [name.strip() for name in header]


def check_columns(mapping, path):
    """How many columns the file has; complaints about those that the map names and that are not there stand at the map's lines."""
    if path.suffix not in (".csv", ".parquet"):
        raise LogProblem(f"{path}: found '{path.suffix}', expected a file that ends in .csv or .parquet")
    if not path.is_file():
        raise LogProblem(f"{path}: there is no such file")
    names = column_names(mapping, path)
    if len(names) > MOST_COLUMNS:
        raise LogProblem(f"{path}: found {len(names)} columns, expected one row per moment and at most {MOST_COLUMNS} "
                         f"columns; turn the table, or cut it to the columns that the map names")
    megabytes = path.stat().st_size / 1e6
    if megabytes > WORTH_TELLING:
        print(f"reading {path}: {megabytes:.0f} MB with {len(names)} columns", file=sys.stderr, flush=True)
    wanted = [(mapping.time, mapping.time_column)]
    wanted += [(e.reader, e.column) for entries in mapping.signals.values() for e in entries if e.column is not None]
    for reader, column in wanted:
        if names.count(column) == 0:
            reader.report("column", f"'{column}', which {path.name} does not have", nearest(column, names))
        elif names.count(column) > 1:
            reader.report("column", f"'{column}', which {path.name} has {names.count(column)} times",
                          "a column whose name stands once in the data")
    fail_if_wrong(mapping)
    return len(names)


def pieces_of(mapping, path, columns, count):
    """The data a stretch at a time, {name: series}, from a file of `count` columns."""
    if path.suffix == ".parquet":
        with pyarrow.parquet.ParquetFile(path, pre_buffer=False) as file:  # which holds the file
            for batch in file.iter_batches(batch_size=5 * ROWS_AT_ONCE, columns=columns):
                yield {name: batch.column(name).to_pandas() for name in batch.schema.names}
        return
    rows = min(max(MOST_CELLS // max(count, 1), 1000), 5 * ROWS_AT_ONCE)
    for piece in pd.read_csv(path, sep="\t" if mapping.separator == "tab" else mapping.separator,
                             decimal=mapping.decimal, skiprows=mapping.skip_lines, skipinitialspace=True,
                             encoding="utf-8-sig", low_memory=False, chunksize=rows,
                             skip_blank_lines=False, index_col=False):
        piece.columns = [str(name).strip() for name in piece.columns]
        yield {name: piece[name] for name in columns}


@dataclass
class WrongCells:
    """The first row of a column that does not hold what it should, what it holds, and how many such rows there are."""

    row: int | None = None
    found: object = None
    count: int = 0

    def add(self, wrong, begin, series=None):
        count = int(np.count_nonzero(wrong))
        if count and self.row is None:
            at = int(np.argmax(wrong))
            self.row, self.found = begin + at, None if series is None else series.iloc[at]
        self.count += count


class NumberColumn:
    """A column of the data as numbers."""

    def __init__(self, shelf):
        self.numbers, self.wrong = shelf.column(), WrongCells()

    def add(self, series):
        values = numbers(series)
        self.wrong.add(~np.isfinite(values), len(self.numbers), series)
        self.numbers.append(values)


class DateColumn:
    """A column of dates and times as nanoseconds."""

    def __init__(self, shelf):
        self.numbers, self.wrong, self.first = shelf.column(np.int64), WrongCells(), None

    def add(self, series):
        if len(series) == 0:
            return
        if self.first is None:
            self.first = series.iloc[:1]
        # All are written as the first is.
        stamps = pd.to_datetime(pd.concat([self.first, series]) if is_text(series) and is_text(self.first) else series, errors="coerce", utc=True)
        stamps = stamps.iloc[len(stamps) - len(series):]
        self.wrong.add(stamps.isna().to_numpy(), len(self.numbers), series)
        self.numbers.append(stamps.astype("datetime64[ns, UTC]").astype("int64").to_numpy())


def is_text(series):
    return not (pd.api.types.is_numeric_dtype(series.dtype) or pd.api.types.is_datetime64_any_dtype(series.dtype))


def numbers(series):
    if pd.api.types.is_bool_dtype(series.dtype):
        return series.to_numpy(float)
    return pd.to_numeric(series, errors="coerce").to_numpy(float, na_value=np.nan)


@dataclass
class Table:
    columns: dict                     # name: NumberColumn, DateColumn
    has_dates_for_numbers: bool = False  # the column of times holds dates, and the map says a unit of time


def read_table(mapping, path, shelf):
    """The columns that the map names, of the rows that it asks for."""
    try:
        count = check_columns(mapping, path)
        names = dict.fromkeys([mapping.time_column, *(e.column for entries in mapping.signals.values() for e in entries if e.column is not None)])
        table = Table({name: NumberColumn(shelf) for name in names})
        if mapping.time_factor is None:
            table.columns[mapping.time_column] = DateColumn(shelf)
        first, last, seen = mapping.first_row - 1, mapping.last_row, 0
        for piece in pieces_of(mapping, path, list(names), count):
            table.has_dates_for_numbers |= mapping.time_factor is not None and pd.api.types.is_datetime64_any_dtype(piece[mapping.time_column].dtype)
            for name, series in piece.items():
                table.columns[name].add(series.iloc[max(first - seen, 0):None if last is None else max(last - seen, 0)])
            seen += len(piece[mapping.time_column])
    except (OSError, pyarrow.ArrowException, pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError,
            csv.Error) as error:
        raise LogProblem(f"{path}: not readable as {path.suffix[1:]}: {error}") from error
    if last is not None and last > seen:
        mapping.reader.report("rows", f"last: {last}", f"at most {seen}, the rows of {path.name}")
        fail_if_wrong(mapping)
    return table


class Rows:
    """Names rows as a person finds them: counted from 1 in the data, and the line of a CSV file."""

    def __init__(self, mapping, path):
        self.first, self.skip, self.is_csv = mapping.first_row, mapping.skip_lines, path.suffix == ".csv"

    def __call__(self, index):
        row = self.first + int(index)
        return f"data row {row}" + (f" (line {row + 1 + self.skip})" if self.is_csv else "")


CUT = "; mend the row, or cut the data with rows: {first: ..., last: ...}"


def check_numbers(wrong, name, reader, row):
    """A complaint that names the first row that holds no number."""
    if wrong.row is None:
        return
    text = "no number (NaN or an empty cell)" if pd.isna(wrong.found) else f"'{wrong.found}'"
    more = f", and in {wrong.count - 1} more rows" if wrong.count > 1 else ""
    hint = ""
    if isinstance(wrong.found, str) and "," in wrong.found:
        hint = "; numbers with a comma want csv: {decimal: \",\"}"
    reader.report("column", f"{text} in column '{name}' at {row(wrong.row)}{more}",
                  f"a finite number in every row{CUT}{hint}")


def times(mapping, table, row, shelf):
    """[s] of each row behind the origin, rising, on disk."""
    column = table.columns[mapping.time_column]
    raw = column.numbers
    if len(raw) < 3:
        mapping.time.report("column", f"{len(raw)} rows", "at least 3")
        return None
    if mapping.time_factor is None and column.wrong.row is not None:
        mapping.time.report("column", f"'{column.wrong.found}' at {row(column.wrong.row)}",
                            "a date and time such as 2026-11-21T02:00:00.001" + CUT)
        return None
    if table.has_dates_for_numbers:
        mapping.time.report("unit", "a unit of time for a column of dates", "datetime")
        return None
    if column.wrong.row is not None:
        check_numbers(column.wrong, mapping.time_column, mapping.time, row)
        return None
    first = raw[0]
    seconds, stands = shelf.column(), WrongCells()
    for _, values in raw.stretches():
        if mapping.time_factor is None:
            seconds.append((values - first) / 1e9 + (0.0 if mapping.origin is None else first / 1e9 - mapping.origin))
        else:
            origin = first if mapping.origin is None else mapping.origin / mapping.time_factor
            seconds.append((values - origin) * mapping.time_factor)
    for begin, values in seconds.stretches(before=1):
        stands.add(values[1:] <= values[:-1], max(begin, 1))
    if stands.row is not None:
        at = stands.row
        mapping.time.report(
            "column", f"{raw[at]} at {row(at)} after {raw[at - 1]} in the row before, "
            f"{stands.count} such rows in all", f"times that rise from row to row{CUT}")
        return None
    if seconds[0] < 0.0:
        mapping.time.report("origin", f"{row(0)} at {seconds[0]:.6g} s, before the origin",
                            "an origin that is not later than the first row")
        return None
    return seconds


def fitting_units(mapping, usual):
    """What unit of the time column would agree with the rate, in words."""
    if mapping.time_factor is None:
        return ""
    raw = usual / mapping.time_factor
    fits = [u for u, f in SPELLINGS["time"].items() if abs(raw * f / mapping.period - 1.0) < 0.05]
    return f"; with time in {fits[0]} it would be that rate" if fits else ""


class Grid:
    """Even times [ns]; `is_of_rows`: one for each row of the data."""

    def __init__(self, first, period, count, is_of_rows):
        self.first, self.period, self.count, self.is_of_rows = float(first), period, count, is_of_rows

    def __len__(self):
        return self.count

    def __getitem__(self, place):
        if isinstance(place, slice):
            return self.at(np.arange(*place.indices(self.count)))
        return self.at(np.array([place % self.count]))[0]

    def at(self, k):
        return np.round(self.first * NANOSECONDS + k * (self.period * NANOSECONDS)).astype(np.int64)


def even_grid(mapping, seconds, row):
    """None after a complaint."""
    count = len(seconds)
    first, last = seconds[0], seconds[-1]
    usual = median_of_steps(seconds)
    period = mapping.period or float((last - first) / (count - 1))
    even, first_miss = True, None
    for begin, values in seconds.stretches():
        misses = np.abs(values - first - period * np.arange(begin, begin + len(values)))
        even = even and bool((misses <= UNEVEN * period).all())
        if first_miss is None and (misses > UNEVEN * period).any():
            first_miss = begin + int(np.argmax(misses > UNEVEN * period))
    if not even and mapping.resample is None:
        if mapping.period and abs(usual / period - 1.0) > UNEVEN:
            mapping.reader.report(
                "rate", f"rows {usual * 1e3:.6g} ms apart, {1 / usual:.6g} Hz{fitting_units(mapping, usual)}",
                f"the {1 / period:.6g} Hz of rate; correct rate or the time's unit, or set resample: linear or mean")
            return None
        wrong = WrongCells()
        for begin, values in seconds.stretches(before=1):
            wrong.add(np.abs(np.diff(values) - usual) > UNEVEN * usual, max(begin - 1, 0))
        at = (first_miss or 0) - 1 if wrong.row is None else wrong.row
        step = seconds[at + 1] - seconds[at]
        said = f"{step * 1e3:.6g} ms between {row(at)} and the next where {usual * 1e3:.6g} ms is usual"
        if wrong.row is None:
            mean = (last - first) / (count - 1)
            said = f"a mean rate of {1 / mean:.9g} Hz, by which {row(first_miss or 0)} has left the grid of {1 / period:.9g} Hz"
        mapping.time.report(
            "column", f"{said} ({wrong.count} uneven intervals)",
            "even times; with resample: linear (or mean) at the root of the map they are made so, with "
            "rows: {first: ..., last: ...} a piece is cut out")
        return None
    if not even:
        period = mapping.period or round(usual, 9)
        if period * MOST_DENSE < usual:
            mapping.reader.report("rate", f"{1 / period:.6g} Hz for rows that come at {1 / usual:.6g} Hz",
                                  f"at most {MOST_DENSE} times the rate of the rows")
            return None
        count = int(np.floor((last - first) / period + 1e-6)) + 1
        longest, behind = 0.0, 0
        for begin, values in seconds.stretches(before=1):
            steps = np.diff(values)
            if len(steps) and steps.max() > longest:
                longest, behind = steps.max(), max(begin - 1, 0) + int(np.argmax(steps))
        if longest > LONGEST_GAP * usual:
            mapping.time.report("column", f"a gap of {longest:.6g} s behind {row(behind)}",
                                f"at most {LONGEST_GAP:g} usual intervals of {usual:.6g} s to bridge{CUT}")
            return None
        if mapping.resample == "linear" and period > 2.0 * usual:
            mapping.reader.report(
                "resample", f"linear from {1 / usual:.6g} Hz to {1 / period:.6g} Hz, which folds what is faster "
                "than half the new rate into the signals", "mean, which averages over each new period")
            return None
        if count < 3:
            mapping.reader.report("rate", f"{1 / period:.6g} Hz, of which the rows cover {count} instants", "a rate at which they cover at least 3")
            return None
    if period < SHORTEST_PERIOD:
        mapping.time.report("unit", f"rows {period:.6g} s apart", f"rows at least {SHORTEST_PERIOD:g} s apart")
        return None
    return Grid(first, period, count, even)


def integral_of(values_of, seconds, holds, shelf):
    """Of a column from the first row on, at every row; `values_of(begin, end)` gives the column."""
    integral, sum_so_far = shelf.column(), 0.0
    integral.append(np.zeros(1))
    for begin, at in seconds.stretches(before=1):
        values = values_of(max(begin - 1, 0), begin - 1 + len(at) + (begin == 0))
        between = values[:-1] if holds else 0.5 * (values[:-1] + values[1:])
        sums = np.cumsum(np.concatenate(([sum_so_far], between * np.diff(at))))
        integral.append(sums[1:])
        sum_so_far = sums[-1]
    return integral


class Resampled:
    """A column on a grid that its rows do not lie on. `holds`: a command that keeps its value until the next row; else a quantity
    that passes between rows."""

    def __init__(self, values_of, seconds, grid, how, holds, shelf):
        self.values_of, self.seconds, self.grid, self.how, self.holds = values_of, seconds, grid, how, holds
        self.ends = seconds[0], seconds[-1]
        self.period = (grid[-1] / NANOSECONDS - grid[0] / NANOSECONDS) / (len(grid) - 1)
        self.integral = integral_of(values_of, seconds, holds, shelf) if how == "mean" else None

    def __call__(self, begin, end):
        grid, period = self.grid[begin:end] / NANOSECONDS, self.period
        # Rows around the piece, one more at either side.
        low = max(bisect.bisect_right(self.seconds, grid[0] - period) - 2, 0)
        high = bisect.bisect_right(self.seconds, grid[-1] + 2.0 * period) + 2
        seconds, values = self.seconds.read(low, high), self.values_of(low, high)
        if self.how == "linear":
            if self.holds:
                return values[np.clip(np.searchsorted(seconds, grid + 1e-9, side="right") - 1, 0, None)]
            return np.interp(grid, seconds, values)
        integral = self.integral.read(low, high)

        def area(at):
            if self.holds:
                return np.interp(at, seconds, integral)
            k = np.clip(np.searchsorted(seconds, at, side="right") - 1, 0, len(seconds) - 2)
            into = at - seconds[k]
            slope = (values[k + 1] - values[k]) / (seconds[k + 1] - seconds[k])
            return integral[k] + into * (values[k] + 0.5 * slope * into)

        # A command is averaged over the period in which it holds, a measured quantity around its instant.
        start = np.clip(grid if self.holds else grid - 0.5 * period, *self.ends)
        stop = np.clip(grid + (period if self.holds else 0.5 * period), *self.ends)
        mean = np.interp(grid, seconds, values)
        long = stop - start > 1e-9 * period
        mean[long] = (area(stop[long]) - area(start[long])) / (stop[long] - start[long])
        return mean


class DerivedSpeed:
    """[rad/s] from positions on an even grid of `count` instants. Where the formula would reach beyond the ends: its nearest value."""

    def __init__(self, position_of, period, how, count):
        self.position_of, self.period, self.how, self.count = position_of, period, how, count

    def __call__(self, begin, end):
        low = max(begin - 2, 0)
        x, k = self.position_of(low, min(end + 2, self.count)), np.arange(begin, end)
        if self.how == "central_difference":  # (x[k+1] - x[k-1]) / 2T: of the row's own instant
            k = np.clip(k, 1, self.count - 2) - low
            return (x[k + 1] - x[k - 1]) / (2.0 * self.period)
        if self.how == "two_sample_mean":     # mean of two samples, differentiated: (x[k] - x[k-2]) / 2T, late by T
            k = np.clip(k, 2, self.count - 1) - low
            return (x[k] - x[k - 2]) / (2.0 * self.period)
        k = np.clip(k, 1, self.count - 1) - low  # (x[k] - x[k-1]) / T: late by T/2
        return (x[k] - x[k - 1]) / self.period


def of_entry(entry, name, column):
    """What a map's entry makes of its column: rows `begin` to `end`."""
    def values_of(begin, end):
        values = column.read(begin, end)
        return (values != 0.0) != entry.inverted if name in FLAGS else (values - entry.offset) * entry.factor

    return values_of


def shifted(values_of, start):
    return lambda begin, end: values_of(begin, end) - start


def convert(mapping, table, row, shelf):
    """Grid of times, signals by message field (for each group, what gives its values from instant to instant), and remarks."""
    for entries in mapping.signals.values():
        for entry in entries:
            if entry.column is not None:
                check_numbers(table.columns[entry.column].wrong, entry.column, entry.reader, row)
    seconds = times(mapping, table, row, shelf)
    grid = even_grid(mapping, seconds, row) if seconds is not None else None
    fail_if_wrong(mapping)
    period = (grid[-1] / NANOSECONDS - grid[0] / NANOSECONDS) / (len(grid) - 1)
    remarks = []
    if not grid.is_of_rows:
        remarks.append(f"resampled ({mapping.resample}) from {len(seconds)} rows to {len(grid)} at {1 / period:.6g} Hz")
    signals = {}
    for name, entries in mapping.signals.items():
        signals[name] = []
        for group, entry in enumerate(entries):
            if entry.column is None:
                signals[name].append(DerivedSpeed(signals["shaft_position"][group], period, entry.derive, len(grid)))
                remarks.append(f"{entry.name} is derived from the position: {entry.derive}")
                continue
            values_of = of_entry(entry, name, table.columns[entry.column].numbers)
            if not grid.is_of_rows:
                holds = name in FLAGS or name in ("motor_torque", "speed_request")
                how = "linear" if name in FLAGS else mapping.resample
                values_of = Resampled(values_of, seconds, grid, how, holds, shelf)
            if name == "shaft_position":
                # A crane's angle counts from the start; what stands between its groups is kept, and so is an axis's own zero.
                if group == 0:
                    start = 0.0 if mapping.machine else values_of(0, 1)[0]
                    if start != 0.0:
                        remarks.append(f"{entry.name} begins at {start:.6g} rad in the data and at 0 in the log")
                values_of = shifted(values_of, start)
            signals[name].append(values_of)
    return grid, signals, remarks


class Ranges:
    """Smallest and largest value of each signal while they go by, and where a request is largest."""

    def __init__(self):
        self.of, self.largest_request, self.at = {}, 0.0, 0

    def add(self, begin, values):
        for name, groups in values.items():
            for group, series in enumerate(groups):
                low, high = self.of.get((name, group), (np.inf, -np.inf))
                self.of[name, group] = min(low, float(np.min(series))), max(high, float(np.max(series)))
        if "speed_request" in values:
            request = np.abs(values["speed_request"][0])
            if request.max() > self.largest_request:
                self.largest_request, self.at = request.max(), begin + int(np.argmax(request))

    def check_request(self, mapping, row):
        if self.largest_request > 1.0 + 1e-9:
            mapping.signals["speed_request"][0].reader.report(
                "column", f"a request of {self.largest_request:.6g}, largest at {row(self.at)}",
                "shares of the top speed from -1 to 1; unit: \"%\" or a scale would make it so")
            fail_if_wrong(mapping)


def configuration_hash(text):
    """FNV-1a, 64 bits, as msgs/configuration_hash.h has it."""
    value = 0xCBF29CE484222325
    for byte in text.encode():
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value - (1 << 64) if value >= 1 << 63 else value


def identity_of(path):
    """What the file holds, as a run's identity: the log of other data is another run, and 0 is nobody's."""
    with open(path, "rb") as stream:
        digest = hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=8)).digest()
    return int.from_bytes(digest, "big", signed=True) or 1


def write_log(out, grid, signals, ranges, hash_of_map, identity):
    """All messages in the order in which a lockstep run writes them; returns counts by channel."""
    types = message_types()
    groups = {"group_count": len(signals["shaft_position"])}
    sensors = [name for name in measured("SENSORS") if name in signals]
    # What a row makes: ENCODER, the TORQUE that answers it, and SENSORS; an OPERATOR in front where the wish changes.
    parts = [("ENCODER", types.encoder_t, groups), ("TORQUE", types.torque_t, groups)]
    parts += [("SENSORS", types.sensors_t, None)] if sensors else []
    row_type = np.dtype([(channel, event_type(channel, kind, counts)) for channel, kind, counts in parts])
    move_type = event_type("OPERATOR", types.operator_t)
    written, moved, wish = 0, 0, None
    with open(out, "wb") as stream:
        for begin in range(0, len(grid), ROWS_AT_ONCE):
            times = grid[begin:begin + ROWS_AT_ONCE]
            k = begin + np.arange(len(times))
            values = {name: [values_of(begin, begin + len(times)) for values_of in entries] for name, entries in signals.items()}
            ranges.add(begin, values)

            def given(name, otherwise, group=0):
                return values[name][group] if name in values else np.full(len(times), otherwise)

            requests, stops = given("speed_request", 0.0), given("emergency_stop", False)
            before = wish or (np.nan, False)
            changed = (requests != np.append(before[0], requests[:-1])) | (stops != np.append(before[1], stops[:-1]))
            wish = requests[-1], stops[-1]
            moves_so_far = moved + np.cumsum(changed)
            first_numbers = written + len(parts) * np.arange(len(times)) + np.cumsum(changed)

            rows = np.zeros(len(times), row_type)
            for place, (channel, kind, counts) in enumerate(parts):
                fill_heads(rows[channel], channel, kind, first_numbers + place, times, counts)
                rows[channel]["sequence"], rows[channel]["configuration_hash"], rows[channel]["run_identity"] = k, hash_of_map, identity
            rows["ENCODER"]["operator_sequence"] = moves_so_far - 1
            rows["TORQUE"]["answered_sequence"], rows["TORQUE"]["alive_counter"] = k, k + 1
            rows["TORQUE"]["enable"], rows["TORQUE"]["brake"] = given("enable", True), given("brake", False)
            for group in range(groups["group_count"]):
                for name, channel in (("shaft_position", "ENCODER"), ("shaft_speed", "ENCODER"), ("motor_torque", "TORQUE")):
                    rows[channel][name][:, group] = given(name, 0.0, group)
            for name in measured("SENSORS") if sensors else ():
                rows["SENSORS"][name] = given(name, np.nan)

            at = np.flatnonzero(changed)
            moves = np.zeros(len(at), move_type)
            fill_heads(moves, "OPERATOR", types.operator_t, first_numbers[at] - 1, times[at])
            moves["sequence"], moves["configuration_hash"], moves["run_identity"] = moves_so_far[at] - 1, hash_of_map, identity
            moves["speed_request"], moves["emergency_stop"] = requests[at], stops[at]
            for number, (start, end) in enumerate(zip(np.append(0, at), np.append(at, len(rows)))):
                stream.write(rows[start:end].tobytes())
                if number < len(at):
                    stream.write(moves[number].tobytes())
            moved += len(at)
            written += len(parts) * len(rows) + len(at)
    counts = {"ENCODER": len(grid), "TORQUE": len(grid), "OPERATOR": moved}
    return counts | ({"SENSORS": len(grid)} if sensors else {})


def canonical(node):
    """What of the map decides about the log, keys sorted."""
    if is_scalar(node):
        return node.scalar
    if node.kind == "sequence":
        return [canonical(item) for item in node.items]
    return {key: canonical(value) for key, _, _, value in node.entries if key not in ("source", "description")}


def main(arguments=None):
    parser = ArgumentParser(prog="slewlab import", description="Measured data into a log of the wire.")
    parser.add_argument("file", type=Path, help="CSV with a line of column names, or Parquet")
    parser.add_argument("--map", type=Path, required=True, help="what the columns mean (docs/import.md)")
    parser.add_argument("--out", type=Path, help="default: the file's name with .lcmlog")
    options = parser.parse_args(arguments)
    out = options.out or options.file.with_suffix(".lcmlog")
    try:
        mapping = read_map(options.map)
        fail_if_wrong(mapping)
        if out.suffix != ".lcmlog":
            raise LogProblem(f"--out: found {out}, expected a name that ends in .lcmlog")
        folder = next(parent for parent in out.absolute().parents if parent.is_dir())  # beside the log: as large as it
        row = Rows(mapping, options.file)
        text = json.dumps(canonical(mapping.reader.node), sort_keys=True) + options.file.name + (str(mapping.machine) if mapping.machine else "")
        ranges = Ranges()
        with Shelf(folder) as shelf:
            grid, signals, remarks = convert(mapping, read_table(mapping, options.file, shelf), row, shelf)
            with growing(out) as partial:
                counts = write_log(partial, grid, signals, ranges, configuration_hash(text), identity_of(options.file))
                ranges.check_request(mapping, row)
    except InputProblems as problems:
        print(problems, file=sys.stderr)
        return 2
    except NoRoom as problem:
        print(f"import: cannot write {out}: {problem}", file=sys.stderr)
        return 1
    except (LogProblem, OSError) as problem:
        print(f"import: {problem}", file=sys.stderr)
        return 1
    for remark in remarks:
        print(remark)
    for name, entries in mapping.signals.items():
        for group, entry in enumerate(entries):
            unit = f" {entry.unit}" if entry.unit not in ("", "-") else ""
            low, high = ranges.of[name, group]
            print(f"{entry.name}: {low:.6g} ... {high:.6g}{unit}")
    said = ", ".join(f"{name} {count}" for name, count in counts.items())
    print(f"{out}: {(grid[-1] - grid[0]) / NANOSECONDS:.6g} s, {said}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
