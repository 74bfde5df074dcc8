"""Where signals come from: a recorded log, a log that is still being written, or the bus. Each fills a store."""

import contextlib
import functools
import mmap
import os
import struct
from pathlib import Path

import numpy as np

from run_log import LogProblem, message_types
from run_numbers import facts_beside, facts_path, read_run
from signals import measured
from desk.store import Store

# What the desk looks at of each channel.
USED = {
    "OPERATOR": ("speed_request", "emergency_stop", "acknowledge"),
    "ENCODER": ("shaft_speed", "shaft_position"),
    "TORQUE": ("motor_torque", "enable", "brake"),
    "CONTROLLER_STATE": ("mode", "ramped_speed", "average_torque", "offset_torque"),
    "SENSORS": tuple(measured("SENSORS")),
    "TRUTH": ("gearbox_torque", "gear_deflection", "house_speed", "tip_displacement", "rope_angle", "rod_angle"),
    "MOTION": ("boom_angle", "rope_length", "travelled"),
    "PLANT_STATUS": ("drive_state", "trip_cause", "trip_time", "stale_commands", "missed_deadlines"),
}
SPORADIC = ("OPERATOR", "PLANT_STATUS")  # where none comes, none is missing
HELD = ("OPERATOR", "TORQUE", "CONTROLLER_STATE", "PLANT_STATUS")  # their values stand until the next ones
WHOLE = 1 << 24  # [samples] of a recorded log's channel that are kept one by one: more than four hours at 1 kHz

MOST_TOLD = 3  # stretches of time without messages that are named

EVENT = struct.Struct(">IqqII")  # LCM's event format: sync word, number, time stamp [us], lengths of channel and data
SYNC = 0xEDA1DA01
LONGEST_CHANNEL = 63  # [bytes] that LCM allows
LARGEST_MESSAGE = 1 << 20  # [bytes]


def event_bytes(number, time, channel, data):
    """An event of a log, `time` [s] its stamp."""
    name = channel.encode()
    return EVENT.pack(SYNC, number, max(0, round(time * 1e6)), len(name), len(data)) + name + data


def fill(store, channel, messages):
    """Structured messages of one channel into the store."""
    fields = [field for field in USED.get(channel, ()) if field in messages.dtype.names]
    store.append(channel, messages["simulated_time"] / 1e9, {field: messages[field] for field in fields})


def what_is_missing(store):
    """Words for the first stretches of time of which a log lacks messages."""
    channels = {name: channel for name, channel in store.channels.items() if name not in SPORADIC}
    stretches = []  # [begin, end, channels]
    for begin, end, name in sorted((*hole, name) for name, channel in channels.items() for hole in channel.holes):
        if stretches and begin < stretches[-1][1]:
            stretches[-1][1] = max(end, stretches[-1][1])
            stretches[-1][2].add(name)
        else:
            stretches.append([begin, end, {name}])
    whose = ["" if len(names) == len(channels) else "of " + ", ".join(sorted(names)) + " " for _, _, names in stretches]
    words = [f"{of}from {begin:.2f} to {end:.2f} s" for of, (begin, end, _) in zip(whose, stretches[:MOST_TOLD])]
    more = [f"and {len(stretches) - MOST_TOLD} times more"] if len(stretches) > MOST_TOLD else []
    return [f"messages are missing {', '.join(words + more)}"] if words else []


class NoBus(LogProblem):
    """A bus cannot be opened, of which the command line may be right."""


class Recorded:
    """A log that is complete, or was broken off."""

    is_live = False

    def __init__(self, place):
        run = read_run(place)
        self.facts, self.remarks, self.path = run.facts, run.log.remarks, run.log.path
        folder = self.path.resolve().parent
        self.name = f"{folder.parent.name}/{run.name}" if run.name == folder.name and run.name.isdigit() else run.name  # of a steered run
        self.store = Store(WHOLE)
        for stretch in run.log.stretches(*[name for name in USED if run.log.has(name)]):
            for channel, messages in stretch.items():
                fill(self.store, channel, messages)
        if not np.isfinite(self.store.last):
            raise LogProblem(f"{run.log.path}: nothing in it that could be drawn")
        self.remarks = [*self.remarks, *what_is_missing(self.store)]

    def poll(self):
        return False


def within(holes, time):
    """Which times lie in holes of a channel."""
    if not holes:
        return np.zeros(len(time), bool)
    before, behind = np.array(holes).T
    place = np.searchsorted(before, time, "left") - 1
    return (place >= 0) & (time < behind[place])


class Difference:
    """What a first recorded log has more than a second, sample by sample of the first, where both have a signal."""

    is_live = False

    def __init__(self, first, second):
        self.name, self.facts, self.remarks = f"{first.name} − {second.name}", first.facts, []
        self.store = Store(WHOLE)
        for name, channel in first.store.channels.items():
            other = second.store.channels.get(name)
            if other is None or other.names != channel.names:
                continue
            time, values = channel.samples(*(max(first.store.first, second.store.first), min(first.store.last, second.store.last)))
            other_time, other_values = other.samples(-np.inf, np.inf)
            if len(other_time) == 0:
                continue
            is_there = time >= other_time[0]  # the first log may have begun before, and messages of other channels stand in front of a recording
            if name not in SPORADIC:
                is_there &= (time <= other_time[-1]) & ~within(other.holes, time)
            time, values = time[is_there], values[:, is_there]
            if len(time) == 0:
                continue
            if name in HELD:
                at = np.maximum(np.searchsorted(other_time, time, "right") - 1, 0)
                rows = values - other_values[:, at]
            else:
                rows = values - np.stack([np.interp(time, other_time, row) for row in other_values])
            self.store.append(name, time, {signal.removeprefix(f"{name}."): row for signal, row in zip(channel.names, rows)})

    def poll(self):
        return False


def motor_groups(facts):
    """How many motor groups the machine has that run.json tells; 0 where it tells none."""
    return sum(effort["name"].startswith("motor") for effort in facts.get("machine", {}).get("efforts", []))


class Facts:
    """What stands beside a log of what goes on, which is written when a run begins, and again when it ends."""

    def __init__(self, log):
        self.log, self.changed, self.known = log, None, {}

    def read(self):
        with contextlib.suppress(FileNotFoundError, LogProblem):  # not yet there, or not yet whole
            changed = facts_path(self.log).stat().st_mtime_ns
            if changed != self.changed:
                self.known, self.changed = facts_beside(self.log), changed
        return self.known


class Bus:
    """What is said on a bus, as this process hears it (docs/wire.md). `facts_folder`: of the run, whose run.json tells the machine."""

    is_live = True
    is_repeated = True  # an ENCODER that is not answered is heard again

    def __init__(self, address, facts_folder=None, receive=None, begin=None, channels=tuple(USED)):
        import lcm

        self.name, self.facts, self.remarks = address, {}, []
        self.store, self.events = Store(), []
        self.incoming = Incoming(receive or functools.partial(fill, self.store), begin or self.store.clear, channels)
        self.facts_file = None
        if facts_folder is not None:
            self.facts_file = Facts(Path(facts_folder) / "run.lcmlog")
            if not facts_path(self.facts_file.log).is_file():
                raise LogProblem(f"{facts_path(self.facts_file.log)}: there is no such file; slewlab run writes it when it begins")
            self.facts = facts_beside(self.facts_file.log)
        try:
            self.bus = lcm.LCM(address)
        except RuntimeError as error:
            raise NoBus(f"{address}: no bus can be opened there: {error}; is there a route for multicast?") from None
        self.subscription = self.bus.subscribe("|".join(channels), lambda channel, data: self.events.append((channel, data)))
        self.subscription.set_queue_capacity(0)  # unlimited: by default the newest are dropped

    def poll(self):
        if self.facts_file is not None:
            self.facts = self.facts_file.read()
        while self.bus.handle_timeout(0):
            pass
        events, self.events = self.events, []
        return self.incoming.take(events)


KINDS = {"boolean": "?", "int8_t": "i1", "int16_t": ">i2", "int32_t": ">i4", "int64_t": ">i8", "float": ">f4", "double": ">f8"}
OF_CONTROLLER = ("TORQUE", "CONTROLLER_STATE")  # logged as they came, whatever that was
LATE = 5_000_000_000  # [ns] by which an answer may lie beside the plant's messages that came with it
FINGERPRINT = 8  # [bytes] in front of every message
TIME = slice(16, 24)  # [bytes] of every message: simulated time [ns]
IDENTITY = slice(32, 40)  # [bytes] of every message: of which run it is


def row_type(message_class, count_of):
    """numpy's type of a message as it is on the wire; `count_of` tells the length of an array by the field that holds it."""
    names, types = ["fingerprint"], [">u8"]
    for name, kind, dimensions in zip(message_class.__slots__, message_class.__typenames__, message_class.__dimensions__):
        names.append(name)
        types.append(KINDS[kind] if dimensions is None else (KINDS[kind], (count_of(dimensions[0]),)))
    return np.dtype({"names": names, "formats": types})


class Decoder:
    """Many messages of one channel and run at once: all that are as long as the first have its array counts."""

    def __init__(self, message_class, sample):
        message = message_class.decode(sample)
        self.dtype = row_type(message_class, functools.partial(getattr, message))
        self.size, self.fingerprint = len(sample), sample[:FINGERPRINT]

    def decode(self, messages):
        fitting = [data for data in messages if len(data) == self.size and data[:FINGERPRINT] == self.fingerprint]
        return np.frombuffer(b"".join(fitting), self.dtype)


def class_of(channel):
    return getattr(message_types(), f"{channel.lower()}_t")


class Incoming:
    """Events as they come, of one run at a time: `receive` gets every channel's rows, `begin` is called where another run's ENCODER
    comes and none of the one before, or the time falls: the same is said once more."""

    def __init__(self, receive, begin=lambda: None, channels=tuple(USED)):
        self.receive, self.begin, self.decoders = receive, begin, {}
        self.identity = None  # [bytes] of this run
        self.run = 0  # counts the runs
        self.newest = None  # [ns] of this run's ENCODER
        self.asked, self.answered, self.answered_time = -1, -1, None  # sequence of the newest ENCODER, of the newest that was answered, its time [ns]
        self.span = None  # [ns] times of the plant's messages of this batch
        self.taps = []  # each gets all events as they are, when it is known of which run they are
        self.moves = []  # OPERATOR as it is on the wire: (time [ns], request, emergency stop, acknowledge)
        self.classes = {channel: class_of(channel) for channel in channels}

    def take(self, events):
        """`events`: (channel, data), in their order."""
        waiting = {}
        for channel, data in events:
            if channel in self.classes:
                waiting.setdefault(channel, []).append(data)
        self.span = None
        # The plant's own first: by them it is known which run this is, and which times there are.
        for channel in sorted(waiting, key=lambda name: (name in OF_CONTROLLER, name != "ENCODER")):
            messages = waiting[channel]
            if self.identity is None or channel == "ENCODER":
                self._look_for_another(channel, messages)
            own = [data for data in messages if data[IDENTITY] == self.identity]
            if not own or channel not in self.decoders and not self._learn(channel, own[0]):
                continue
            rows = self.decoders[channel].decode(own)
            if channel == "ENCODER" and len(rows):
                self.newest, self.asked = int(rows["simulated_time"].max()), int(rows["sequence"].max())
            if channel in OF_CONTROLLER and self.span is not None:  # a bit that turned over may be one of the time
                time = rows["simulated_time"]
                rows = rows[(time >= self.span[0] - LATE) & (time <= self.span[1] + LATE)]
            elif len(rows) and channel not in OF_CONTROLLER:
                times = [int(rows["simulated_time"].min()), int(rows["simulated_time"].max()), *(self.span or ())]
                self.span = min(times), max(times)
            if channel == "TORQUE":
                self._note_answers(rows)
            if channel == "OPERATOR":
                self.moves += zip(*(rows[field].tolist() for field in ("simulated_time", "speed_request", "emergency_stop", "acknowledge")))
            if len(rows):
                self.receive(channel, rows)
        for tap in self.taps if events else ():
            tap(events)
        return bool(waiting)

    def forget(self):
        """What comes next is of another run, and maybe of another machine, with arrays of other lengths."""
        if self.identity is not None:
            self.begin()
            self.moves.clear()
            self.decoders.clear()
            self.run, self.identity, self.newest = self.run + 1, None, None
            self.asked, self.answered, self.answered_time = -1, -1, None

    def _note_answers(self, rows):
        good = rows[rows["answered_sequence"] <= self.asked]  # others answer nothing
        if len(good) and int(good["answered_sequence"].max()) > self.answered:
            newest = good[np.argmax(good["answered_sequence"])]
            self.answered, self.answered_time = int(newest["answered_sequence"]), int(newest["simulated_time"])

    def _learn(self, channel, sample):
        """Whether it is known now how the channel's messages are laid out."""
        try:
            self.decoders[channel] = Decoder(self.classes[channel], sample)
        except (ValueError, struct.error):
            return False  # no message: a bit turned over on its way
        return True

    def _look_for_another(self, channel, messages):
        """Whose run these messages are of is the one that is followed, where it is another than up to now."""
        fingerprint = self.classes[channel]._get_packed_fingerprint()
        whole = [data for data in messages if data[:FINGERPRINT] == fingerprint and len(data) >= IDENTITY.stop]
        own = [int.from_bytes(data[TIME], "big", signed=True) for data in whole if data[IDENTITY] == self.identity]
        is_this = own and (self.newest is None or max(own) >= self.newest - LATE)
        if not whole or is_this or not self._learn(channel, whole[-1]):
            return
        self.forget()
        self.identity = whole[-1][IDENTITY]

    def of_this_run(self, events):
        """Those that say that they are of the run that is followed."""
        return [(channel, data) for channel, data in events if self.identity is not None and data[IDENTITY] == self.identity]


def growing_log(place):
    """PATH of the log that is written there, PATH or PATH.partial: a log, or the folder of a run. LogProblem where there is neither, and nobody
    would ever be shown anything."""
    place = Path(place)
    path = place / "run.lcmlog" if place.is_dir() else place.with_name(place.name.removesuffix(".partial"))
    found = next((each for each in (path, path.with_name(path.name + ".partial")) if each.is_file()), None)
    if found is None:
        if place.is_dir() and (place / "run.json").is_file():  # a run that has only begun
            return path
        what = "a folder without run.lcmlog" if place.is_dir() else "no log and no folder of that name"
        raise LogProblem(f"{place}: found {what}, expected a log that is being written, or the folder of a run that has begun; a bus goes with --bus")
    with found.open("rb") as stream:
        beginning = stream.read(LARGEST_MESSAGE)
    if len(beginning) >= EVENT.size and SYNC.to_bytes(4, "big") not in beginning:
        raise LogProblem(f"{found}: found a file that is no log of LCM, expected a log that is being written, or the folder of a run")
    return path


class Growing:
    """The log of a run that is under way, PATH or PATH.partial."""

    is_live = True
    is_repeated = False
    MOST_AT_ONCE = 1 << 22  # [bytes]

    def __init__(self, path, name=None, receive=None, begin=None, channels=tuple(USED)):
        self.path, self.name, self.remarks = Path(path), name or Path(path).resolve().parent.name, []
        self.store = Store()
        self.incoming = Incoming(receive or functools.partial(fill, self.store), begin or self.store.clear, channels)
        self.file, self.rest = None, b""
        self.facts_file, self.facts = Facts(self.path), facts_beside(self.path)

    def _newest(self):
        """The log that was written last: of another run in the same folder than one that is complete, the unfinished one."""
        paths = [path for path in (self.path, self.path.with_name(self.path.name + ".partial")) if path.is_file()]
        return max(paths, key=lambda path: path.stat().st_mtime_ns, default=None)

    def _open(self):
        with contextlib.suppress(FileNotFoundError):  # just renamed: it is complete
            newest = self._newest() if self.file is None else None
            if newest is not None:
                self.file = newest.open("rb")

    def _follow_another(self):
        """Where another run has begun: its log is another file, or the same one from its beginning on."""
        with contextlib.suppress(FileNotFoundError):
            newest = self._newest()
            if newest is None:
                return
            if not os.path.samestat(newest.stat(), os.fstat(self.file.fileno())):
                self.file.close()
                self.file = newest.open("rb")
            elif newest.stat().st_size < self.file.tell():
                self.file.seek(0)
            else:
                return
            self.rest = b""
            self.incoming.forget()

    def skip_what_is_there(self):
        """What is written from now on is taken, and of what is there what stands until the next message."""
        self._open()
        if self.file is not None and self.file.seek(0, os.SEEK_END):
            with mmap.mmap(self.file.fileno(), 0, access=mmap.ACCESS_READ) as written:
                self.file.seek(len(written))
                standing = [last_event(written, channel) for channel in ("ENCODER", *SPORADIC)]  # ENCODER: of which run they are
            self.incoming.take([event for event in standing if event is not None])

    def poll(self):
        """Takes what has been written since; whether there was anything."""
        self._open()
        if self.file is None:
            return False
        self.facts = self.facts_file.read()
        data = self.file.read(self.MOST_AT_ONCE)
        if not data:
            self._follow_another()
        events, self.rest = parse_events(self.rest + data)
        return self.incoming.take(events)


def parse_events(data):
    """(channel, bytes) of the whole events in `data`, and the rest that is none yet. Damage is skipped."""
    events, place, size = [], 0, len(data)
    while place + EVENT.size <= size:
        sync, _, _, channel, length = EVENT.unpack_from(data, place)
        if sync != SYNC or channel > LONGEST_CHANNEL or length > LARGEST_MESSAGE:
            place = data.find(SYNC.to_bytes(4, "big"), place + 1)
            if place < 0:
                return events, data[-3:]
            continue
        begin = place + EVENT.size
        end = begin + channel + length
        if end > size:
            break
        events.append((data[begin:begin + channel].decode("ascii", "replace"), data[begin + channel:end]))
        place = end
    return events, data[place:]


def last_event(data, channel):
    """(channel, bytes) of the last whole event of a channel; None where there is none."""
    name = channel.encode()
    place = len(data)
    while (place := data.rfind(name, 0, place)) >= 0:
        begin = place - EVENT.size
        if begin >= 0:
            sync, _, _, length_of_name, length = EVENT.unpack_from(data, begin)
            end = place + len(name) + length
            if sync == SYNC and length_of_name == len(name) and length <= LARGEST_MESSAGE and end <= len(data):
                return channel, data[place + len(name):end]
    return None
