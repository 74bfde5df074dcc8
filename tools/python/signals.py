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
