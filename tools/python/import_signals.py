"""What an import's columns give from instant to instant of the log: as they are, resampled, or a speed derived from a position."""

import bisect

import numpy as np

from import_grid import NANOSECONDS, even_grid, times
from import_map import FLAGS, fail_if_wrong
from import_table import CUT, check_numbers

POSITIONS = ("shaft_position", "slew_angle")
SPIKE = 20.0           # times the largest other second difference, chosen: motion spreads over several rows
FEWEST_ROWS = 20       # fewer tell no motion from a jump
FURTHEST = 8           # rows that are looked at: more than one jump puts off its neighbours


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


def unwrapped(column, period, shelf):
    """A column that begins anew after so much, as it would have gone on: no step is longer than half of that."""
    whole, last, turns = shelf.column(), None, 0.0
    for _, values in column.stretches():
        steps = np.diff(values, prepend=values[0] if last is None else last)
        all_turns = turns - np.cumsum(np.round(steps / period))
        whole.append(values + period * all_turns)
        last, turns = values[-1], all_turns[-1]
    return whole


def check_jumps(entry, column, row, is_even):
    """A complaint about the first row of a position from which it jumps: by a turn, as a single-turn encoder does, or, where the rows
    are even, to stay or there and back."""
    if column.rows < FEWEST_ROWS:
        return
    largest = []  # (how far a row is off its neighbours' mean, row) of the few that are furthest
    for begin, values in column.stretches(before=3):
        first = max(begin - 3, 0)
        steps = np.diff(values)
        if entry.turn:
            # One step unlike those to either side, by about a turn: no motion is as fast for one row alone.
            jumps = np.abs(steps[1:-1] - 0.5 * (steps[:-2] + steps[2:])) / abs(entry.turn)
            found = np.flatnonzero((jumps > 0.7) & (jumps < 1.3) & (np.maximum(np.abs(steps[:-2]), np.abs(steps[2:])) < 0.3 * abs(entry.turn)))
            if len(found):
                at = found[0] + 1
                entry.reader.report("column", f"a jump by {steps[at]:.6g}, about a turn, behind {row(first + at)} in column '{entry.column}'",
                                    "an angle that goes on; of an encoder that begins anew after each turn unwrap: {value: 360, unit: deg, source: ...}")
                return
        largest = furthest_rows(largest, values, first)
    jump = single_jump(largest)
    if not is_even or jump is None:
        return
    place, stays = jump
    entry.reader.report("column", between_neighbours(entry, column, place, row), "a position that goes on; it jumps there and stays, as of an encoder that slips or is set anew: cut the data there with rows: {first: ..., last: ...}" if stays
                        else f"a position that moves; this row jumps there and back{CUT}")


def check_spike(entry, column, row):
    """A complaint about one row of an acceleration that stands alone: what strikes a crane rings over several."""
    if column.rows < FEWEST_ROWS:
        return
    largest = []
    for begin, values in column.stretches(before=3):
        largest = furthest_rows(largest, values, max(begin - 3, 0))
    jump = single_jump(largest)
    if jump is None or jump[1]:
        return
    entry.reader.report("column", between_neighbours(entry, column, jump[0], row),
                        f"an acceleration of the crane; no other row is a {SPIKE:g}th as far off its neighbours{CUT}")


def between_neighbours(entry, column, place, row):
    """What stands in a row, and on either side of it, for complaints."""
    return f"{column[place]:.6g} in column '{entry.column}' at {row(place)}, between {column[place - 1]:.6g} and {column[place + 1]:.6g}"


def furthest_rows(largest, values, first):
    """The few rows that are furthest off their neighbours' mean, as (how far, row), with those of one more stretch that begins at row `first`."""
    off = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    return sorted(largest + [(float(off[at]), first + int(at) + 1) for at in np.argsort(off)[-FURTHEST:]])[-FURTHEST:]


def single_jump(largest):
    """The row at which a signal jumps as nowhere else, and whether it stays there; None where it does not."""
    most, place = largest[-1]
    # A row that is off its neighbours puts these off theirs: each by half as much where it alone is off, one of them by as much where the signal stays.
    other = max((off for off, at in largest if abs(at - place) > 1), default=0.0)
    if other <= 0.0 or most <= SPIKE * other:
        return None
    beside = max((off for off, at in largest if abs(at - place) == 1), default=0.0)
    return (min(at for off, at in largest if abs(at - place) <= 1 and off > 0.75 * most) + 1, True) if beside > 0.75 * most else (place, False)


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
    for entry in (entry for name in POSITIONS for entry in mapping.signals.get(name, []) if entry.unwrap is None):
        check_jumps(entry, table.columns[entry.column].numbers, row, grid.is_of_rows)
    for entry in (entry for name, entries in mapping.signals.items() if name.endswith("_acceleration") and grid.is_of_rows for entry in entries):
        check_spike(entry, table.columns[entry.column].numbers, row)
    fail_if_wrong(mapping)
    period = (grid[-1] / NANOSECONDS - grid[0] / NANOSECONDS) / (len(grid) - 1)
    remarks = []
    if not grid.is_of_rows:
        remarks.append(f"resampled ({mapping.resample}) from {len(seconds)} rows to {len(grid)} at {1 / period:.6g} Hz")
    if grid.absent:
        remarks.append(f"{grid.absent} rows are missing in the data and were made up from their neighbours, which a diagnosis takes for measured: "
                       "with rows: {first: ..., last: ...} a piece without them is cut out")
    signals = {}
    for name, entries in mapping.signals.items():
        signals[name] = []
        for group, entry in enumerate(entries):
            if entry.column is None:
                signals[name].append(DerivedSpeed(signals["shaft_position"][group], period, entry.derive, len(grid)))
                remarks.append(f"{entry.name} is derived from the position: {entry.derive}")
                continue
            numbers = table.columns[entry.column].numbers
            values_of = of_entry(entry, name, numbers if entry.unwrap is None else unwrapped(numbers, entry.unwrap, shelf))
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
