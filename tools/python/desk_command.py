"""Opens the desk: a page on which a run is watched, steered and scrubbed (docs/desk.md).

    slewlab desk SCENARIO            runs it; who opens the page has the joystick in place of the scenario's operator
    slewlab desk LOG [OTHER_LOG]     a recorded log, or two against each other
    slewlab desk LOG --follow        a log that is still being written
    slewlab desk --bus URL           whatever is said on a bus
"""

import asyncio
import contextlib
import signal
import sys
from pathlib import Path

from arguments import ArgumentParser, bus, output_folder, port, shell_command
from run_log import LogProblem
from desk.access import PATIENCE, Access, Joystick
from desk.diagnosis import Diagnosis
from desk.gap import Gap, read_nominal, refuse_another_machine, refuse_controller_of_an_axis
from desk.recording import Recorder
from desk.server import Desk
from desk.source import Bus, Difference, Growing, NoBus, Recorded, growing_log
from desk.steered_run import SteeredRun

DEFAULT_PORT = 0  # any that is free
OF_THE_MACHINE = ("machine", "geometry", "half_play", "modes", "rated_torque", "top_speed", "total_ratio", "tip_radius")  # of run.json
LONGEST = 3600.0  # [s] of simulated time that a steered run may take, where nothing else is said


async def serve_until_told(desk, host, port):
    end = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    async with desk.start(host, port) as server:
        found = server.sockets[0].getsockname()[1]
        shown = f"[{host}]" if ":" in host else host
        if desk.access.is_local:
            print(f"desk: http://{shown}:{found}/#{desk.access.steering}", flush=True)
        else:
            print(f"desk, to watch: http://{shown}:{found}/#{desk.access.watching}", flush=True)
            print(f"desk, to steer: http://{shown}:{found}/#{desk.access.steering}", flush=True)
        following = asyncio.create_task(desk.follow())
        await asyncio.wait([asyncio.create_task(end.wait()), following], return_when=asyncio.FIRST_COMPLETED)
        following.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await following


def parsed(arguments):
    parser = ArgumentParser(prog="slewlab desk", description="Watch, steer and scrub: a page of a running scenario or a log")
    parser.add_argument("subject", metavar="SCENARIO|LOG", nargs="*",
                        help="scenario (.yaml) to run and steer, or log or folder of a run; two logs are drawn over each other")
    parser.add_argument("--bus", metavar="URL", type=bus, help="LCM address of a bus to listen to, e.g. udpm://239.255.76.67:7667?ttl=0")
    parser.add_argument("--run", type=Path, metavar="FOLDER", help="with --bus: a run's folder, whose run.json tells ratios, ratings and geometry")
    parser.add_argument("--follow", action="store_true", help="LOG, or the run.lcmlog of a folder, is still being written")
    parser.add_argument("--same-machine", action="store_true", help="two logs are of one machine: what one does not tell of it (ratio, ratings, geometry), the other does")
    parser.add_argument("--nominal", metavar="MACHINE", help="nominal machine's file: the gap to it is watched while the run goes on")
    parser.add_argument("--nominal-controller", metavar="FILE", help="with --nominal: the controller's file, for a diagnosis")
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on (127.0.0.1); elsewhere than on loopback everybody needs a token")
    parser.add_argument("--port", type=port, default=DEFAULT_PORT, help="port to serve on (any that is free)")
    parser.add_argument("--out", type=output_folder, help="folder for steered runs, recordings and diagnoses (runs/desk_NAME)")
    parser.add_argument("--duration", type=float, help=f"[s] of simulated time that a steered run may take ({LONGEST:g})")
    parser.add_argument("--let-go-after", type=float, metavar="S",
                        help=f"[s] of silence after which a page's hand is off the lever ({PATIENCE:g})")
    parser.add_argument("--controller", type=shell_command, help="shell command of your own controller, as of slewlab run")
    parser.add_argument("--realtime", action="store_true", help="against the wall clock instead of in lockstep")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="over the scenario's files, as of slewlab run")
    options = parser.parse_args(arguments)
    options.is_scenario = bool(options.subject) and Path(options.subject[0]).suffix in (".yaml", ".yml")
    if not (len(options.subject) == 1 or len(options.subject) == 2 and not options.is_scenario and not options.follow
            or options.bus and not options.subject):
        parser.error("one scenario, one log, two logs to compare, or --bus is wanted")
    if options.subject and options.bus:
        parser.error("--bus listens to a bus alone, without a scenario or a log")
    refuse_what_does_not_matter(parser, options)
    if options.nominal and not (options.is_scenario or options.bus or options.follow):
        parser.error("--nominal watches a run that goes on; of a recorded log ask slewlab diagnose")
    options.let_go_after = PATIENCE if options.let_go_after is None else options.let_go_after
    options.duration = LONGEST if options.duration is None else options.duration
    if not 0 < options.let_go_after <= 60:
        parser.error("--let-go-after: more than 0 and at most 60 s is wanted")
    if not options.duration > 0:
        parser.error("--duration: a positive number of seconds is wanted")
    return options


def refuse_what_does_not_matter(parser, options):
    """Options that say something of a run that this desk does not make, of a bus or of a nominal machine that are not there."""
    of_a_run = {"--duration": options.duration, "--let-go-after": options.let_go_after, "--controller": options.controller,
                "--realtime": options.realtime or None, "--set": options.set or None,
                "--out": None if options.bus or options.follow else options.out}  # recordings and diagnoses are written there, too
    given = [name for name, value in of_a_run.items() if value is not None]
    if given and not options.is_scenario:
        parser.error(f"{', '.join(given)}: of a scenario that the desk runs; this one shows {'a bus' if options.bus else 'a log'}")
    for name, value, of in (("--run", options.run, "--bus"), ("--nominal-controller", options.nominal_controller, "--nominal")):
        if value is not None and not getattr(options, of[2:]):
            parser.error(f"{name} belongs to {of}")
    if options.same_machine and (len(options.subject) != 2 or options.is_scenario):
        parser.error("--same-machine belongs to two logs")
    if options.follow and options.is_scenario:
        parser.error("--follow belongs to a log: a scenario that the desk runs is followed anyway")


def main(arguments):
    options = parsed(arguments)
    try:
        return asyncio.run(open_desk(options))
    except NoBus as problem:
        print(f"slewlab desk: {problem}", file=sys.stderr)
        return 1
    except LogProblem as problem:
        print(f"slewlab desk: {problem}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"slewlab desk: {options.host} port {options.port}: {error.strerror or error}", file=sys.stderr)
        return 1


async def open_desk(options):
    access, diagnosis, watch = Access(options.host), None, None
    out = options.out or Path("runs") / f"desk_{Path(options.subject[0]).stem if options.subject else 'bus'}"
    if options.nominal:
        if options.nominal_controller:
            refuse_controller_of_an_axis(options.nominal)
        diagnosis, nominal = Diagnosis(options.nominal, options.nominal_controller, out), read_nominal(options.nominal)

        async def watch(source):
            gap = Gap(source, nominal, diagnosis.minute)
            await gap.start()
            return gap
    if options.is_scenario:
        more = [word for change in options.set for word in ("--set", change)]
        more += ["--controller", options.controller] if options.controller else []
        run = SteeredRun(options.subject[0], out, options.duration, more, options.realtime)
        source = await run.start()
        if not await run.begins():
            print("\n".join(run.words), file=sys.stderr)
            return 2
        if options.nominal:
            try:
                refuse_another_machine(options.nominal, source.facts_file.read())
            except LogProblem:
                await run.end()
                raise
        desk = Desk([source], access, run, watch)
        desk.recorder = recorder_of(source, out)
        desk.joystick = Joystick(options.let_go_after)
        desk.diagnosis = diagnosis
        try:
            await serve_until_told(desk, options.host, options.port)
        finally:
            await run.end()
            await end_watching(desk)
            desk.recorder.stop()
            for words in run.words:
                print(words)
        return 0
    if options.bus:
        sources = [Bus(options.bus, options.run)]
    elif options.follow:
        sources = [Growing(growing_log(options.subject[0]))]
    else:
        sources = [Recorded(subject) for subject in options.subject]
    if options.nominal:
        refuse_another_machine(options.nominal, sources[0].facts)
    if options.same_machine:
        share_facts(*sources)
    if len(sources) == 2:
        sources.append(Difference(*sources))
    for source in sources:
        for remark in source.remarks:
            print(remark, file=sys.stderr)
    desk = Desk(sources, access, watch=watch)
    desk.diagnosis = diagnosis
    if desk.is_live:
        desk.recorder = recorder_of(sources[0], out)
    try:
        await serve_until_told(desk, options.host, options.port)
    finally:
        await end_watching(desk)
        if desk.recorder is not None:
            desk.recorder.stop()
    return 0


def recorder_of(source, out):
    recorder = Recorder(out)
    recorder.attach(source)
    return recorder


def share_facts(first, second):
    """What of the machine stands in run.json beside one log alone holds for the other."""
    for one, other in ((first, second), (second, first)):
        one.facts = {name: value for name, value in other.facts.items() if name in OF_THE_MACHINE} | one.facts


async def end_watching(desk):
    for part in (desk.gap, desk.diagnosis):
        if part is not None:
            await part.end()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
