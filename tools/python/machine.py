"""What of a machine's file (docs/axis.md) the import of its records needs: coordinate, ratio, sensors."""

import json
from dataclasses import dataclass, field
from pathlib import Path

import input_map
from core_module import core


@dataclass
class Axis:
    """A plain axis; `gear` is motor shaft per axis: turns per turn, [rad/m], or 1 where the shaft is the axis."""

    is_linear: bool
    is_shaft_linear: bool
    gear: float
    has_load_encoder: bool
    top_speed: float = 0.0       # [rad/s or m/s] of the axis; 0: not known
    largest_torque: float = 0.0  # [N m or N] of the motor: what its drive allows, or the rated one where the file sets no limit; 0: not known
    rated_torque: float = 0.0    # [N m or N] of the motor; 0: not known
    described: dict = field(default_factory=dict)  # as run.json has it under `machine`

    def units(self):
        """SI units of the log's signals, by message field."""
        shaft = ("m", "m/s", "N") if self.is_shaft_linear else ("rad", "rad/s", "N m")
        return dict(zip(("shaft_position", "shaft_speed", "motor_torque"), shaft)) | {"slew_angle": "m" if self.is_linear else "rad"}

    def facts(self):
        """What stands beside a log of this axis, in the terms of run.json (tools/commands/run_facts.cpp)."""
        known = {"rated_torque": self.rated_torque, "top_speed": self.top_speed}
        return {name: value for name, value in known.items() if value} | {"total_ratio": self.gear, "machine": self.described}


def read_axis(path):
    """The axis in a machine's file; InputProblems where it is none, or anything in it is wrong."""
    path = Path(path)
    if not path.is_file():
        raise input_map.InputProblems([f"{path}: there is no such machine"])
    root, _ = input_map.load(path)
    if not root.says("kind", "axis"):
        root.report("kind", "another machine" if root.has("kind") else "nothing", "kind: axis")
        raise input_map.InputProblems(root.lines)
    try:
        machine = core.Machine(path, [])
    except core.InputError as problems:
        raise input_map.InputProblems(str(problems).splitlines()) from problems
    largest = None
    if root.has("drive_protection"):
        largest = root.map("drive_protection", "").number("torque_limit", "force" if machine.is_shaft_linear else "torque", None)
    return Axis(machine.is_linear, machine.is_shaft_linear, machine.total_ratio, machine.has_load_encoder, machine.top_speed,
                largest or machine.rated_torque, machine.rated_torque, json.loads(machine.facts))
