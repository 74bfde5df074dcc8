"""A PLC on loopback to try a map with: it has the map's variables and computes a controller of slewlab in its cycle.

    slewlab soft-plc --map MAP.yaml --controller CONTROLLER.yaml [--period-ms 10]

Where the map says `ticked` it computes one cycle for every new alive_counter, otherwise one in every period of the wall clock.
"""

import asyncio
import signal
import sys
from pathlib import Path

from arguments import ArgumentParser
from core_module import core
from plc.plc_map import load_plc_map
from plc.real_time import ask_for_real_time
from plc.soft_cycle import SoftCycle


def server_of(plc_map, cycle):
    if plc_map.protocol == "modbus":
        from plc.modbus_server import ModbusServer
        return ModbusServer(plc_map, cycle)
    if plc_map.protocol == "opcua":
        from plc.opcua_server import OpcuaServer
        return OpcuaServer(plc_map, cycle)
    from plc.ads_server import AdsServer
    return AdsServer(plc_map, cycle)


async def serve(plc_map, cycle, is_real_time):
    """Until a signal, or a run that this PLC cannot compute for: answers with what is wrong of it, or None."""
    end, problems = asyncio.Event(), []

    def refuse(problem):
        problems.append(problem)
        end.set()

    cycle.refuse = refuse
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    server = server_of(plc_map, cycle)
    await server.serve()
    clock = None if plc_map.ticked else asyncio.create_task(cycle.run())
    if is_real_time:
        print(f"soft-plc: {ask_for_real_time()}", flush=True)
    print(f"soft-plc: {plc_map.protocol} at {plc_map.address}, " +
          ("one cycle for every new alive_counter" if plc_map.ticked else f"a cycle every {cycle.period * 1e3:g} ms"), flush=True)
    await end.wait()
    if clock:
        clock.cancel()
    print(f"soft-plc: {cycle.cycles} cycles computed, {cycle.late_cycles} late", flush=True)
    return problems[0] if problems else None


def main(arguments):
    parser = ArgumentParser(prog="slewlab soft-plc", description="A PLC on loopback to try a map with")
    parser.add_argument("--map", required=True, type=Path, help="map of its variables (docs/plc.md)")
    parser.add_argument("--controller", required=True, type=Path, help="controller file that it computes")
    parser.add_argument("--period-ms", type=float, default=10.0, help="cycle [ms], controller_period of the scenario (10)")
    parser.add_argument("--real-time", action="store_true", help="ask for SCHED_FIFO, as for a run with --realtime")
    options = parser.parse_args(arguments)
    if not options.period_ms > 0.0:
        parser.error(f"--period-ms {options.period_ms:g}: a time above 0 is wanted")
    try:
        plc_map = load_plc_map(options.map)
        cycle = SoftCycle(plc_map, options.controller, options.period_ms * 1e-3)
        core.SteppedController(options.controller, cycle.period)  # said now what is wrong with its file
        groups = next(int(float(value)) for key, value, *_ in core.file_values(options.controller, []) if key == "groups")
    except core.InputError as problem:
        print(problem, file=sys.stderr)
        return 2
    if groups != plc_map.group_count:
        print(f"{options.controller}: found a controller of {groups} motor group(s), expected one of {plc_map.group_count}, as {options.map} has", file=sys.stderr)
        return 2
    try:
        problem = asyncio.run(serve(plc_map, cycle, options.real_time))
    except OSError as problem:
        print(f"slewlab soft-plc: {plc_map.address}: {problem}", file=sys.stderr)
        return 1
    if problem:
        print(f"slewlab soft-plc: {problem}", file=sys.stderr)
    return 1 if problem else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
