"""The columns that an import's map names, read a stretch at a time from CSV or Parquet and kept as numbers on disk, with the rows that
hold none."""

import csv
import io
import sys
from dataclasses import dataclass

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet

from import_map import fail_if_wrong
from input_map import nearest
from run_log import LogProblem

ROWS_AT_ONCE = 100_000    # that are read together
MOST_CELLS = 2_000_000    # of a CSV that are read together
MOST_COLUMNS = 10_000     # a recorder has hundreds of channels; rows and columns are taken for each other
LONGEST_HEADER = 2_000_000  # [characters] of a CSV's line of names
WORTH_TELLING = 50        # [MB] of data that take so long that a person wants to know
CUT = "; mend the row, or cut the data with rows: {first: ..., last: ...}"


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
            for batch in file.iter_batches(batch_size=ROWS_AT_ONCE, columns=columns):
                yield {name: batch.column(name).to_pandas() for name in batch.schema.names}
        return
    rows = min(max(MOST_CELLS // max(count, 1), 1000), ROWS_AT_ONCE)
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
