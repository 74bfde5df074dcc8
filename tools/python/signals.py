"""The signals of the wire with their units: the table that the build makes of msgs/*.lcm (msgs/layouts.cmake)."""

import functools
import json

from run_log import messages_folder


@functools.cache
def table():
    """{channel: {field: unit}}; "-" where the .lcm file gives none."""
    return json.loads((messages_folder() / "signals.json").read_text())


HEAD = ("sequence", "simulated_time", "configuration_hash", "run_identity")  # of every message of the plant


def measured(channel):
    """{field: unit} of what a message says beside its head."""
    return {field: unit for field, unit in table()[channel].items() if field not in HEAD}


def unit_of(channel, column):
    """The unit of a field, or of a column that is one entry of an array field (shaft_speed_2)."""
    fields = table()[channel]
    name = column if column in fields else column.rpartition("_")[0]
    return fields[name]


# What of the table of signals is a plain axis's own, at its motor's shaft and on the axis: its units there are the machine's.
AT_SHAFT = {"ENCODER": ("shaft_position", "shaft_speed"), "TORQUE": ("motor_torque",),
            "CONTROLLER_STATE": ("average_torque", "offset_torque", "proportional_torque", "integral_torque")}
ON_AXIS = {"TRUTH": ("gearbox_torque", "gear_deflection", "house_speed"), "CONTROLLER_STATE": ("ramped_speed",), "SENSORS": ("slew_angle",)}


def units_of(facts):
    """{channel: {field: unit}}: the table of signals, with the units of the machine that run.json describes."""
    machine, units = facts.get("machine", {}), {channel: dict(fields) for channel, fields in table().items()}
    if machine.get("kind") != "axis":
        return units
    shaft = {sensor["field"]: sensor["unit"] for sensor in machine["sensors"] if sensor["channel"] == "ENCODER"}
    torque, on_axis = machine["efforts"][:2]
    for fields, own in ((AT_SHAFT, {"rad": shaft["shaft_position"], "rad/s": shaft["shaft_speed"], "Nm": torque["unit"]}),
                        (ON_AXIS, {"rad": machine["position_unit"], "rad/s": machine["speed_unit"], "Nm": on_axis["unit"]})):
        for channel, names in fields.items():
            units[channel] |= {name: own[units[channel][name]] for name in names}
    return units
