"""What of a machine's file (docs/axis.md) the import of its records needs: coordinate, ratio, sensors. The whole file is
read and checked by the C++ side (sim/machine)."""

import math
from dataclasses import dataclass
from pathlib import Path

import input_map

TURN = 2.0 * math.pi  # [rad]


@dataclass
class Axis:
    """A plain axis; `gear` is motor shaft per axis: turns per turn, [rad/m], or 1 where the shaft is the axis."""

    is_linear: bool
    is_shaft_linear: bool
    gear: float
    has_load_encoder: bool

    def units(self):
        """SI units of the log's signals, by message field."""
        shaft = ("m", "m/s", "N") if self.is_shaft_linear else ("rad", "rad/s", "N m")
        return dict(zip(("shaft_position", "shaft_speed", "motor_torque"), shaft)) | {"slew_angle": "m" if self.is_linear else "rad"}


def read_axis(path):
    """The axis in a machine's file; InputProblems where it is none, or what is read here is wrong."""
    path = Path(path)
    if not path.is_file():
        raise input_map.InputProblems([f"{path}: there is no such machine"])
    root, lines = input_map.load(path)
    included = root.text("include", "a file") if root.has("include") else None
    if included:  # the nearer file's keys stand before those of the included one
        base, _ = input_map.load(path.parent / included)
        root.entries = base.entries | root.entries
    root.choice("kind", ("axis",))
    if not root.has("kind"):
        root.report("kind", "nothing", "kind: axis")
    coordinate = root.map("coordinate", "{value: rotary or linear, source: ...}")
    is_linear = coordinate is not None and coordinate.choice("value", ("rotary", "linear"), "rotary") == "linear"
    ratio, travel = root.number("ratio", "number", None), root.number("travel_per_turn", "length", None)
    encoder = root.map("load_encoder", "") if root.has("load_encoder") else None
    has_load_encoder = encoder is not None and encoder.choice("value", ("true", "false"), "false") == "true"
    if lines:
        raise input_map.InputProblems(lines)
    gear = (TURN / travel if travel else 1.0) if is_linear else (ratio or 1.0)
    return Axis(is_linear, is_linear and travel is None, gear, has_load_encoder)
