"""Reads a run's log (run.lcmlog) into numpy arrays: one structured array per channel, a field per message field.

The layout comes from the classes that lcm-gen makes of msgs/*.lcm at build time (build/release/python), so a whole
channel is decoded at once. What cannot be used is told in `remarks`, one line each. Which messages are a run, and which
are strays, follows the rules that msgs/run_log.h gives for the C++ reader.
"""

import bisect
import importlib
import os
import struct
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]

MESSAGE_OF_CHANNEL = {
    "ENCODER": "encoder_t",
    "TORQUE": "torque_t",
    "OPERATOR": "operator_t",
    "SENSORS": "sensors_t",
    "TRUTH": "truth_t",
    "CONTROLLER_STATE": "controller_state_t",
    "PLANT_STATUS": "plant_status_t",
}

# LCM's types on the wire, big-endian.
WIRE_TYPES = {
    "int8_t": "i1",
    "boolean": "?",
    "byte": "u1",
    "int16_t": ">i2",
    "int32_t": ">i4",
    "int64_t": ">i8",
    "float": ">f4",
    "double": ">f8",
}

# An event of LCM's log: sync word, number, time stamp, length of the channel's name, length of the data.
EVENT_HEAD = struct.Struct(">IqqII")
SYNC_WORD = 0xEDA1DA01
SYNC_BYTES = SYNC_WORD.to_bytes(4, "big")
LONGEST_CHANNEL = 63

LARGE_EVENT = 1024 * 1024  # [bytes] no message of ours is that large

FALL_BACK = 1_000_000_000  # [ns] that messages may be out of order in the file
LEAP = 1_000_000_000       # [ns] ahead, or some of the usual distances between messages
USUAL_DISTANCES = 4
PLACES = 5                 # of damage that are told
FOREIGN_CHANNELS = 10      # that are told by name

PLANT_CHANNELS = ("ENCODER", "SENSORS", "TRUTH", "PLANT_STATUS")


class LogProblem(Exception):
    """The log cannot be read or holds no run. The text says which file and why."""


@dataclass
class RunLog:
    path: Path
    channels: dict = field(default_factory=dict)
    remarks: list = field(default_factory=list)

    def channel(self, name):
        """The channel's messages in the order of their sequence; LogProblem where the log has none."""
        if name not in self.channels:
            raise LogProblem(f"{self.path}: no usable {name} message in this log")
        return self.channels[name]

    def has(self, name):
        return name in self.channels


def seconds(messages):
    """[s] simulated time of each message."""
    return messages["simulated_time"] / 1e9


def messages_folder():
    """What the build made for Python of msgs/*.lcm. SLEWLAB_PYTHON_MESSAGES names another folder than build/release/python."""
    return Path(os.environ.get("SLEWLAB_PYTHON_MESSAGES", REPOSITORY / "build" / "release" / "python"))


def message_types():
    """The module that lcm-gen made."""
    folder = messages_folder()
    if not (folder / "slewlab_msgs").is_dir():
        raise LogProblem(f"{folder}: the messages are not built for Python; run tools/build")
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    return importlib.import_module("slewlab_msgs")


def wire_layout(message_class, sample):
    """The numpy layout of a message as long as `sample`, and the array counts that it holds for."""
    fields = [("fingerprint", "S8")]
    counts = {}
    offset = 8
    for name, type_name, dimensions in zip(
        message_class.__slots__, message_class.__typenames__, message_class.__dimensions__
    ):
        wire_type = np.dtype(WIRE_TYPES[type_name])
        if dimensions is None:
            fields.append((name, wire_type))
            size = wire_type.itemsize
            if type_name == "int32_t":
                counts[name] = int(np.frombuffer(sample, wire_type, 1, offset)[0])
        else:
            shape = tuple(d if isinstance(d, int) else counts[d] for d in dimensions)
            fields.append((name, wire_type, shape))
            size = wire_type.itemsize * int(np.prod(shape))
        offset += size
    return np.dtype(fields), counts


def _decode_channel(name, message_class, events_of_channel, remarks):
    """All events of one channel as one array, and their offsets in the file; those that do not fit the most common layout
    are left out."""
    fingerprint = message_class._get_packed_fingerprint()
    known = [event for event in events_of_channel if event[1][:8] == fingerprint]
    if len(known) < len(events_of_channel):
        remarks.append(f"{name}: {len(events_of_channel) - len(known)} messages of another version or damaged, not used")
    if not known:
        return None
    lengths = np.array([len(data) for _, data in known])
    values, votes = np.unique(lengths, return_counts=True)
    common = values[np.argmax(votes)]
    fitting = [event for event in known if len(event[1]) == common]
    try:
        layout, counts = wire_layout(message_class, fitting[0][1])
    except ValueError:
        layout, counts = None, {}
    if layout is None or layout.itemsize != common:
        remarks.append(f"{name}: {len(known)} messages whose array counts do not fit their length, not used")
        return None
    messages = np.frombuffer(b"".join(data for _, data in fitting), layout)
    same = np.ones(len(messages), bool)
    for count_name, count in counts.items():
        same &= messages[count_name] == count
    messages = messages[same]
    if len(messages) < len(known):
        remarks.append(f"{name}: {len(known) - len(messages)} messages truncated or of another size, not used")
    return messages.astype(layout.newbyteorder("=")), np.array([offset for offset, _ in fitting])[same]


def _key(name):
    """An answer counts by the ENCODER it answers: a controller that was started anew counts from 0 again."""
    return "answered_sequence" if name in ("TORQUE", "CONTROLLER_STATE") else "sequence"


def _differ(anchors):
    return len(anchors) > 1 and bool(np.any(anchors[:, :2] != anchors[0, :2]))


def _anchors(group):
    """(time, sequence, offset) of the messages that tell the runs of the group apart, in the order of the file."""
    best = np.zeros((0, 3), np.int64)
    for name in PLANT_CHANNELS:
        if name not in group:
            continue
        messages, offsets = group[name]
        rows = np.column_stack([messages["simulated_time"], messages["sequence"], offsets])
        if len(rows) > len(best):
            best = rows
        if name == "ENCODER" and _differ(rows):
            break
    return best


def _is_run(group):
    return _differ(_anchors(group)) or sum(name in group for name in PLANT_CHANNELS) > 1


def _segments(anchors):
    """Lists of anchors, one for each run, and the offsets of the messages that leap in time and do not go on."""
    if len(anchors) == 0:
        return [[]], set()
    steps = np.diff(anchors[:, 0].astype(float))
    sizes = np.sort(np.abs(steps[steps != 0.0]))
    leap = max(LEAP, USUAL_DISTANCES * sizes[len(sizes) // 2]) if len(sizes) else LEAP
    if np.all((steps >= -FALL_BACK) & (steps <= leap)):
        return [[anchors[0].tolist(), anchors[-1].tolist()]], set()

    def goes_on(before, after):
        step = after[0] - before[0]
        return step >= -FALL_BACK if step < 0 else step <= leap

    segments, leapt, strays = [], [], set()
    for anchor in anchors.tolist():
        on_run = bool(segments) and goes_on(segments[-1][-1], anchor)
        on_leapt = bool(leapt) and goes_on(leapt[-1], anchor)
        if on_run and not (on_leapt and anchor[0] < segments[-1][-1][0]):
            strays.update(each[2] for each in leapt)
            leapt = []
            segments[-1].append(anchor)
            continue
        if not on_leapt:
            strays.update(each[2] for each in leapt)
            leapt = []
        leapt.append(anchor)
        if leapt[0][:2] == anchor[:2]:
            continue
        if not segments or leapt[0][0] < segments[-1][-1][0]:
            segments.append([])
        segments[-1].extend(leapt)
        leapt = []
    if not segments:
        return [leapt], strays
    strays.update(each[2] for each in leapt)
    return segments, strays


def _segment_of(segments, messages, offsets):
    """Which run each message belongs to: the one around it in the file; between two the one whose time is nearer."""
    begins = np.array([segment[0][2] if segment else 0 for segment in segments])
    which = np.maximum(np.searchsorted(begins, offsets, side="right") - 1, 0)
    for number, (segment, following) in enumerate(zip(segments, segments[1:])):
        between = (which == number) & (offsets > segment[-1][2])
        for index in np.flatnonzero(between).tolist():
            time = int(messages["simulated_time"][index])
            which[index] += abs(following[0][0] - time) < abs(segment[-1][0] - time)
    return which


def _commonest(values):
    kinds, votes = np.unique(values, return_counts=True)
    return kinds[np.argmax(votes)], int(votes.max())


def _on_line(line, keys, times):
    period, offset = line
    since = (times.astype(np.uint64) - offset).astype(np.int64)
    return (since % period == 0) & (since // period == keys)


def _line(keys, times):
    """(period, offset) of time = offset + period * key where nine messages in ten lie on it, else None."""
    rising = (keys[1:] > keys[:-1]) & (times[1:] > times[:-1])
    key_steps = (keys[1:].astype(np.uint64) - keys[:-1].astype(np.uint64))[rising]
    time_steps = (times[1:].astype(np.uint64) - times[:-1].astype(np.uint64))[rising]
    periods = (time_steps // key_steps)[time_steps % key_steps == 0].astype(np.int64)
    if not np.any(periods > 0):
        return None
    period, _ = _commonest(periods[periods > 0])
    offset, votes = _commonest(times.astype(np.uint64) - period.astype(np.uint64) * keys.astype(np.uint64))
    return (period, offset) if 10 * votes >= 9 * len(keys) else None


def _in_order(keys, times):
    """Which messages stay if those go that spoil the order: by time, the longest row whose keys do not fall."""
    keys = keys.tolist()
    ends, end_keys, before = [], [], {}
    for index in np.argsort(times, kind="stable").tolist():
        place = bisect.bisect_right(end_keys, keys[index])
        before[index] = ends[place - 1] if place else None
        ends[place:place + 1] = [index]
        end_keys[place:place + 1] = [keys[index]]
    stays = np.zeros(len(keys), bool)
    index = ends[-1] if ends else None
    while index is not None:
        stays[index] = True
        index = before[index]
    return stays


def _that_stay(name, messages, known_line):
    keys, times = messages[_key(name)], messages["simulated_time"]
    own_line = None if name == "OPERATOR" else _line(keys, times)  # an operator moves when he likes
    for line in (known_line, own_line):
        if line is not None:
            on_line = _on_line(line, keys, times)
            if 2 * np.count_nonzero(on_line) > len(keys):
                return on_line
    stays = _in_order(keys, times)
    strays = np.count_nonzero(~stays)
    return np.ones(len(keys), bool) if strays > 1 and 100 * strays > len(keys) else stays


def _runs(group, left_out):
    """The runs of one pair of configuration and run identity: [(offset in the file, {channel: messages})]."""
    anchors = _anchors(group)
    segments, leapt = _segments(anchors)
    runs = [(segment[0][2] if segment else 0, {}) for segment in segments]
    lines = {}
    for name in MESSAGE_OF_CHANNEL:
        if name not in group:
            continue
        messages, offsets = group[name]
        stays = ~np.isin(offsets, np.array(sorted(leapt), dtype=offsets.dtype))
        which = _segment_of(segments, messages, offsets)
        for number, (_, channels) in enumerate(runs):
            mine = np.flatnonzero(stays & (which == number))
            if len(mine) == 0:
                continue
            if name == "ENCODER":  # the first of them: answers carry the time of the ENCODER they answer
                lines[number] = _line(messages[mine]["sequence"], messages[mine]["simulated_time"])
            known = lines.get(number) if _key(name) == "answered_sequence" else None
            good = _that_stay(name, messages[mine], known)
            stays[mine[~good]] = False
            if np.any(good):
                channels[name] = messages[mine[good]]
        for offset in offsets[~stays].tolist():
            left_out.setdefault(name, []).append(offset)
    return runs


def _is_event(content, at, end):
    """Whether the event from `at` to `end` has the length that its head says: no other one lies inside of it, and none
    begins there while none follows."""
    size = len(content)
    followed = end == size or content[end:end + 4] == SYNC_BYTES
    if end - at > LARGE_EVENT:
        return followed
    inner = content.find(SYNC_BYTES, at + 1, end if followed else end + 3)  # one may begin here and reach beyond
    while inner >= 0:
        if not followed:
            return False
        if inner + EVENT_HEAD.size <= end:
            _, _, _, channel_bytes, data_bytes = EVENT_HEAD.unpack_from(content, inner)
            if 0 < channel_bytes <= LONGEST_CHANNEL and inner + EVENT_HEAD.size + channel_bytes + data_bytes <= end:
                return False
        inner = content.find(SYNC_BYTES, inner + 1, end)
    return True


def printable(text):
    """A channel's name as it may be shown: bytes that are no printable ASCII as \\xNN, for a terminal obeys some of them."""
    return "".join(c if " " <= c <= "~" and c != "\\" else f"\\x{ord(c):02x}" for c in text)


def events(path, remarks):
    """(offset, channel, data) of every event in the log. Reads on through damage as msgs/log_reader does: where bytes are
    no event it looks for the next one, and a cut-off end ends the log; both are told in `remarks`."""
    content = path.read_bytes()
    size, at, skipped, stamp = len(content), 0, 0, None
    places = []

    def damaged(begin, end):
        behind = "" if stamp is None else f" behind {stamp / 1e6:.3f} s"
        places.append(f"{end - begin} at byte {begin}{behind}")

    lost_from = None
    while at + EVENT_HEAD.size <= size:
        sync, _, time, channel_bytes, data_bytes = EVENT_HEAD.unpack_from(content, at)
        end = at + EVENT_HEAD.size + channel_bytes + data_bytes
        if sync == SYNC_WORD and 0 < channel_bytes <= LONGEST_CHANNEL and end <= size and _is_event(content, at, end):
            if lost_from is not None:
                damaged(lost_from, at)
                lost_from = None
            begin = at + EVENT_HEAD.size
            stamp = time
            yield at, content[begin:begin + channel_bytes].decode("latin-1"), content[begin + channel_bytes:end]
            at = end
            continue
        following = content.find(SYNC_BYTES, at + 1)
        following = size if following < 0 else following
        lost_from = at if lost_from is None else lost_from
        skipped += following - at
        at = following
    skipped += size - at
    if lost_from is not None or size > at:
        damaged(at if lost_from is None else lost_from, size)
    if skipped:
        more = " ..." if len(places) > PLACES else ""
        remarks.append(f"{skipped} bytes of the file are no whole event (damaged or cut off), not used: "
                       f"{', '.join(places[:PLACES])}{more}")


class EventWriter:
    """Writes events as events() reads them. lcm.EventLog would take a full disk for a written event."""

    def __init__(self, path):
        self.stream, self.count = open(path, "wb"), 0

    def write(self, timestamp_us, channel, data):
        name = channel.encode()
        self.stream.write(EVENT_HEAD.pack(SYNC_WORD, self.count, timestamp_us, len(name), len(data)) + name + data)
        self.count += 1

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stream.close()


def read_run_log(path):
    """The run in the log. Where a file holds several, the one with the most messages is taken, and that is said."""
    path = Path(path)
    if not path.is_file():
        raise LogProblem(f"{path}: there is no such log")
    types = message_types()
    events_of = {name: [] for name in MESSAGE_OF_CHANNEL}
    others = {}
    log = RunLog(path)
    try:
        for offset, channel, data in events(path, log.remarks):
            if channel in events_of:
                events_of[channel].append((offset, data))
            else:
                others[channel] = others.get(channel, 0) + 1
    except OSError as error:
        raise LogProblem(f"{path}: not readable: {error}") from error

    for channel, count in sorted(others.items())[:FOREIGN_CHANNELS]:
        log.remarks.append(f"{printable(channel)}: {count} messages of a channel that is not slewlab's, not used")
    if len(others) > FOREIGN_CHANNELS:
        untold = sum(count for _, count in sorted(others.items())[FOREIGN_CHANNELS:])
        log.remarks.append(f"further channels are not slewlab's: {untold} messages, not used")
    decoded = {}
    for name, data in events_of.items():
        if data:
            messages = _decode_channel(name, getattr(types, MESSAGE_OF_CHANNEL[name]), data, log.remarks)
            if messages is not None and len(messages[0]):
                decoded[name] = messages
    if not decoded:
        raise LogProblem(f"{path}: holds no message of slewlab")

    groups = {}
    for name, (messages, offsets) in decoded.items():
        pairs, which = np.unique(
            np.column_stack([messages["configuration_hash"], messages["run_identity"]]), axis=0, return_inverse=True
        )
        for number, pair in enumerate(map(tuple, pairs.tolist())):
            mine = which.reshape(-1) == number
            groups.setdefault(pair, {})[name] = (messages[mine], offsets[mine])
    first_of = {pair: min(int(offsets[0]) for _, offsets in group.values()) for pair, group in groups.items()}
    in_file = sorted(groups, key=lambda pair: first_of[pair])
    of_runs = [pair for pair in in_file if _is_run(groups[pair])]
    if not of_runs:
        of_runs = [max(in_file, key=lambda pair: sum(len(offsets) for _, offsets in groups[pair].values()))]
    other_runs, strays, runs = {}, {}, []
    for pair in in_file:
        if pair in of_runs:
            runs += _runs(groups[pair], strays)
            continue
        for name, (_, offsets) in groups[pair].items():
            other_runs.setdefault(name, []).extend(offsets.tolist())
    for left_out, what in (
        (other_runs, "of another run or configuration"),
        (strays, "whose time or sequence number is at odds with the others"),
    ):
        for name, offsets in sorted(left_out.items()):
            where = ", the first at byte " if len(offsets) > 1 else ", at byte "
            log.remarks.append(f"{name}: {len(offsets)} messages {what} left out{where}{min(offsets)}")

    runs.sort(key=lambda run: run[0])
    chosen = max((channels for _, channels in runs), key=lambda channels: sum(map(len, channels.values())))
    if len(runs) > 1:
        size = sum(map(len, chosen.values()))
        log.remarks.append(f"the file holds {len(runs)} runs; used is the longest one, of {size} messages")
    for name, mine in chosen.items():
        _, first = np.unique(mine[_key(name)], return_index=True)
        if len(first) < len(mine):
            log.remarks.append(f"{name}: {len(mine) - len(first)} messages twice in the log, used once")
        log.channels[name] = mine[first]
    return log
