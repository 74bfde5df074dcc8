"""Events of LCM's log format, many at a time: a numpy type that is an event of one channel byte for byte, with the message
in it as lcm-gen's class describes it."""

import numpy as np

SYNC_WORD = 0xEDA1DA01

# LCM's types on the wire, big-endian.
WIRE_TYPES = {"int8_t": "i1", "boolean": "?", "byte": "u1", "int16_t": ">i2", "int32_t": ">i4", "int64_t": ">i8", "float": ">f4",
              "double": ">f8"}
# Sync word, number, time stamp, length of the channel's name, length of the data.
HEAD = [("sync", ">u4"), ("number", ">i8"), ("stamp", ">i8"), ("name_bytes", ">u4"), ("data_bytes", ">u4")]


def event_type(channel, message_class, counts=None):
    """`counts`: the lengths of its arrays, by the name of the field that says it."""
    fields = [(name, WIRE_TYPES[kind]) if dimensions is None else (name, WIRE_TYPES[kind], ((counts or {})[dimensions[0]],))
              for name, kind, dimensions in zip(message_class.__slots__, message_class.__typenames__, message_class.__dimensions__)]
    return np.dtype([*HEAD, ("channel", f"S{len(channel)}"), ("fingerprint", "S8"), *fields])


def fill_heads(events, channel, message_class, numbers, times, counts=None):
    """What every event of the channel has, in place: `numbers` in the file, simulated `times` [ns]."""
    events["sync"], events["number"], events["stamp"] = SYNC_WORD, numbers, times // 1000
    events["name_bytes"], events["channel"] = len(channel), channel.encode()
    events["data_bytes"] = events.dtype.itemsize - sum(np.dtype(kind).itemsize for _, kind in HEAD) - len(channel)
    events["fingerprint"] = message_class._get_packed_fingerprint()
    events["simulated_time"] = times
    for name, count in (counts or {}).items():
        events[name] = count
