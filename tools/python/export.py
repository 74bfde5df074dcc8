"""Turns a run's log into files that other tools read: Parquet or CSV (one per channel), or one MCAP.

    slewlab export RUN.lcmlog --format parquet|csv|mcap [--out PATH]

Parquet and CSV: the first column is `time` [s], simulated; arrays become columns name_1, name_2, ...; SI units as
in msgs/*.lcm, of a plain axis its own; a Parquet column has its unit as the field's metadata `unit`, a CSV column in its name: `shaft_speed_1 [rad/s]`. Columns of a
plain axis (run.json beside the log says so) carry the axis's names and units, motor_speed [rad/s], and those of sensors that it has not are
left out.
MCAP: Protobuf messages with their schema, the unit of each field in the channel's metadata, stamped with the simulated
time; opens in Foxglove and PlotJuggler. The log is gone through a stretch at a time and may be larger than memory.
"""

import contextlib
import signal
import struct
import sys
from argparse import ArgumentTypeError
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.csv
import pyarrow.parquet
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC, CompressionType

from arguments import ArgumentParser, output_file, output_folder
from mcap_batches import BatchWriter
from protobuf_rows import ProtobufRows
from run_log import LogProblem, beside_its_run, seconds
from run_numbers import early_end, read_run
from signals import measured, table, units_of
from whole_file import growing, is_free

FORMATS = ("parquet", "csv", "mcap")
ROW_GROUP = 4 << 20  # [bytes] of a Parquet file's rows that are written together
LIBRARY = "slewlab"
# Another program's MCAP is somebody's recording: the header names who wrote it (MCAP's specification, Header: profile, library).
MCAP_BEGINNING = MCAP0_MAGIC + struct.pack("<BQII", Opcode.HEADER, 8 + len(LIBRARY), 0, len(LIBRARY)) + LIBRARY.encode()


def axis_columns(facts, log):
    """{channel: {column: name of the axis's signal, None to leave it out}}; nothing for a crane."""
    machine = facts.get("machine", {})
    if machine.get("kind") != "axis":
        return {}
    torque = machine["efforts"][0]
    names = {"TORQUE": {"motor_torque_1": f"{torque['name'].replace(' ', '_')} [{torque['unit']}]"}, "SENSORS": {}}
    for sensor in machine["sensors"]:
        column = sensor["field"] if sensor["channel"] == "SENSORS" else f"{sensor['field']}_1"
        names.setdefault(sensor["channel"], {})[column] = f"{sensor['name'].replace(' ', '_')} [{sensor['unit']}]"
    if log.has("SENSORS"):
        for column in measured("SENSORS"):
            names["SENSORS"].setdefault(column, None)
    return names


def channel_columns(dtype, axis=None):
    """[(name, field, entry or None)] of one channel: time [s], then every field; array entries count from 1 as motor groups
    do."""
    columns = [("time", "simulated_time", None)]
    for name in dtype.names:
        if name == "simulated_time":
            continue
        shape = dtype[name].shape
        columns += [(f"{name}_{entry + 1}", name, entry) for entry in range(shape[0])] if shape else [(name, name, None)]
    renamed = [((axis or {}).get(name, name), field, entry) for name, field, entry in columns]
    return [column for column in renamed if column[0] is not None]


def channel_schema(units, dtype, axis=None):
    """The columns' types, each with its unit as metadata; `units` of the channel's fields."""
    fields = []
    for column, field, _ in channel_columns(dtype, axis):
        is_time = field == "simulated_time"
        kind = pyarrow.float64() if is_time else pyarrow.from_numpy_dtype(dtype[field].base)
        fields.append(pyarrow.field(column, kind, metadata={"unit": "s" if is_time else units[field]}))
    return pyarrow.schema(fields)


def channel_table(messages, schema, axis=None):
    """The messages as a table; what is not a number is empty in it."""
    arrays = []
    for (_, field, entry), column in zip(channel_columns(messages.dtype, axis), schema):
        values = seconds(messages) if column.name == "time" else messages[field] if entry is None else messages[field][:, entry]
        arrays.append(pyarrow.array(np.ascontiguousarray(values), column.type, from_pandas=True))
    return pyarrow.Table.from_arrays(arrays, schema=schema)


class ParquetFile:
    """One channel's file; rows are gathered until they are worth a row group."""

    def __init__(self, path, schema, channel, axis):
        self.schema, self.axis, self.waiting, self.waiting_bytes = schema, axis, [], 0
        # Numbers that count or repeat themselves are kept as a dictionary; measured ones hardly ever repeat.
        repeating = [field.name for field in schema if pyarrow.types.is_integer(field.type)]
        self.writer = pyarrow.parquet.ParquetWriter(path, schema, use_dictionary=repeating)

    def write(self, messages):
        self.waiting.append(messages)
        self.waiting_bytes += messages.nbytes
        if self.waiting_bytes >= ROW_GROUP:
            self.flush()

    def flush(self):
        if self.waiting:
            messages = np.concatenate(self.waiting)
            self.waiting, self.waiting_bytes = [], 0
            self.writer.write_table(channel_table(messages, self.schema, self.axis))

    def close(self):
        self.flush()
        self.writer.close()


def csv_name(field):
    """With its unit behind it, unless the name says it or there is none."""
    unit = field.metadata[b"unit"].decode()
    return field.name if unit == "-" or field.name.endswith(f"[{unit}]") else f"{field.name} [{unit}]"


class CsvFile:
    def __init__(self, path, schema, channel, axis):
        self.schema, self.axis, self.names = schema, axis, [csv_name(field) for field in schema]
        options = pyarrow.csv.WriteOptions(quoting_style="needed", quoting_header="needed")
        self.writer = pyarrow.csv.CSVWriter(path, pyarrow.schema(list(zip(self.names, schema.types))), write_options=options)

    def write(self, messages):
        self.writer.write_table(channel_table(messages, self.schema, self.axis).rename_columns(self.names))

    def close(self):
        self.writer.close()


def write_tables(run, out, file_format):
    """A folder with one file per channel; it appears when all of them are complete."""
    log = run.log
    axis, units = axis_columns(run.facts, log), units_of(run.facts)
    kind = ParquetFile if file_format == "parquet" else CsvFile
    with growing(out) as partial, contextlib.ExitStack() as stack:
        partial.mkdir()
        files = {}
        for name, described in log.tables.items():
            schema = channel_schema(units[name], described.dtype, axis.get(name))
            files[name] = kind(partial / f"{name}.{file_format}", schema, name, axis.get(name))
            stack.callback(files[name].close)
        # The largest channel beside the others: pyarrow lets go of the interpreter while it writes.
        with ThreadPoolExecutor() as pool:
            for stretch in log.stretches():
                for written in [pool.submit(files[name].write, messages) for name, messages in stretch.items()]:
                    written.result()


def in_order_of_time(log):
    """The messages of all channels, {name: messages} of one stretch of simulated time after the other; memory grows with
    the stretches of the file and with the log's lateness."""
    waiting, latest = {}, None
    for stretch in log.stretches():
        for name, messages in stretch.items():
            waiting[name] = np.concatenate([waiting[name], messages]) if name in waiting else messages
            newest = int(messages["simulated_time"].max())
            latest = newest if latest is None else max(latest, newest)
        due = {name: messages["simulated_time"] < latest - log.lateness for name, messages in waiting.items()}
        if any(each.any() for each in due.values()):
            yield {name: messages[due[name]] for name, messages in waiting.items() if due[name].any()}
        waiting = {name: messages[~due[name]] for name, messages in waiting.items() if not due[name].all()}
    if waiting:
        yield waiting


def write_mcap(run, out):
    """One file; events in the order of simulated time."""
    log, units = run.log, units_of(run.facts)
    with growing(out) as partial, open(partial, "wb") as stream:
        writer = BatchWriter(stream, compression=CompressionType.LZ4)  # zstd: a fifth smaller, five times as slow
        writer.start(profile="", library=LIBRARY)
        rows, channels = {}, {}
        for name, described in log.tables.items():
            rows[name] = ProtobufRows(f"slewlab.{name}", described.dtype, units[name])
            schema = writer.register_schema(name=f"slewlab.{name}", encoding="protobuf", data=rows[name].descriptor())
            channels[name] = writer.register_channel(topic=name, message_encoding="protobuf", schema_id=schema,
                                                     metadata=units[name])
        for messages in in_order_of_time(log):
            writer.add_batch([(channels[name], each["simulated_time"], each["sequence"], rows[name].encoded(each))
                              for name, each in messages.items()])
        writer.finish()


def place_of(log, file_format):
    """Where a log's export goes that is given no other place."""
    return log.with_suffix(".mcap") if file_format == "mcap" else log.with_name(f"{log.stem}_{file_format}")


def is_earlier_export(path, file_format):
    """Whether there is one, which may be replaced: an MCAP of ours, or a folder of nothing but channels of the wire."""
    if file_format == "mcap":
        return path.is_file() and path.stat().st_size > 0 and is_free(path, MCAP_BEGINNING)
    return path.is_dir() and all(file.suffix == f".{file_format}" and file.stem in table() for file in path.iterdir())


def written(options, parser):
    """What --out names: a file or a folder, as the format has it."""
    try:
        return options.out and (output_file if options.format == "mcap" else output_folder)(options.out)
    except ArgumentTypeError as wrong:
        parser.error(f"argument --out: {wrong}")


def main(arguments=None):
    parser = ArgumentParser(prog="slewlab export", description="Turns a log into files of other tools.")
    parser.add_argument("log", type=Path, help="the log, or the folder that holds run.lcmlog or, of a run that was broken off, run.lcmlog.partial")
    parser.add_argument("--format", choices=FORMATS, required=True)
    parser.add_argument("--out",
                        help="folder (parquet, csv) or file (mcap); default: beside the log, run_FORMAT or run.mcap")
    options = parser.parse_args(arguments)
    options.out = written(options, parser)
    try:
        out = options.out and beside_its_run(options.out)
        run = read_run(options.log)
        log = run.log
        path = log.path.with_suffix("") if log.path.suffix == ".partial" else log.path
        out = out or place_of(path, options.format)
        is_empty = out.is_file() and out.stat().st_size == 0
        if out.exists() and not is_empty and not is_earlier_export(out, options.format):
            raise LogProblem(f"{out}: is there already and is no earlier export; name another with --out")
        if options.format == "mcap":
            write_mcap(run, out)
        else:
            write_tables(run, out, options.format)
    except LogProblem as problem:
        print(f"slewlab export: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"slewlab export: {problem}", file=sys.stderr)
        return 1
    for early in filter(None, [early_end(run)]):
        print(f"{early}. The export has the part that was logged.", file=sys.stderr)
    for remark in log.remarks:
        print(remark)
    counts = ", ".join(f"{name} {described.rows}" for name, described in log.tables.items())
    print(f"{out}: {counts}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
