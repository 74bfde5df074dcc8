"""Makes a log of the wire out of measured data, by a map that says what its columns mean (docs/import.md).

    slewlab import --map MAP.yaml FILE.csv|FILE.parquet [--out LOG.lcmlog]

Row k becomes ENCODER k, the TORQUE that answers it, SENSORS k where a sensor is mapped, and an OPERATOR message where
the operator's wish changes. Sensors that are not mapped are NaN in SENSORS. The log appears when it is complete, or not at all. Where the
map names a machine, NAME.json beside NAME.lcmlog tells it to report, export, desk and bridge.
The data may be larger than memory: they are read a stretch at a time, and what the map asks of them is kept as columns on disk
until the log is written.
"""

import json
import shutil
import signal
import sys
from pathlib import Path

import export
import report
from arguments import ArgumentParser, output_file
from column_shelf import NoRoom, Shelf
from import_grid import NANOSECONDS
from import_log import Ranges, configuration_hash, identity_of, write_log
from import_map import fail_if_wrong, read_map
from import_plausibility import warnings
from import_signals import convert
from import_table import Rows, read_table
from input_map import InputProblems, is_scalar
from run_log import LogProblem
from run_numbers import facts_path, is_of_a_run, is_of_an_import
from whole_file import growing, is_free


def canonical(node):
    """What of the map decides about the log, keys sorted."""
    if is_scalar(node):
        return node.scalar
    if node.kind == "sequence":
        return [canonical(item) for item in node.items]
    return {key: canonical(value) for key, _, _, value in node.entries if key not in ("source", "description")}


def remove_what_was_made_of(log):
    """What report, export and import wrote beside an older log of that name, as `slewlab run` takes it away (tools/commands/run_facts.cpp,
    remove_earlier_run): none of it may be taken for the new log's. What others wrote stays."""
    if is_ours(log):
        facts_path(log).unlink()
    page = report.place_of(log)
    if page.is_file() and page.stat().st_size and is_free(page, report.BEGINNING.encode()):
        page.unlink()
    for file_format in export.FORMATS:
        exported = export.place_of(log, file_format)
        if export.is_earlier_export(exported, file_format):
            if exported.is_dir():
                shutil.rmtree(exported)
            else:
                exported.unlink()


def is_ours(log):
    """Whether slewlab wrote the facts that stand beside a log."""
    facts = facts_path(log)
    return facts.is_file() and (is_of_a_run(log) or is_of_an_import(facts))


def write_facts(log, file, machine):
    """Of which machine the log is, in the terms of run.json."""
    with growing(facts_path(log)) as partial:
        partial.write_text(json.dumps({"imported_from": file.name} | machine.facts(), indent=2) + "\n", encoding="utf-8")


def main(arguments=None):
    parser = ArgumentParser(prog="slewlab import", description="Measured data into a log of the wire.")
    parser.add_argument("file", type=Path, help="CSV with a line of column names, or Parquet")
    parser.add_argument("--map", type=Path, required=True, help="what the columns mean (docs/import.md)")
    parser.add_argument("--out", type=output_file, help="default: the file's name with .lcmlog")
    options = parser.parse_args(arguments)
    out = options.out or options.file.with_suffix(".lcmlog")
    try:
        mapping = read_map(options.map)
        fail_if_wrong(mapping)
        if out.suffix != ".lcmlog":
            raise LogProblem(f"--out: found {out}, expected a name that ends in .lcmlog")
        if mapping.machine and facts_path(out).exists() and not is_ours(out):
            raise LogProblem(f"{facts_path(out)}: found a file that slewlab did not write, expected none: there the machine of {out.name} is told; "
                             "name another log with --out")
        folder = next(parent for parent in out.absolute().parents if parent.is_dir())  # beside the log: as large as it
        row = Rows(mapping, options.file)
        text = json.dumps(canonical(mapping.reader.node), sort_keys=True) + options.file.name + (str(mapping.machine) if mapping.machine else "")
        ranges = Ranges()
        with Shelf(folder) as shelf:
            grid, signals, remarks = convert(mapping, read_table(mapping, options.file, shelf), row, shelf)
            with growing(out) as partial:
                counts = write_log(partial, grid, signals, ranges, configuration_hash(text), identity_of(options.file))
                ranges.check_request(mapping, row)
                remove_what_was_made_of(out)
                if mapping.machine:
                    write_facts(out, options.file, mapping.machine)
    except InputProblems as problems:
        print(problems, file=sys.stderr)
        return 2
    except NoRoom as problem:
        print(f"slewlab import: cannot write {out}: {problem}", file=sys.stderr)
        return 1
    except LogProblem as problem:
        print(f"slewlab import: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"slewlab import: {problem}", file=sys.stderr)
        return 1
    seconds = (grid[-1] - grid[0]) / NANOSECONDS
    unlikely = warnings(mapping, ranges.of, seconds)
    for signal_name, text in unlikely.items():
        print(f"slewlab import: warning: {signal_name}: {text}", file=sys.stderr)
    for remark in remarks:
        print(remark)
    for name, entries in mapping.signals.items():
        for group, entry in enumerate(entries):
            unit = f" {entry.unit}" if entry.unit not in ("", "-") else ""
            low, high = ranges.of[name, group]
            mark = " (unlikely of this machine, see the warning)" if entry.name in unlikely else ""
            print(f"{entry.name}: {low:.6g} ... {high:.6g}{unit}{mark}")
    said = ", ".join(f"{name} {count}" for name, count in counts.items())
    print(f"{out}: {seconds:.6g} s, {said}" + (f"; {len(unlikely)} signals unlikely of this machine" if unlikely else ""))
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
