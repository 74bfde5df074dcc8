"""A PLC as the controller of a run.

    slewlab run SCENARIO.yaml --realtime --controller "exec slewlab bridge modbus --map MAP.yaml"

The bus and the controller's period come by the environment, as every controller gets them (docs/wire.md). `exec`: the shell that starts
it would otherwise be told of the run's end in its place, and take it along before the report is written.
"""

import json
import os
import signal
import sys
import threading
from pathlib import Path

import lcm

from arguments import ArgumentParser, bus
from core_module import core
from plc.gateway import Gateway
from plc.link import LinkDown, WrongMap, open_link
from plc.plc_map import load_plc_map
from plc.real_time import ask_for_real_time
from whole_file import growing

PROTOCOLS = ("modbus", "opcua", "ads")
SILENCE = "drive_protection.silence_timeout"  # of the machine's file


def value_of(file, wanted):
    """(value [s], where it stands) of a time in a file; (infinity, "") where the file has none."""
    for key, value, unit, _, place, line in core.file_values(file, []):
        if key == wanted:
            return float(value) * core.factor(unit, "s"), f"{place}:{line}"
    return float("inf"), ""


def late_loss(map_file, plc_map, controller_file):
    """Why the drive trips by its silence before a lost link counts as lost; empty where it does not. The machine's file lies beside the
    run's controller file."""
    machine = next((file for file in (Path(controller_file).with_name(f"{kind}.yaml") for kind in ("crane", "axis")) if file.exists()), None)
    if machine is None:
        return ""
    silence, place = value_of(machine, SILENCE)
    if plc_map.timeout < silence:
        return ""
    return (f"{value_of(map_file, 'timeout')[1] or map_file}: key 'timeout': found {plc_map.timeout * 1e3:g} ms, expected less than {silence * 1e3:g} ms, "
            f"which is {SILENCE} of this run's machine ({place}): the drive would trip before the link counts as lost")


def main(arguments):
    parser = ArgumentParser(prog="slewlab bridge", description="A PLC as the controller of a run (docs/plc.md)")
    parser.add_argument("protocol", choices=PROTOCOLS)
    parser.add_argument("--map", required=True, type=Path, help="which register, node or symbol holds which signal")
    parser.add_argument("--bus", type=bus, default=os.environ.get("SLEWLAB_BUS"), help="LCM address of the run ($SLEWLAB_BUS)")
    parser.add_argument("--period-ms", type=float, default=float(os.environ.get("SLEWLAB_CONTROLLER_PERIOD_MS", "nan")),
                        help="time between two ENCODER messages [ms] ($SLEWLAB_CONTROLLER_PERIOD_MS)")
    parser.add_argument("--report", type=Path, help="JSON file for how well the link kept its time")
    options = parser.parse_args(arguments)
    if not options.bus:
        parser.error("--bus is wanted, or SLEWLAB_BUS as slewlab run sets it")
    if not options.period_ms > 0.0:
        parser.error("--period-ms is wanted, or SLEWLAB_CONTROLLER_PERIOD_MS as slewlab run sets it")
    speed = os.environ.get("SLEWLAB_REALTIME_SPEED")
    try:
        plc_map = load_plc_map(options.map)
    except core.InputError as problem:
        print(problem, file=sys.stderr)
        return 2

    def refuse(found, expected):
        print(f"{options.map}: {found}; {expected}", file=sys.stderr)
        return 2

    if plc_map.protocol != options.protocol:
        return refuse(f"a map for {plc_map.protocol}", f"slewlab bridge {plc_map.protocol} takes it, slewlab bridge {options.protocol} does not")
    if speed is None and not plc_map.ticked:
        return refuse("this PLC keeps a time of its own (ticked: false)", "run it with --realtime; in lockstep a PLC has to be ticked")
    if speed is not None and float(speed) != 1.0 and not plc_map.ticked:
        return refuse(f"this PLC keeps a time of its own, and the run goes at {speed} times real time", "run it without --speed")
    if speed is not None and (late := late_loss(options.map, plc_map, os.environ.get("SLEWLAB_CONTROLLER_CONFIG", ""))):
        print(late, file=sys.stderr)
        return 2

    end = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: end.set())
    # Before the bus and the link are opened: their threads inherit it.
    scheduling = ask_for_real_time() if speed is not None else "not asked for: lockstep"
    gateway = Gateway(plc_map, open_link(plc_map), lcm.LCM(options.bus), options.period_ms * 1e-3, speed is not None,
                      lambda text: print(f"slewlab bridge: {text}", file=sys.stderr, flush=True))
    try:
        gateway.serve(end)
        return 0
    except (LinkDown, WrongMap) as problem:
        print(f"slewlab bridge: {problem}", file=sys.stderr)
        return 1
    finally:
        if options.report:
            with growing(options.report) as partial:
                partial.write_text(json.dumps(gateway.summary() | {"scheduling": scheduling}, indent=2) + "\n", encoding="utf-8")
        gateway.close()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
