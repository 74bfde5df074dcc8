"""What a signal of a map (tools/plc/plc_map.h) is in the PLC's own types, and back. A number beyond its type's range is held at the range's end, and
no number (an encoder without a signal) is the lowest there is: a PLC that looks at what it reads refuses it."""

import math
import struct

FORMATS = {"int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}
BITS = {name: 8 * struct.calcsize(">" + code) for name, code in FORMATS.items()}
LARGEST_FLOAT32 = 3.4028234663852886e38
COUNTERS = ("alive_counter", "answered_counter")


def span(kind):
    """The lowest and the highest number of an integer type."""
    bits = BITS[kind]
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if kind.startswith("int") else (0, (1 << bits) - 1)


def encode(signal, value):
    """The PLC's number of a signal: in SI, a flag, or a counter, which wraps."""
    if signal.type == "bool":
        return bool(value) != signal.inverted
    if signal.name in COUNTERS:
        count = int(value) & ((1 << BITS[signal.type]) - 1)
        return count - (1 << BITS[signal.type]) if count > span(signal.type)[1] else count
    if signal.name == "mode":
        return int(value)
    number = value / signal.scale
    if signal.type == "float64":
        return number
    if signal.type == "float32":
        return number if not math.isfinite(number) else max(-LARGEST_FLOAT32, min(LARGEST_FLOAT32, number))
    lowest, highest = span(signal.type)
    if math.isnan(number):
        return lowest
    return highest if number >= highest else lowest if number <= lowest else round(number)


def decode(signal, number):
    if signal.type == "bool":
        return bool(number) != signal.inverted
    if signal.name in COUNTERS:
        return int(number) & ((1 << BITS[signal.type]) - 1)
    if signal.name == "mode":
        return int(number)
    return number * signal.scale


def advance(signal, before, now):
    """By how much a counter went on; it wraps where its type does."""
    return (now - before) & ((1 << BITS[signal.type]) - 1)


def words_of(signal, number, high_word_first):
    """The registers of a Modbus server that hold a number."""
    data = struct.pack(">" + FORMATS[signal.type], number)
    words = list(struct.unpack(f">{len(data) // 2}H", data))
    return words if high_word_first else words[::-1]


def number_in(signal, words, high_word_first):
    ordered = words if high_word_first else words[::-1]
    return struct.unpack(">" + FORMATS[signal.type], struct.pack(f">{len(ordered)}H", *ordered))[0]


def word_count(signal):
    return 1 if signal.type == "bool" else BITS[signal.type] // 16
