"""Reads a run's log (run.lcmlog) into numpy arrays: one structured array per channel, a field per message field.

The layout comes from the classes that lcm-gen makes of msgs/*.lcm at build time (build/release/python), so a whole
channel is decoded at once. What cannot be used is told in `remarks`, one line each.
"""

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

FALL_BACK = 1_000_000_000  # [ns] simulated time that falls back by more begins another run


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


def message_types():
    """The module that lcm-gen made. SLEWLAB_PYTHON_MESSAGES names another folder than build/release/python."""
    folder = Path(os.environ.get("SLEWLAB_PYTHON_MESSAGES", REPOSITORY / "build" / "release" / "python"))
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


def _decode_channel(name, message_class, payloads, remarks):
    """All payloads of one channel as one array; those that do not fit the most common layout are left out."""
    fingerprint = message_class._get_packed_fingerprint()
    known = [p for p in payloads if p[:8] == fingerprint]
    if len(known) < len(payloads):
        remarks.append(f"{name}: {len(payloads) - len(known)} messages of another version or damaged, not used")
    if not known:
        return None
    lengths = np.array([len(p) for p in known])
    values, votes = np.unique(lengths, return_counts=True)
    common = values[np.argmax(votes)]
    fitting = [p for p in known if len(p) == common]
    try:
        layout, counts = wire_layout(message_class, fitting[0])
    except ValueError:
        layout, counts = None, {}
    if layout is None or layout.itemsize != common:
        remarks.append(f"{name}: {len(known)} messages whose array counts do not fit their length, not used")
        return None
    messages = np.frombuffer(b"".join(fitting), layout)
    same = np.ones(len(messages), bool)
    for count_name, count in counts.items():
        same &= messages[count_name] == count
    messages = messages[same]
    if len(messages) < len(known):
        remarks.append(f"{name}: {len(known) - len(messages)} messages truncated or of another size, not used")
    return messages.astype(layout.newbyteorder("="))


def _run_numbers(times):
    """Which run each message belongs to, in file order: another one begins where simulated time falls back."""
    runs = np.zeros(len(times), int)
    newest, run = times[0], 0
    for index, time in enumerate(times.tolist()):
        if time < newest - FALL_BACK:
            run += 1
            newest = time
        newest = max(newest, time)
        runs[index] = run
    return runs


def events(path, remarks):
    """(channel, data) of every event in the log. Reads on through damage as msgs/log_reader does: where bytes are no
    event it looks for the next one, and a cut-off end ends the log; both are told in `remarks`."""
    content = path.read_bytes()
    size, at, skipped = len(content), 0, 0
    while at + EVENT_HEAD.size <= size:
        sync, _, _, channel_bytes, data_bytes = EVENT_HEAD.unpack_from(content, at)
        end = at + EVENT_HEAD.size + channel_bytes + data_bytes
        if sync == SYNC_WORD and 0 < channel_bytes <= LONGEST_CHANNEL and end <= size:
            begin = at + EVENT_HEAD.size
            yield content[begin:begin + channel_bytes].decode("latin-1"), content[begin + channel_bytes:end]
            at = end
            continue
        following = content.find(SYNC_BYTES, at + 1)
        following = size if following < 0 else following
        skipped += following - at
        at = following
    skipped += size - at
    if skipped:
        remarks.append(f"{skipped} bytes of the file are no whole event (damaged or cut off), not used")


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
    payloads = {name: [] for name in MESSAGE_OF_CHANNEL}
    others = {}
    log = RunLog(path)
    try:
        for channel, data in events(path, log.remarks):
            if channel in payloads:
                payloads[channel].append(data)
            else:
                others[channel] = others.get(channel, 0) + 1
    except OSError as error:
        raise LogProblem(f"{path}: not readable: {error}") from error

    for channel, count in sorted(others.items()):
        log.remarks.append(f"{channel}: {count} messages of a channel that is not slewlab's, not used")
    decoded = {}
    for name, data in payloads.items():
        if data:
            messages = _decode_channel(name, getattr(types, MESSAGE_OF_CHANNEL[name]), data, log.remarks)
            if messages is not None and len(messages):
                decoded[name] = messages
    if not decoded:
        raise LogProblem(f"{path}: holds no message of slewlab")

    runs_of = {name: _run_numbers(messages["simulated_time"]) for name, messages in decoded.items()}
    sizes = {}
    for name, messages in decoded.items():
        keys, votes = np.unique(
            np.column_stack([messages["configuration_hash"], runs_of[name]]), axis=0, return_counts=True
        )
        for key, count in zip(map(tuple, keys.tolist()), votes.tolist()):
            sizes[key] = sizes.get(key, 0) + count
    chosen = max(sizes, key=lambda key: (sizes[key], -key[1]))
    if len(sizes) > 1:
        log.remarks.append(f"the file holds {len(sizes)} runs; used is the longest one, of {sizes[chosen]} messages")

    for name, messages in decoded.items():
        mine = messages[(messages["configuration_hash"] == chosen[0]) & (runs_of[name] == chosen[1])]
        _, first = np.unique(mine["sequence"], return_index=True)
        if len(first) < len(mine):
            log.remarks.append(f"{name}: {len(mine) - len(first)} messages twice in the log, used once")
        if len(first):
            log.channels[name] = mine[first]
    return log
