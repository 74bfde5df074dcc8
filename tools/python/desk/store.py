"""Signals over time, so that any window is drawn at the cost of its pixels and no peak is lost.

A channel's samples stand in level 0; every item of level k + 1 holds the lowest and the highest of FACTOR items of level k.
A window is drawn from the finest level that has no more than MOST_PER_PIXEL items per pixel; what the coarser levels do not
hold yet of the newest samples comes from the finer ones. Memory is bounded: a level that is full forgets its older half, and
what it forgot is drawn from the next coarser one.
"""

import bisect

import numpy as np

from holes import FEWEST_STEPS, Holes, is_hole

FACTOR = 8
MOST_PER_PIXEL = 16
CAPACITY = 1 << 18  # [items] of a level: four minutes at 1 kHz in level 0, half an hour in level 1
LEVELS = 7
MOST_HOLES = 1024   # that are kept of a channel, the newest ones


class Level:
    """Items by absolute number: `begin` is the oldest that is still here."""

    def __init__(self, signals, capacity, has_ranges):
        self.capacity, self.begin, self.count = capacity, 0, 0
        self.time = np.empty(64)
        self.low = np.empty((signals, 64), np.float32)
        self.high = np.empty((signals, 64), np.float32) if has_ranges else self.low

    @property
    def end(self):
        return self.begin + self.count

    def _make_room(self, more):
        if self.count + more > self.capacity and self.count:
            kept = max(0, min(self.count, self.capacity // 2 - more))
            self._move(self.count - kept, kept, len(self.time))
        size = len(self.time)
        if self.count + more > size:
            self._move(0, self.count, max(2 * size, self.count + more))

    def _move(self, first, kept, size):
        own_high = self.high is not self.low
        time, low = np.empty(size), np.empty((len(self.low), size), np.float32)
        time[:kept], low[:, :kept] = self.time[first:first + kept], self.low[:, first:first + kept]
        if own_high:
            high = np.empty_like(low)
            high[:, :kept] = self.high[:, first:first + kept]
        self.time, self.low, self.high = time, low, high if own_high else low
        self.begin, self.count = self.begin + first, kept

    def append(self, time, low, high):
        self._make_room(len(time))
        place = slice(self.count, self.count + len(time))
        self.time[place], self.low[:, place] = time, low
        if self.high is not self.low:
            self.high[:, place] = high
        self.count += len(time)

    def part(self, begin, end):
        """(time, low, high) of the items from `begin` to `end`, absolute."""
        place = slice(begin - self.begin, end - self.begin)
        return self.time[place], self.low[:, place], self.high[:, place]

    def find(self, time, side):
        """Absolute number of the first item at or behind (side left), or behind (right) a time."""
        return self.begin + int(np.searchsorted(self.time[:self.count], time, side))


class Channel:
    def __init__(self, names, capacity=CAPACITY):
        self.names = list(names)
        self.levels = [Level(len(self.names), capacity, k > 0) for k in range(LEVELS)]
        self.told = np.zeros(len(self.names), bool)  # signals of which there was ever a number
        self._holes = Holes(most=MOST_HOLES)
        self._usual_step = None  # [s] of the newest messages, once it was asked for; infinite where they are too few

    @property
    def last_time(self):
        level = self.levels[0]
        return float(level.time[level.count - 1]) if level.count else -np.inf

    @property
    def newest_but_one(self):
        """Time [s] of the message before the newest."""
        level = self.levels[0]
        return float(level.time[level.count - 2]) if level.count > 1 else -np.inf

    @property
    def holes(self):
        """(time before, time behind) [s], in their order."""
        return self._holes.found

    def append(self, time, values):
        """`values` by signal and sample. A time before the newest counts as the newest: rows of a log may swap places."""
        step = self.levels[0].capacity // 4  # what is dropped has gone into the coarser levels
        for first in range(0, len(time), step):
            piece = np.maximum.accumulate(np.maximum(time[first:first + step], self.last_time))
            part = np.asarray(values[:, first:first + step], np.float32)
            if not self.told.all():
                self.told |= np.isfinite(part).any(1)
            self._holes.add(piece)
            self._usual_step = None
            self._append(piece, part)

    def holes_within(self, first, last):
        """Those that reach into a window."""
        begin = bisect.bisect_right(self.holes, first, key=lambda hole: hole[1])
        return self.holes[begin:bisect.bisect_left(self.holes, last, begin, key=lambda hole: hole[0])]

    def is_over(self, now):
        """Whether so much has gone by since the newest message that some are missing, for all that is known: a hole that has no end yet."""
        if now <= self.last_time:
            return False
        if self._usual_step is None:
            steps = np.diff(self._holes.before)
            forward = steps[steps > 0]
            self._usual_step = float(np.median(forward)) if len(forward) >= FEWEST_STEPS else np.inf
        return is_hole(now - self.last_time, self._usual_step)

    def _append(self, time, values):
        self.levels[0].append(time, values, values)
        for fine, coarse in zip(self.levels, self.levels[1:]):
            whole = fine.end // FACTOR
            if whole <= coarse.end:
                return
            first, low, high = fine.part(coarse.end * FACTOR, whole * FACTOR)
            shape = (len(low), -1, FACTOR)
            coarse.append(first[::FACTOR], np.fmin.reduce(low.reshape(shape), 2), np.fmax.reduce(high.reshape(shape), 2))

    def window(self, first, last, most):
        """(time, low, high) of what lies between two times, from the finest level that needs no more than `most` items."""
        top = 0
        for top, level in enumerate(self.levels):
            has_all = level.begin == 0 or level.time[0] <= first
            if has_all and level.find(last, "right") - level.find(first, "left") <= most:
                break
            if top + 1 < LEVELS and self.levels[top + 1].count == 0:
                break
        parts, begin = [], None
        for number in range(top, -1, -1):
            level = self.levels[number]
            begin = max(level.find(first, "left"), 0 if begin is None else begin * FACTOR)
            end = max(begin, level.find(last, "right"))
            parts.append(level.part(begin, end))
            if end < level.end:
                break
            begin = level.end
        return tuple(np.concatenate(each, -1) for each in zip(*parts))

    def envelope(self, first, last, bins):
        """Lowest and highest value of every signal in each of `bins` equal parts of the window; NaN where there is none."""
        low, high = np.full((2, len(self.names), bins), np.nan, np.float32)
        time, lows, highs = self.window(first, last, MOST_PER_PIXEL * bins)
        if len(time):
            place = np.clip(((time - first) * (bins / (last - first))).astype(int), 0, bins - 1)
            begins = np.flatnonzero(np.diff(place, prepend=-1))
            low[:, place[begins]] = np.fmin.reduceat(lows, begins, 1)
            high[:, place[begins]] = np.fmax.reduceat(highs, begins, 1)
        return low, high

    def range_at(self, time):
        """The newest values at a time, by signal: (lowest, highest) of the finest item that is still held, twice the same of a sample. None
        before the first."""
        for level in self.levels:
            place = level.find(time, "right") - 1
            if level.count and place >= level.begin:
                _, low, high = level.part(place, place + 1)
                return low[:, 0].astype(float), high[:, 0].astype(float)
        return None

    def at(self, time):
        """The newest values at a time, by signal; None before the first."""
        found = self.range_at(time)
        return None if found is None else 0.5 * (found[0] + found[1])

    def next_at(self, time):
        """The values of the first message behind a time, by signal; None where no single one is held."""
        level = self.levels[0]
        place = level.find(time, "right")
        if not level.begin <= place < level.end or place == level.begin > 0:
            return None
        return level.part(place, place + 1)[1][:, 0].astype(float)

    def between(self, time):
        """The same, on the straight line between the samples before and behind."""
        level = self.levels[0]
        place = level.find(time, "right") - 1
        if not level.begin <= place < level.end - 1:
            return self.at(time)
        times, values, _ = level.part(place, place + 2)
        step = times[1] - times[0]
        share = (time - times[0]) / step if step > 0 else 0.0
        return values[:, 0] + share * (values[:, 1].astype(float) - values[:, 0])

    def samples(self, first, last):
        """(time, values) of what level 0 still holds between two times."""
        level = self.levels[0]
        time, values, _ = level.part(level.find(first, "left"), level.find(last, "right"))
        return time, values


class Store:
    """The channels of a run. Signals are called CHANNEL.field, or CHANNEL.field.0 of an array field."""

    def __init__(self, capacity=CAPACITY):
        self.capacity, self.channels, self.places = capacity, {}, {}
        self.first, self.last = np.inf, -np.inf  # [s]

    def clear(self):
        """As at the beginning: of another run."""
        self.channels.clear()
        self.places.clear()
        self.first, self.last = np.inf, -np.inf

    def append(self, name, time, columns):
        """`columns`: {field: values by sample, or by sample and entry}."""
        if len(time) == 0:
            return
        signals, rows = [], []
        for field, values in columns.items():
            if values.ndim == 1:
                signals.append(f"{name}.{field}")
                rows.append(values)
            else:
                signals += [f"{name}.{field}.{entry}" for entry in range(values.shape[1])]
                rows += list(values.T)
        if name not in self.channels:
            self.channels[name] = Channel(signals, self.capacity)
            self.places |= {signal: (name, row) for row, signal in enumerate(signals)}
        if signals != self.channels[name].names:
            return  # a message of another number of groups is none of this machine's
        self.channels[name].append(time, np.array(rows))
        self.first, self.last = min(self.first, float(time[0])), max(self.last, float(time[-1]))

    def has(self, signal):
        return signal in self.places

    def told(self, signal):
        """Whether there was ever a number of a signal: what a machine has no sensor for stands in its log as NaN."""
        if signal not in self.places:
            return False
        name, row = self.places[signal]
        return bool(self.channels[name].told[row])

    def at(self, signal, time, between=False):
        """The value of a signal at a time, nan where there is none."""
        if signal not in self.places:
            return np.nan
        name, row = self.places[signal]
        channel = self.channels[name]
        values = channel.between(time) if between else channel.at(time)
        return np.nan if values is None else float(values[row])

    def next_at(self, signal, time):
        """The value of a signal in the first message behind a time, nan where there is none."""
        name, row = self.places.get(signal, (None, 0))
        values = self.channels[name].next_at(time) if name is not None else None
        return np.nan if values is None else float(values[row])

    def ranges_at(self, signals, time):
        """{signal: (lowest, highest)} at a time (Channel.range_at); each channel is looked at once."""
        of_channel = {name: self.channels[name].range_at(time) for name in {self.places[signal][0] for signal in signals if signal in self.places}}
        found = {}
        for signal in signals:
            name, row = self.places.get(signal, (None, 0))
            if of_channel.get(name) is not None:
                low, high = of_channel[name]
                found[signal] = float(low[row]), float(high[row])
        return found

    def envelopes(self, signals, first, last, bins):
        """{signal: (low, high)}; each channel is gone through once."""
        wanted, found = {}, {}
        for signal in signals:
            if signal in self.places:
                wanted.setdefault(self.places[signal][0], []).append(signal)
        for name, of_channel in wanted.items():
            channel = self.channels[name]
            low, high = channel.envelope(first, last, bins)
            for signal in of_channel:
                row = self.places[signal][1]
                found[signal] = low[row], high[row]
        return found

    def hold(self, signal, envelope, first, last):
        """Of a value that stands until the next one: what stood when the window began, and up to the newest time."""
        low, high = envelope
        before = self.at(signal, first)
        if np.isnan(low[0]) and np.isfinite(before):
            low[0] = high[0] = before
        end = min(len(low) - 1, int((min(last, self.last) - first) / (last - first) * len(low)))
        if end >= 0 and np.isnan(low[end]):
            there = np.flatnonzero(np.isfinite(high[:end]))
            if len(there):
                low[end] = high[end] = self.at(signal, min(last, self.last))
