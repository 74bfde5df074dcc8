"""The map of an import: what the columns of measured data mean (docs/import.md), read key by key, and what leads from each
column to its signal of the wire. Signals in the messages' units and axes:

    shaft angle or speed = sign * scale * (column - offset) * ratio, or / metres_per_radian of a linear axis
    motor torque         = sign * scale * (column - offset) / (ratio * motors), or * metres_per_radian

Of a plain axis (`machine: axis.yaml` in the map, docs/axis.md) ratio and travel are its file's, and a column says whether
it stands on the axis or on the shaft.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import input_map
from input_map import InputProblems
from machine import read_axis
from signals import measured, unit_of
from unit import factor_to_si, quantity_of, spellings_of

FLAGS = ("emergency_stop", "enable", "brake")
DERIVATIVES = ("two_sample_mean", "central_difference", "backward_difference")
MOST_GROUPS = 8           # sim/model/crane_parameters.h
ONE_OF_DERIVATIVES = f"a column with its unit, or {{derive: one of {', '.join(DERIVATIVES)}}}"
ANGULAR_AND_LINEAR = {"position": ("angle", "length"), "speed": ("angular speed", "speed"), "torque": ("torque", "force")}
PLACEHOLDER = "REPLACE"  # begins what `slewlab new map` leaves to its user
TO_BE_REPLACED = {"column": "the name of a column of the data", "source": "a value of your own, and where it is from"}
# Of what kind a signal is, and the message's field that says so.
FIELD_OF_KIND = {"position": ("ENCODER", "shaft_position"), "speed": ("ENCODER", "shaft_speed"), "torque": ("TORQUE", "motor_torque"),
                 "number": ("OPERATOR", "speed_request")}


@dataclass
class Signal:
    name: str             # message field, and [group] where there are several
    column: str | None    # None: derived
    reader: object        # where it stands in the map, for complaints
    factor: float = 1.0   # of (column - offset), to the message's unit
    offset: float = 0.0   # in the column's unit
    derive: str | None = None
    inverted: bool = False
    unit: str = ""        # of the message's field
    column_unit: str = ""
    turn: float | None = None    # of the column's angle, in the column's own numbers; None: no angle of a motion
    unwrap: float | None = None  # after how much the column begins anew, in its own numbers


@dataclass
class ImportMap:
    path: Path
    reader: object
    lines: list           # problems
    separator: str
    decimal: str
    skip_lines: int
    first_row: int
    last_row: int | None
    time: object          # reader of the map's part
    time_column: str | None
    time_factor: float | None   # None: date and time
    origin: float | None        # [s]; None: first row
    period: float | None        # [s]; None: as the rows are
    resample: str | None
    signals: dict         # message field: list of Signal, one per group
    machine: object = None  # an axis; None: ratios stand in the map


def wire_unit(name, kind):
    return measured("SENSORS").get(name) or unit_of(*FIELD_OF_KIND[kind])


def axis_factor(reader, kind, unit, factor, machine):
    """The factor to the motor shaft of a column on the axis or on the shaft of a plain axis."""
    for key in ("ratio", "metres_per_radian"):
        if reader.has(key):
            reader.report(key, f"'{key}' beside a machine", "what the machine's file says; 'on: axis' for a column on the axis")
    angular, linear = ANGULAR_AND_LINEAR[kind]
    on_axis, on_shaft = (linear if machine.is_linear else angular), (linear if machine.is_shaft_linear else angular)
    place = reader.choice("on", ("axis", "shaft"))
    if factor is None:
        return None
    is_of_axis, is_of_shaft = (factor_to_si(quantity, unit) is not None for quantity in (on_axis, on_shaft))
    if place is None:
        if is_of_axis and is_of_shaft and machine.gear != 1.0:
            reader.report("on", "nothing", f"axis or shaft: {unit} may be either of the two, {machine.gear:.6g} apart")
            return None
        place = "axis" if is_of_axis else "shaft"
    if not (is_of_axis if place == "axis" else is_of_shaft):
        quantity = on_axis if place == "axis" else on_shaft
        reader.report("unit", f"{unit} on the {place}", f"a unit of {quantity}: {spellings_of(quantity)}")
        return None
    gear = machine.gear if place == "axis" else 1.0
    return factor / gear if kind == "torque" else factor * gear


def read_signal(reader, name, kind, machine=None):
    """One signal of the map: column, unit and what leads from the column to the message."""
    column = reader.text("column", "the name of a column of the data")
    found = Signal(name, column, reader)
    sign = reader.choice("sign", ("1", "+1", "-1"), "1")
    if kind == "flag":
        found.inverted = reader.flag("inverted")
        reader.finish()
        return found
    unit = reader.text("unit", "the column's unit")
    found.column_unit = unit or ""
    scale = reader.number("scale", "number", 1.0)
    found.offset = 0.0
    angular, linear = ANGULAR_AND_LINEAR.get(kind, (kind, None))
    if machine and name == "load_position" and machine.is_linear:
        angular = "length"
    factor = reader.factor(unit, angular, linear) if linear else reader.factor(unit, angular)
    if reader.has("offset"):
        offset = reader.number("offset", quantity_of(unit or "-") or "number", 0.0, positive=False)
        found.offset = offset / (factor or 1.0)
    is_linear = linear is not None and factor is not None and factor_to_si(linear, unit) is not None
    is_position = kind == "position" or name in ("load_position", "slew_angle")
    if is_position and reader.has("unwrap"):
        found.unwrap = (reader.number("unwrap", quantity_of(unit or "-") or "number", None) or 0.0) / abs((factor or 1.0) * scale) or None
    if is_position and factor is not None and factor_to_si("angle", unit) is not None:
        found.turn = 2.0 * math.pi / (factor * scale)
    if machine and linear:
        factor = axis_factor(reader, kind, unit, factor, machine)
        motors = reader.integer("motors", 1, 1) if kind == "torque" else 1
        factor = None if factor is None else factor / motors
    elif linear:
        travel = reader.number("metres_per_radian", "length", None)
        ratio = reader.number("ratio", "number", None)
        if is_linear and travel is None and not reader.has("metres_per_radian"):
            reader.report("metres_per_radian", f"nothing, beside a column in {unit}",
                          "the axis's travel per radian of the motor shaft: {value: 0.01, unit: m, source: ...}")
        if is_linear and reader.has("ratio"):
            reader.report("ratio", f"a gear ratio beside a column in {unit}", "metres_per_radian alone on a linear axis")
        if not is_linear and factor is not None and reader.has("metres_per_radian"):
            reader.report("metres_per_radian", f"a travel per radian beside a column in {unit}",
                          f"a column in a unit of {linear}: {spellings_of(linear)}")
        gear = 1.0 / (travel or 1.0) if is_linear else (ratio or 1.0)
        motors = reader.integer("motors", 1, 1) if kind == "torque" else 1
        factor = None if factor is None else (factor / (gear * motors) if kind == "torque" else factor * gear)
    elif kind == "angle" and not machine:
        factor = None if factor is None else factor * reader.number("ratio", "number", 1.0)
    found.factor = (factor or 1.0) * scale * (-1.0 if sign == "-1" else 1.0)
    of_axis = machine.units() if machine else {}
    found.unit = of_axis.get("slew_angle" if name == "load_position" else name) or wire_unit(name, kind)
    reader.finish()
    return found


def read_map(path):
    if not path.is_file():
        raise InputProblems([f"{path}: there is no such map"])
    root, lines = input_map.load(path)
    machine = machine_named(root)
    found = read_root(root, lines, path, None if machine is None else read_axis(path.parent / machine))
    lines.extend(placeholders(root.node))
    return found


def placeholders(node, path=""):
    """What of the map still has to be replaced, a line each."""
    for key, _, _, value in node.entries:
        where = f"{path}.{key}".lstrip(".")
        if key in TO_BE_REPLACED and value.scalar.startswith(PLACEHOLDER):
            yield f"{value.file}:{value.line}:{value.column}: key '{where}': found {value.scalar}, expected {TO_BE_REPLACED[key]}"
        yield from placeholders(value, where)
    for i, item in enumerate(node.items):
        yield from placeholders(item, f"{path}[{i + 1}]")


def machine_named(root):
    return root.text("machine", "the axis's file") if root.has("machine") else None


def read_root(root, lines, path, machine):
    """The map below its root; `machine` is the axis that it names. map_schema asks it for its keys."""
    kind = root.text("kind", "import_map")
    if kind not in (None, "import_map"):
        root.report("kind", kind, "import_map")
    root.has("description")

    table = root.map("csv", "") if root.has("csv") else None
    separator = table.choice("separator", (",", ";", "tab"), ",") if table else ","
    decimal = table.choice("decimal", (".", ","), ".") if table else "."
    skip_lines = table.integer("skip_lines", 0, 0) if table else 0
    if table:
        table.finish()
    rows = root.map("rows", "") if root.has("rows") else None
    first_row = rows.integer("first", 1, 1) if rows else 1
    last_row = rows.integer("last", 1, None) if rows else None
    if rows:
        if last_row is not None and last_row < first_row + 2:
            rows.report("last", str(last_row), f"at least {first_row + 2}, three rows from rows.first on")
        rows.finish()

    time = root.map("time", "{column: NAME, unit: one of s, ms, us, min, h, datetime}: the times of the rows")
    time_column = time_factor = origin = None
    if time:
        time_column = time.text("column", "the name of the column that holds the time")
        unit = time.text("unit", f"one of {spellings_of('time')}, datetime")
        if unit != "datetime":
            time_factor = time.factor(unit, "time")
        if time.has("origin") and not time.says("origin", "first_row"):
            origin = time.number("origin", "time", None, positive=False)
        time.finish()
    rate = root.number("rate", "frequency", None)
    resample = root.choice("resample", ("linear", "mean"))

    signals = {}
    for name, signal_kind in (("shaft_position", "position"), ("shaft_speed", "speed"), ("motor_torque", "torque")):
        expected = "a list with one entry per motor group, each with column and unit"
        if name == "shaft_speed":
            expected = f"a list with one entry per motor group, each with {ONE_OF_DERIVATIVES}"
        signals[name] = []
        for reader in root.maps(name, expected):
            if name == "shaft_speed" and reader.has("derive"):
                derive = reader.choice("derive", DERIVATIVES)
                if reader.has("column"):
                    reader.report("column", "a column beside derive", "one of the two")
                reader.finish()
                unit = machine.units()[name] if machine else wire_unit(name, signal_kind)
                signals[name].append(Signal(name, None, reader, derive=derive, unit=unit))
            else:
                signals[name].append(read_signal(reader, name, signal_kind, machine))
    for name, unit in () if machine else measured("SENSORS").items():
        if root.has(name):
            signals[name] = [read_signal(root.map(name, ""), name, quantity_of(unit))]
    if machine and root.has("load_position"):
        if not machine.has_load_encoder:
            root.report("load_position", "a load-side encoder", "load_encoder: {value: true, source: ...} in the machine's file")
        signals["slew_angle"] = [read_signal(root.map("load_position", ""), "load_position", "angle", machine)]
    if root.has("speed_request"):
        signals["speed_request"] = [read_signal(root.map("speed_request", ""), "speed_request", "number")]
    for name in FLAGS:
        if root.has(name):
            signals[name] = [read_signal(root.map(name, ""), name, "flag")]
    root.finish()

    groups = len(signals["shaft_position"])
    if machine and groups > 1:
        root.report("shaft_position", f"{groups} groups", "one: the motor of the axis")
    if groups > MOST_GROUPS:
        root.report("shaft_position", f"{groups} groups", f"at most {MOST_GROUPS}")
    for name in ("shaft_speed", "motor_torque"):
        count = len(signals[name])
        if count and groups and count != groups:
            root.report(name, f"{count} groups", f"{groups}, as many as shaft_position has")
    for name in ("shaft_position", "shaft_speed", "motor_torque"):
        for group, entry in enumerate(signals[name]):
            entry.name = f"{name}[{group + 1}]"
    used = {time_column: "time"}
    for entry in (e for entries in signals.values() for e in entries if e.column is not None):
        if entry.column in used:
            entry.reader.report("column", f"'{entry.column}', which is {used[entry.column]} already",
                                "a column of its own for each signal")
        used[entry.column] = entry.name
    return ImportMap(path, root, lines, separator, decimal, skip_lines, first_row, last_row, time, time_column,
                     time_factor, origin, None if rate is None else 1.0 / rate, resample, signals, machine)


def fail_if_wrong(mapping):
    if mapping.lines:
        raise InputProblems(mapping.lines)
