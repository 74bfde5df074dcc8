"""The log of an import: its messages in the order in which a lockstep run writes them, and the run's identity."""

import hashlib

import numpy as np

from event_rows import event_type, fill_heads
from import_map import fail_if_wrong
from run_log import message_types
from signals import measured

ROWS_AT_ONCE = 20_000     # that are written together


class Ranges:
    """Smallest and largest value of each signal while they go by, and where a request is largest."""

    def __init__(self):
        self.of, self.largest_request, self.at = {}, 0.0, 0

    def add(self, begin, values):
        for name, groups in values.items():
            for group, series in enumerate(groups):
                low, high = self.of.get((name, group), (np.inf, -np.inf))
                self.of[name, group] = min(low, float(np.min(series))), max(high, float(np.max(series)))
        if "speed_request" in values:
            request = np.abs(values["speed_request"][0])
            if request.max() > self.largest_request:
                self.largest_request, self.at = request.max(), begin + int(np.argmax(request))

    def check_request(self, mapping, row):
        if self.largest_request > 1.0 + 1e-9:
            mapping.signals["speed_request"][0].reader.report(
                "column", f"a request of {self.largest_request:.6g}, largest at {row(self.at)}",
                "shares of the top speed from -1 to 1; unit: \"%\" or a scale would make it so")
            fail_if_wrong(mapping)


def configuration_hash(text):
    """FNV-1a, 64 bits, as msgs/configuration_hash.h has it."""
    value = 0xCBF29CE484222325
    for byte in text.encode():
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value - (1 << 64) if value >= 1 << 63 else value


def identity_of(path):
    """What the file holds, as a run's identity: the log of other data is another run, and 0 is nobody's."""
    with open(path, "rb") as stream:
        digest = hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=8)).digest()
    return int.from_bytes(digest, "big", signed=True) or 1


def write_log(out, grid, signals, ranges, hash_of_map, identity):
    """All messages in the order in which a lockstep run writes them; returns counts by channel."""
    types = message_types()
    groups = {"group_count": len(signals["shaft_position"])}
    sensors = [name for name in measured("SENSORS") if name in signals]
    # What a row makes: ENCODER, the TORQUE that answers it, and SENSORS; an OPERATOR in front where the wish changes.
    parts = [("ENCODER", types.encoder_t, groups), ("TORQUE", types.torque_t, groups)]
    parts += [("SENSORS", types.sensors_t, None)] if sensors else []
    row_type = np.dtype([(channel, event_type(channel, kind, counts)) for channel, kind, counts in parts])
    move_type = event_type("OPERATOR", types.operator_t)
    written, moved, wish = 0, 0, None
    with open(out, "wb") as stream:
        for begin in range(0, len(grid), ROWS_AT_ONCE):
            times = grid[begin:begin + ROWS_AT_ONCE]
            k = begin + np.arange(len(times))
            values = {name: [values_of(begin, begin + len(times)) for values_of in entries] for name, entries in signals.items()}
            ranges.add(begin, values)

            def given(name, otherwise, group=0):
                return values[name][group] if name in values else np.full(len(times), otherwise)

            requests, stops = given("speed_request", 0.0), given("emergency_stop", False)
            before = wish or (np.nan, False)
            changed = (requests != np.append(before[0], requests[:-1])) | (stops != np.append(before[1], stops[:-1]))
            wish = requests[-1], stops[-1]
            moves_so_far = moved + np.cumsum(changed)
            first_numbers = written + len(parts) * np.arange(len(times)) + np.cumsum(changed)

            rows = np.zeros(len(times), row_type)
            for place, (channel, kind, counts) in enumerate(parts):
                fill_heads(rows[channel], channel, kind, first_numbers + place, times, counts)
                rows[channel]["sequence"], rows[channel]["configuration_hash"], rows[channel]["run_identity"] = k, hash_of_map, identity
            rows["ENCODER"]["operator_sequence"] = moves_so_far - 1
            rows["TORQUE"]["answered_sequence"], rows["TORQUE"]["alive_counter"] = k, k + 1
            rows["TORQUE"]["enable"], rows["TORQUE"]["brake"] = given("enable", True), given("brake", False)
            for group in range(groups["group_count"]):
                for name, channel in (("shaft_position", "ENCODER"), ("shaft_speed", "ENCODER"), ("motor_torque", "TORQUE")):
                    rows[channel][name][:, group] = given(name, 0.0, group)
            for name in measured("SENSORS") if sensors else ():
                rows["SENSORS"][name] = given(name, np.nan)

            at = np.flatnonzero(changed)
            moves = np.zeros(len(at), move_type)
            fill_heads(moves, "OPERATOR", types.operator_t, first_numbers[at] - 1, times[at])
            moves["sequence"], moves["configuration_hash"], moves["run_identity"] = moves_so_far[at] - 1, hash_of_map, identity
            moves["speed_request"], moves["emergency_stop"] = requests[at], stops[at]
            for number, (start, end) in enumerate(zip(np.append(0, at), np.append(at, len(rows)))):
                stream.write(rows[start:end].tobytes())
                if number < len(at):
                    stream.write(moves[number].tobytes())
            moved += len(at)
            written += len(parts) * len(rows) + len(at)
    counts = {"ENCODER": len(grid), "TORQUE": len(grid), "OPERATOR": moved}
    return counts | ({"SENSORS": len(grid)} if sensors else {})
