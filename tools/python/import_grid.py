"""The times of an import's rows, and the even grid of the log that is made of them."""

import numpy as np

from column_shelf import median_of_steps
from holes import LONGEST_STEP, is_hole
from import_table import CUT, WrongCells, check_numbers
from unit import SPELLINGS

UNEVEN = 0.25             # [periods] by which a row may miss the even grid
MOST_DENSE = 100          # [new rows per row] that resampling may make
SHORTEST_PERIOD = 1e-6    # [s] between two rows of a log, whose times are whole nanoseconds
NANOSECONDS = 1_000_000_000


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
    """Even times [ns]; `is_of_rows`: one for each row of the data. `absent`: rows that the data's own usual interval leaves room for and that are not there."""

    def __init__(self, first, period, count, is_of_rows, absent=0):
        self.first, self.period, self.count, self.is_of_rows, self.absent = float(first), period, count, is_of_rows, absent

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
    even, first_miss, absent = True, None, 0
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
            absent += int(np.maximum(np.round(steps / usual) - 1.0, 0.0).sum())
            if len(steps) and steps.max() > longest:
                longest, behind = steps.max(), max(begin - 1, 0) + int(np.argmax(steps))
        if is_hole(longest, usual):
            mapping.time.report("column", f"a gap of {longest:.6g} s behind {row(behind)}",
                                f"at most {LONGEST_STEP:g} usual intervals of {usual:.6g} s to bridge{CUT}")
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
    return Grid(first, period, count, even, absent)
