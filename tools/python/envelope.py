"""A long series as a picture needs it: no more samples than a screen can show, and no peak lost. Of each bin of time the
first, the lowest, the highest and the last sample stay, at their own times; a short series stays as it is."""

import numpy as np

BINS = 2000         # [-] of a long series; a screen has hardly more columns
MOST_POINTS = 8000  # [-] that are drawn of one series


class Envelope:
    """Takes a series of `count` samples between `first` and `last` piece by piece, in memory that does not grow with it."""

    def __init__(self, first, last, count):
        self.is_short = count <= MOST_POINTS
        self.first, self.width = first, (last - first) / BINS or 1.0
        self.pieces = []
        # By bin: time and value of first, lowest, highest and last sample; NaN where there is none.
        self.times, self.values = np.full((4, BINS), np.nan), np.full((4, BINS), np.nan)

    def add(self, time, value):
        value = np.asarray(value, float)
        if self.is_short:
            self.pieces.append((time, value))
            return
        known = np.isfinite(value)
        if not known.all():
            time, value = time[known], value[known]
        if len(time) == 0:
            return
        bins = np.clip((time - self.first) / self.width, 0, BINS - 1).astype(int)
        if np.any(bins[1:] < bins[:-1]):  # a clock that was set
            order = np.argsort(bins, kind="stable")
            time, value, bins = time[order], value[order], bins[order]
        begins = np.flatnonzero(np.diff(bins, prepend=-1))
        ends = np.append(begins[1:], len(bins))
        which = bins[begins]
        self._keep(0, which, time[begins], value[begins], lambda new, old: False)
        for row, reduce, beats in ((1, np.minimum, np.less), (2, np.maximum, np.greater)):
            best = reduce.reduceat(value, begins)
            hits = np.flatnonzero(value == np.repeat(best, ends - begins))
            at = hits[np.searchsorted(hits, begins)]  # the first in each bin
            self._keep(row, which, time[at], best, beats)
        self.times[3, which], self.values[3, which] = time[ends - 1], value[ends - 1]

    def _keep(self, row, which, time, value, beats):
        old = self.values[row, which]
        better = np.isnan(old) | beats(value, old)
        self.times[row, which[better]], self.values[row, which[better]] = time[better], value[better]

    def points(self):
        """(times, values) in the order of time."""
        if self.is_short:
            if not self.pieces:
                return np.zeros(0), np.zeros(0)
            return tuple(np.concatenate(parts) for parts in zip(*self.pieces))
        order = np.argsort(self.times, axis=0, kind="stable")
        times = np.take_along_axis(self.times, order, 0).T.ravel()
        values = np.take_along_axis(self.values, order, 0).T.ravel()
        there = np.isfinite(times)
        there[1:] &= ~((times[1:] == times[:-1]) & (values[1:] == values[:-1]))  # one sample that is two of the four
        return times[there], values[there]


def broken(x, y, gaps):
    """The series with nothing in its gaps, so that no line is drawn through them."""
    if not gaps:
        return x, y
    x, y = np.asarray(x, float), np.array(y, float)
    for before, after in gaps:
        y[(x > before) & (x < after)] = np.nan
    at = np.searchsorted(x, [after for _, after in gaps])
    within = (at > 0) & (at < len(x))  # of a part of the log: what ends before it or begins behind it
    return (np.insert(x, at[within], np.mean(gaps, axis=1)[within]), np.insert(y, at[within], np.nan))


def thinned(x, y):
    """The same of a series in memory."""
    if len(x) <= MOST_POINTS:
        return x, y
    envelope = Envelope(float(np.min(x)), float(np.max(x)), len(x))
    envelope.add(np.asarray(x, float), y)
    return envelope.points()
