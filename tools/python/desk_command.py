"""Opens the desk: a page on which a run is watched, steered and scrubbed (docs/desk.md).

    slewlab desk LOG [OTHER_LOG]     a recorded log, or two against each other
"""

import argparse
import asyncio
import contextlib
import signal
import sys

from run_log import LogProblem
from desk.access import Access
from desk.server import Desk
from desk.source import Recorded

DEFAULT_PORT = 0  # any that is free


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


def main(arguments):
    parser = argparse.ArgumentParser(prog="slewlab desk", description="Watch, steer and scrub: a page of a running scenario or a log")
    parser.add_argument("subject", metavar="LOG", nargs="+", help="log or folder of a run; two are drawn over each other")
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on (127.0.0.1); elsewhere than on loopback everybody needs a token")
    parser.add_argument("--port", type=int, default=DEFAULT_PORT, help="port to serve on (any that is free)")
    options = parser.parse_args(arguments)
    if len(options.subject) > 2:
        parser.error("one log, or two to compare")
    try:
        sources = [Recorded(subject) for subject in options.subject]
    except LogProblem as problem:
        print(problem, file=sys.stderr)
        return 1
    for source in sources:
        for remark in source.remarks:
            print(remark, file=sys.stderr)
    try:
        asyncio.run(serve(sources, options))
    except OSError as error:
        print(f"slewlab desk: cannot serve on {options.host} port {options.port}: {error.strerror or error}", file=sys.stderr)
        return 1
    return 0


async def serve(sources, options):
    await serve_until_told(Desk(sources, Access(options.host)), options.host, options.port)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
