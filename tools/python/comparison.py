"""One run less another, as something that a report's panels draw like a run: every sample of the first minus the second at
its instant. Both logs are gone through a stretch at a time; memory does not grow with them."""

import numpy as np

from envelope import Envelope
from run_log import seconds
from run_overview import DRAWN

HELD = ("TORQUE",)  # channels whose value holds until the next message; the others are interpolated


def at(instants, time, values, is_held):
    """`values` of the instants that lie within `time`, and which those are."""
    within = (instants >= time[0]) & (instants <= time[-1])
    wanted = instants[within]
    if is_held:
        return values[np.searchsorted(time, wanted, side="right") - 1], within
    if values.ndim == 1:
        return np.interp(wanted, time, values), within
    return np.column_stack([np.interp(wanted, time, column) for column in values.T]), within


def of_stretches(log, channel, field, value):
    """(time [s], values), a stretch at a time."""
    for stretch in log.stretches(channel):
        messages = stretch[channel]
        yield seconds(messages), np.asarray(value(messages) if value else messages[field], float)


def differences(first, second, channel, field, value):
    """(time, first minus second) where both have an instant, a stretch of the first at a time."""
    others = of_stretches(second, channel, field, value)
    time, values = next(others, (np.zeros(0), None))
    for instants, mine in of_stretches(first, channel, field, value):
        while len(time) and time[-1] < instants[-1]:
            more = next(others, None)
            if more is None:
                break
            kept = time >= instants[0]
            kept[max(0, np.argmax(kept) - 1 if kept.any() else len(kept) - 1):] = True  # and the sample before
            time, values = np.append(time[kept], more[0]), np.concatenate([values[kept], more[1]])
        if len(time) == 0:
            return
        theirs, within = at(instants, time, values, channel in HELD)
        entries = min(mine.shape[-1], theirs.shape[-1]) if mine.ndim > 1 else None  # of groups that both have
        yield instants[within], mine[within] - theirs if entries is None else mine[within][:, :entries] - theirs[:, :entries]


class DifferenceOverview:
    """What run_overview.Overview is of a run, as far as panels over time ask for it."""

    def __init__(self, first, second):
        self._logs, self._both = (first.log, second.log), (first.overview, second.overview)
        self.phases, self.stop = first.overview.phases, first.overview.stop
        self.crossing_times = []  # a crossing is of one run
        self._known = {}

    @property
    def gaps(self):
        """Of either: what is drawn through a gap of one run says nothing of their difference."""
        first, second = (overview.gaps for overview in self._both)
        return {channel: sorted(first[channel] + second[channel]) for channel in first}

    def measured(self, signal):
        return all(overview.measured(signal) for overview in self._both)

    def entries(self, channel, field):
        return min(overview.entries(channel, field) for overview in self._both)

    def drawn(self, channel, field, entry=0):
        if (channel, field) not in self._known:
            table = self._logs[0].tables[channel]
            envelopes = [Envelope(table.first, table.last, table.rows) for _ in range(self.entries(channel, field))]
            for time, values in differences(*self._logs, channel, field, DRAWN[channel][field]):
                for number, envelope in enumerate(envelopes):
                    envelope.add(time, values[:, number] if values.ndim > 1 else values)
            self._known[channel, field] = envelopes
        return self._known[channel, field][entry].points()


class _WholeLogs:
    """Two logs as one that holds the first less the second, whole channels of it: for panels that ask for those."""

    def __init__(self, logs):
        self._logs = logs

    def has(self, channel):
        return channel != "OPERATOR" and all(log.has(channel) for log in self._logs)

    def channel(self, name):
        """{field: values} of what is a floating-point number, with the simulated time of the first that both have."""
        mine, others = (log.channel(name) for log in self._logs)
        instants, found = seconds(mine), {}
        for field in mine.dtype.names:
            if mine.dtype[field].base.kind == "f" and mine.dtype[field] == others.dtype[field] and mine[field].size:
                theirs, within = at(instants, seconds(others), others[field], name in HELD)
                found[field] = mine[field][within] - theirs
        return found | {"simulated_time": mine["simulated_time"][(instants >= seconds(others)[0]) & (instants <= seconds(others)[-1])]}


class _BothLogs:
    def __init__(self, logs):
        self._logs = logs

    def has(self, channel):
        return channel != "OPERATOR" and all(log.has(channel) for log in self._logs)


def shared(first, second):
    return {key: value for key, value in first.items() if second.get(key) == value}


class Difference:
    """`first` minus `second`; facts that both share, so that a unit of the one is never put on the other. `whole`: for panels that ask
    for whole channels."""

    def __init__(self, first, second, whole=False):
        self.name = f"{first.name} minus {second.name}"
        self.log, self.overview = (_WholeLogs if whole else _BothLogs)((first.log, second.log)), DifferenceOverview(first, second)
        self.facts = shared(first.facts, second.facts)
        self.facts.pop("modes", None)
        self.facts["machine"] = shared(first.facts.get("machine", {}), second.facts.get("machine", {}))
