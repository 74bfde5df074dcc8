"""Serves a run's messages to other people's viewers while it goes on. (A PLC is served by plc_bridge.py.)

    slewlab bridge --foxglove --bus URL      what is said on a bus
    slewlab bridge --foxglove LOG            what is written to a log from now on (a log or the folder of a run)

Foxglove, Lichtblick and PlotJuggler connect to ws://127.0.0.1:PORT. Every channel is a topic of Protobuf messages with its schema;
the unit of every field stands in the channel's metadata, as in what `slewlab export --format mcap` writes. Time is the simulated one.
"""

import heapq
import itertools
import operator
import signal
import sys
import threading
from pathlib import Path

import foxglove
import numpy as np
from foxglove.websocket import Capability

from arguments import ArgumentParser, bus, known_names, port
from desk.access import is_loopback
from desk.source import Bus, Growing, class_of, growing_log, row_type
from protobuf_rows import ProtobufRows
from run_log import LogProblem
from run_numbers import facts_beside
from signals import units_of
from subprotocol_proxy import SubprotocolProxy

DEFAULT_PORT = 8765  # that Foxglove asks for
POLL = 0.02          # [s]
FAREWELL = 2.0       # [s] in which viewers may read the end
OWN = ("fingerprint",)  # of LCM, no field of a message
BACKLOG = 200_000  # messages that wait for a slow viewer, half a minute of all channels at 1 kHz; of more it loses the oldest


class Topics:
    """A topic for every channel, there from the beginning: who waits for a run hears its first messages. How long arrays are is known by those; a schema does not tell it."""

    def __init__(self, units):
        self.units = units
        self.topics = {channel: self._topic(channel) for channel in units}
        self.rows = {}     # of the channels that were heard
        self.waiting = []  # of each channel: times [ns], topic and messages, not yet taken apart

    def _rows(self, channel, dtype):
        return ProtobufRows(f"slewlab.{channel}", np.dtype([(name, dtype[name]) for name in dtype.names if name not in OWN]), self.units[channel])

    def _topic(self, channel):
        rows = self._rows(channel, row_type(class_of(channel), lambda _: 1))
        schema = foxglove.Schema(name=rows.name, encoding="protobuf", data=rows.descriptor())
        return foxglove.Channel(channel, schema=schema, message_encoding="protobuf", metadata=self.units[channel])

    def receive(self, channel, messages):
        if channel not in self.rows:
            self.rows[channel] = self._rows(channel, messages.dtype)
        rows, topic = self.rows[channel], self.topics[channel]
        messages = messages[np.argsort(messages["simulated_time"], kind="stable")]
        encoded = rows.encoded(messages)
        size = encoded.dtype.itemsize
        data = encoded.tobytes()
        times = np.maximum(messages["simulated_time"], 0)
        self.waiting.append(zip(map(int, times), itertools.repeat(topic), (data[begin:begin + size] for begin in range(0, len(data), size))))

    def send(self):
        """What was received since the last time, in the order of simulated time: a viewer has one clock for all topics."""
        for time, topic, data in heapq.merge(*self.waiting, key=operator.itemgetter(0)):
            topic.log(data, log_time=time)
        self.waiting.clear()


def main(arguments):
    parser = ArgumentParser(prog="slewlab bridge", description="Serves a run's messages to other people's viewers",
                                     epilog="A PLC as the controller: slewlab bridge modbus|opcua|ads --map MAP.yaml (docs/plc.md)")
    parser.add_argument("log", metavar="LOG", nargs="?", type=Path, help="log that is being written, or the folder of a run")
    parser.add_argument("--bus", metavar="URL", type=bus, help="LCM address of a bus to listen to")
    parser.add_argument("--foxglove", action="store_true", help="as Foxglove, Lichtblick and PlotJuggler ask for it")
    parser.add_argument("--host", default="127.0.0.1", help="loopback address to serve on (127.0.0.1)")
    parser.add_argument("--port", type=port, default=DEFAULT_PORT, help=f"port to serve on ({DEFAULT_PORT}); 0: any that is free")
    options = parser.parse_args(arguments)
    if not options.foxglove:
        near = known_names(str(options.log or ""), ["--foxglove", "modbus", "opcua", "ads"])
        parser.error(f"to whom? expected {near}")
    if bool(options.log) == bool(options.bus):
        parser.error("a LOG or --bus is wanted")
    if not is_loopback(options.host):
        parser.error(f"--host {options.host}: this protocol knows no token, so it is served on loopback alone; "
                     "from elsewhere take a tunnel, e.g. ssh -L")
    try:
        log = growing_log(options.log) if options.log else None
        topics = Topics(units_of(facts_beside(log) if log else {}))
    except LogProblem as problem:
        print(f"slewlab bridge: {problem}", file=sys.stderr)
        return 2
    end = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: end.set())
    try:
        if options.bus:
            source = Bus(options.bus, receive=topics.receive, channels=tuple(topics.topics))
        else:
            source = Growing(log, receive=topics.receive, channels=tuple(topics.topics))
            source.skip_what_is_there()
        server = foxglove.start_server(name="slewlab", host=options.host, port=0, message_backlog_size=BACKLOG, capabilities=[Capability.Time])
        proxy = SubprotocolProxy(options.host, options.port, server.port).start()
    except (LogProblem, OSError, RuntimeError) as problem:
        print(f"slewlab bridge: {problem}", file=sys.stderr)
        return 1
    print(f"bridge: ws://{options.host}:{proxy.port}", flush=True)
    while not end.wait(POLL):
        source.poll()
        topics.send()
    # Viewers that read are told of the end; the server would wait for ever for one that does not.
    farewell = threading.Thread(target=server.stop, daemon=True)
    farewell.start()
    farewell.join(FAREWELL)
    proxy.stop()
    farewell.join(FAREWELL)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
