"""Turns a run's log into files that other tools read: Parquet or CSV (one per channel), or one MCAP.

    slewlab export RUN.lcmlog --format parquet|csv|mcap [--out PATH]

Parquet and CSV: the first column is `time` [s], simulated; arrays become columns name_1, name_2, ...; SI units as
in msgs/*.lcm; a Parquet column has its unit as the field's metadata `unit`. Columns of a plain axis (run.json beside the log says so) carry the axis's names and units, motor_speed [rad/s],
and those of sensors that it has not are left out. MCAP: JSON messages with their schema, in which each field's `description` is its unit, stamped with the simulated time; opens in Foxglove and
PlotJuggler.
"""

import argparse
import json
import signal
import sys
from pathlib import Path

import pandas as pd
import pyarrow
import pyarrow.parquet
from mcap.writer import Writer

from run_log import LogProblem, read_run_log, seconds
from signals import table, unit_of
from whole_file import growing

FORMATS = ("parquet", "csv", "mcap")


def axis_columns(path, log):
    """{channel: {column: name of the axis's signal, None to leave it out}}; nothing for a crane."""
    facts = path.parent / "run.json"
    machine = json.loads(facts.read_text()).get("machine", {}) if path.stem == "run" and facts.is_file() else {}
    if machine.get("kind") != "axis":
        return {}
    torque = machine["efforts"][0]
    names = {"TORQUE": {"motor_torque_1": f"{torque['name'].replace(' ', '_')} [{torque['unit']}]"}, "SENSORS": {}}
    for sensor in machine["sensors"]:
        column = sensor["field"] if sensor["channel"] == "SENSORS" else f"{sensor['field']}_1"
        names.setdefault(sensor["channel"], {})[column] = f"{sensor['name'].replace(' ', '_')} [{sensor['unit']}]"
    if log.has("SENSORS"):
        for column in ("house_acceleration", "pivot_acceleration", "middle_acceleration", "tip_acceleration", "slew_angle"):
            names["SENSORS"].setdefault(column, None)
    return names


def channel_table(messages, axis=None):
    """One channel as a table: time [s], then every field; array entries count from 1 as motor groups do."""
    columns = {"time": seconds(messages)}
    for name in messages.dtype.names:
        if name in ("fingerprint", "simulated_time"):
            continue
        values = messages[name]
        if values.ndim == 1:
            columns[name] = values
        else:
            for entry in range(values.shape[1]):
                columns[f"{name}_{entry + 1}"] = values[:, entry]
    renamed = {(axis or {}).get(name, name): values for name, values in columns.items()}
    renamed.pop(None, None)
    return pd.DataFrame(renamed)


def with_units(frame, channel, axis):
    """The table with each column's unit in its metadata; an axis's names say theirs."""
    original = {new: old for old, new in (axis or {}).items() if new}
    arrow = pyarrow.Table.from_pandas(frame, preserve_index=False)
    for place, column in enumerate(arrow.schema.names):
        name = original.get(column, column)
        unit = "s" if name == "time" else column.rpartition("[")[2].rstrip("]") if column in original else unit_of(channel, name)
        arrow = arrow.set_column(place, arrow.schema.field(place).with_metadata({"unit": unit}), arrow.column(place))
    return arrow


def write_tables(log, out, file_format):
    """A folder with one file per channel; it appears when all of them are complete."""
    with growing(out) as partial:
        partial.mkdir()
        axis = axis_columns(log.path, log)
        for name, messages in log.channels.items():
            frame = channel_table(messages, axis.get(name))
            if file_format == "parquet":
                pyarrow.parquet.write_table(with_units(frame, name, axis.get(name)), partial / f"{name}.parquet")
            else:
                frame.to_csv(partial / f"{name}.csv", index=False)


def _json_type(field_type):
    base = field_type.base
    kind = {"b": "boolean", "i": "integer", "u": "integer", "f": "number"}[base.kind]
    return {"type": "array", "items": {"type": kind}} if field_type.shape else {"type": kind}


def write_mcap(log, out):
    """One file; events in the order of simulated time."""
    with growing(out) as partial, open(partial, "wb") as stream:
        writer = Writer(stream)
        writer.start(profile="", library="slewlab")
        events = []
        for name, messages in log.channels.items():
            fields = [f for f in messages.dtype.names if f != "fingerprint"]
            schema = {"title": name, "type": "object",
                      "properties": {f: _json_type(messages.dtype[f]) | {"description": table()[name][f]} for f in fields}}
            schema_id = writer.register_schema(name=f"slewlab.{name}", encoding="jsonschema",
                                               data=json.dumps(schema).encode())
            channel_id = writer.register_channel(topic=name, message_encoding="json", schema_id=schema_id)
            lists = [messages[f].tolist() for f in fields]
            for values in zip(*lists):
                message = dict(zip(fields, values))
                events.append((message["simulated_time"], channel_id, message["sequence"], message))
        for time, channel_id, sequence, message in sorted(events, key=lambda event: event[:3]):
            writer.add_message(channel_id=channel_id, log_time=time, publish_time=time, sequence=sequence & 0xFFFFFFFF,
                               data=json.dumps(message).encode())
        writer.finish()


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="slewlab export", description="Turns a log into files of other tools.")
    parser.add_argument("log", type=Path, help="the log, or the folder that holds run.lcmlog")
    parser.add_argument("--format", choices=FORMATS, required=True)
    parser.add_argument("--out", type=Path,
                        help="folder (parquet, csv) or file (mcap); default: beside the log, run_FORMAT or run.mcap")
    options = parser.parse_args(arguments)
    path = options.log / "run.lcmlog" if options.log.is_dir() else options.log
    try:
        log = read_run_log(path)
        if options.format == "mcap":
            out = options.out or path.with_suffix(".mcap")
            write_mcap(log, out)
        else:
            out = options.out or path.with_name(f"{path.stem}_{options.format}")
            if out.exists() and not (out.is_dir() and all(f.suffix == f".{options.format}" for f in out.iterdir())):
                raise LogProblem(f"{out}: is there already and is no earlier export; name another with --out")
            write_tables(log, out, options.format)
    except (LogProblem, OSError) as problem:
        print(f"export: {problem}", file=sys.stderr)
        return 1
    for remark in log.remarks:
        print(remark)
    counts = ", ".join(f"{name} {len(messages)}" for name, messages in log.channels.items())
    print(f"{out}: {counts}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
