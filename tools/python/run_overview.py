"""What a report says and draws of a run, from one way through its log a stretch at a time: memory does not grow with the
log. Phases are the parts of a run that are told apart: before and after the emergency stop."""

import collections

import numpy as np

from envelope import BINS, Envelope
from holes import Holes
from run_log import seconds
from spectrum import Spectrum

ACCELERATIONS = ("tip_acceleration", "house_acceleration")
MOST_AT_ONCE = 1 << 18  # [samples] of an even series
MOST_MARKS = 4000  # [-] crossings of the play that are drawn one by one, per gearbox


def request(messages):
    """[-] share of the top speed that the operator asks for."""
    return np.where(messages["emergency_stop"], 0.0, messages["speed_request"])


# Channel: what is drawn of it, a field or a function of the messages; arrays are drawn entry by entry.
DRAWN = {
    "OPERATOR": {"request": request},
    "ENCODER": {"shaft_speed": None},
    "TORQUE": {"motor_torque": None},
    "SENSORS": {"tip_acceleration": None, "house_acceleration": None},
    "TRUTH": {"house_speed": None, "gearbox_torque": None, "rope_angle": None, "rod_angle": None},
    "CONTROLLER_STATE": {"ramped_speed": None},
}
# Channel: fields whose largest size in each phase is told.
LARGEST = {"SENSORS": ACCELERATIONS, "TRUTH": ("rope_angle",), "TORQUE": ("motor_torque",)}


class EvenSeries:
    """Samples as they come, on an even grid from the first one on: lost messages leave no gap."""

    def __init__(self, step):
        self.step, self.made = step, 0
        self.first, self.last = None, None  # (time, value)

    def add(self, time, value):
        """Yields values at the grid's instants up to the newest sample."""
        if self.first is None:
            self.first = time[0]
        else:
            time, value = np.append(self.last[0], time), np.append(self.last[1], value)
        self.last = (time[-1], value[-1])
        end = int((time[-1] - self.first) / self.step) + 2
        while self.made < end:  # a gap may be long
            upto = min(end, self.made + MOST_AT_ONCE)
            values = self._at(np.arange(self.made, upto), time[-1], time, value, np.less_equal)
            yield values
            if self.made < upto:
                return

    def finish(self):
        """What follows the newest sample: the grid reaches half a step beyond it."""
        after = np.arange(self.made, self.made + 3)
        return self._at(after, self.last[0] + 0.5 * self.step, np.array(self.last[:1]), np.array(self.last[1:]), np.less)

    def _at(self, numbers, end, time, value, is_before):
        grid = self.first + numbers * self.step
        grid = grid[is_before(grid, end)]
        self.made += len(grid)
        return np.interp(grid, time, value)


BEFORE_STOP, AFTER_STOP = "before the stop", "after the stop"


def phase_of(names, name):
    """Which of a run's phases has the name: all of a run without an emergency stop lies before one. None where the run has no such phase."""
    if name == BEFORE_STOP and names == [""]:
        return 0
    return names.index(name) if name in names else None


class Overview:
    def __init__(self, log, segment):
        """`segment` [s] of the spectra of its accelerations."""
        self.log, self.segment = log, segment
        self.stop = self._stop_time()
        # What happens at a phase's end belongs to the next one; the last one's end lies just behind the last message.
        end = np.nextafter(max(table.last for table in log.tables.values()), np.inf)
        self.phases = [("", 0.0, end)]
        if self.stop is not None and 0 < self.stop < end:
            self.phases = [(BEFORE_STOP, 0.0, self.stop), (AFTER_STOP, self.stop, end)]
        self._unmeasured = set()
        self.largest = [collections.defaultdict(float) for _ in self.phases]
        self.spectra = [{} for _ in self.phases]
        self._go_through()

    def measured(self, signal):
        """Whether the log's SENSORS hold the signal; what a crane has no sensor for stands there as NaN."""
        return self.log.has("SENSORS") and signal not in self._unmeasured

    def drawn(self, channel, field, entry=0):
        """(times [s], values) of a field, as many as a picture needs."""
        return self._envelopes[channel, field][entry].points()

    def entries(self, channel, field):
        return len(self._envelopes[channel, field])

    @property
    def gaps(self):
        """{channel: [(last time before, first time after) [s]]} where messages are missing; OPERATOR speaks when it has something to say."""
        return {channel: self._gaps[channel].found if channel in self._gaps else [] for channel in DRAWN}

    def _stop_time(self):
        """[s] when the operator pressed the emergency stop; None where that never happened."""
        stop = None
        if self.log.has("OPERATOR"):
            for stretch in self.log.stretches("OPERATOR"):
                moves = stretch["OPERATOR"]
                pressed = np.flatnonzero(moves["emergency_stop"])
                if stop is None and len(pressed):
                    stop = float(moves["simulated_time"][pressed[0]] / 1e9)
        return stop

    def _of_phases(self, time):
        return [(time >= first) & (time < end) for _, first, end in self.phases]

    def _sample_periods(self):
        """[s] between two SENSORS messages in each phase, the median; and how many messages there are."""
        steps, counts, last = [collections.Counter() for _ in self.phases], [0] * len(self.phases), [None] * len(self.phases)
        for stretch in self.log.stretches("SENSORS"):
            stamps = stretch["SENSORS"]["simulated_time"]
            for number, mine in enumerate(self._of_phases(stamps / 1e9)):
                kept = stamps[mine]
                if len(kept) == 0:
                    continue
                counts[number] += len(kept)
                before = kept[:1] if last[number] is None else [last[number]]
                sizes, votes = np.unique(np.diff(kept, prepend=before)[1 if last[number] is None else 0:], return_counts=True)
                steps[number].update(dict(zip(sizes.tolist(), votes.tolist())))
                last[number] = kept[-1]
        periods = []
        for counter in steps:
            sizes = sorted(counter)
            reached = np.cumsum([counter[size] for size in sizes])
            periods.append(sizes[int(np.searchsorted(reached, 0.5 * reached[-1]))] / 1e9 if sizes else None)
        return periods, counts

    def _go_through(self):
        self._envelopes, self._gaps, handlers = {}, {}, {}
        for channel, fields in DRAWN.items():
            if not self.log.has(channel):
                continue
            table = self.log.tables[channel]
            if channel != "OPERATOR":
                self._gaps[channel] = Holes(least=(table.last - table.first) / BINS)  # what is shorter is not seen in a picture
            for field, value in fields.items():
                shape = () if value else table.dtype[field].shape
                self._envelopes[channel, field] = [Envelope(table.first, table.last, table.rows)
                                                   for _ in range(shape[0] if shape else 1)]
        if self.log.has("SENSORS"):
            periods, counts = self._sample_periods()
            self._spectra = [
                {signal: (EvenSeries(period), Spectrum(period, self.segment)) for signal in ACCELERATIONS} if count >= 16 and period > 0 else {}
                for period, count in zip(periods, counts)]
            handlers["SENSORS"] = self._take_accelerations
        if self.log.has("TRUTH"):
            groups = self.log.tables["TRUTH"].dtype["play_crossings"].shape[0]
            self._crossed, self.crossing_times = np.zeros(groups, np.int64), [np.zeros(0)] * groups
            self.crossings = [[0] * groups for _ in self.phases]
            handlers["TRUTH"] = self._take_crossings
        for stretch in self.log.stretches(*DRAWN):
            for channel, messages in stretch.items():
                time = seconds(messages)
                if channel in self._gaps:
                    self._gaps[channel].add(time)
                for field, value in DRAWN[channel].items():
                    values = value(messages) if value else messages[field]
                    for entry, envelope in enumerate(self._envelopes[channel, field]):
                        envelope.add(time, values[:, entry] if values.ndim > 1 else values)
                phases = self._of_phases(time)
                for field in LARGEST.get(channel, ()):
                    for number, mine in enumerate(phases):
                        sizes = np.abs(messages[field][mine])
                        if sizes.size:  # what is not a number stays so
                            self.largest[number][field] = float(np.maximum(self.largest[number][field], np.max(sizes)))
                if channel in handlers:
                    handlers[channel](messages, time, phases)
        if self.log.has("SENSORS"):
            for number, series in enumerate(self._spectra):
                for signal in ACCELERATIONS:
                    if signal not in series or not self.measured(signal):
                        self.spectra[number][signal] = np.zeros(0), np.zeros(0)
                        continue
                    even, spectrum = series[signal]
                    spectrum.add(even.finish())
                    self.spectra[number][signal] = spectrum.finish()

    def _take_accelerations(self, messages, time, phases):
        for signal in ACCELERATIONS:
            values = messages[signal]
            if not np.all(np.isfinite(values)):
                self._unmeasured.add(signal)
            if signal in self._unmeasured:
                continue
            for number, mine in enumerate(phases):
                if signal in self._spectra[number] and mine.any():
                    even, spectrum = self._spectra[number][signal]
                    for piece in even.add(time[mine], values[mine]):
                        spectrum.add(piece)

    def _take_crossings(self, messages, time, phases):
        counts = messages["play_crossings"]
        for group, before in enumerate(self._crossed):
            steps = np.maximum(np.diff(counts[:, group], prepend=before), 0)
            for number, mine in enumerate(phases):
                self.crossings[number][group] += int(steps[mine].sum())
            times = np.append(self.crossing_times[group], np.repeat(time, np.minimum(steps, MOST_MARKS)))
            if len(times) > MOST_MARKS:  # one for each place that can be told apart
                table = self.log.tables["TRUTH"]
                places = np.round((times - table.first) / (table.last - table.first or 1.0) * MOST_MARKS / 2)
                times = times[np.unique(places, return_index=True)[1]]
            self.crossing_times[group] = times
        self._crossed = counts[-1].copy()
