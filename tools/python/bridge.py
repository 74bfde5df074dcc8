"""Serves a run's messages to other people's viewers while it goes on. (A PLC is served by plc_bridge.py.)

    slewlab bridge --foxglove --bus URL [--run FOLDER]   what is said on a bus, of the machine that run.json in the folder tells
    slewlab bridge --foxglove LOG                        what is written to a log from now on (a log or the folder of a run)

Foxglove, Lichtblick and PlotJuggler connect to ws://127.0.0.1:PORT. Every channel is a topic of Protobuf messages with its schema;
the unit of every field stands in the channel's metadata, as in what `slewlab export --format mcap` writes. Time is the simulated one.
"""

import heapq
import itertools
import operator
import queue
import signal
import sys
import threading
from pathlib import Path

import foxglove
import numpy as np
from foxglove.websocket import Capability, ServerListener

from arguments import ArgumentParser, bus, known_names, port
from desk.access import is_loopback
from desk.source import SPORADIC, Bus, Growing, NoBus, class_of, growing_log, row_type
from protobuf_rows import ProtobufRows
from run_log import LogProblem
from signals import table, units_of
from subprotocol_proxy import SubprotocolProxy

DEFAULT_PORT = 8765  # that Foxglove asks for
POLL = 0.02          # [s]
FAREWELL = 2.0       # [s] in which viewers may read the end
OWN = ("fingerprint",)  # of LCM, no field of a message
BACKLOG = 200_000  # messages that wait for a slow viewer, half a minute of all channels at 1 kHz; of more it loses the oldest


class Topics:
    """A topic for every channel, there from the beginning: who waits for a run hears its first messages. How long arrays are is known by
    those, of every run anew; a schema does not tell it."""

    def __init__(self):
        self.facts, self.units, self.topics = None, {}, {}
        self.rows = {}      # of the channels that were heard in this run
        self.waiting = []   # of each channel: times [ns], channel and messages, not yet taken apart
        self.standing = {}  # of the channels that are said when something changes: the last message
        self.now = 0        # [ns] of the newest message
        self.late = queue.SimpleQueue()  # (viewer, channel) of who has subscribed to such a channel

    def advertise(self, facts):
        """A channel whose units are others than up to now is another one to viewers."""
        units = units_of(facts)
        for channel in (channel for channel in units if units[channel] != self.units.get(channel)):
            if channel in self.topics:
                self.topics[channel].close()
            rows = self._rows(channel, row_type(class_of(channel), lambda _: 1), units[channel])
            schema = foxglove.Schema(name=rows.name, encoding="protobuf", data=rows.descriptor())
            self.topics[channel] = foxglove.Channel(channel, schema=schema, message_encoding="protobuf", metadata=units[channel])
        self.facts, self.units = facts, units

    def _rows(self, channel, dtype, units):
        return ProtobufRows(f"slewlab.{channel}", np.dtype([(name, dtype[name]) for name in dtype.names if name not in OWN]), units)

    def begin(self):
        """What comes is of another run."""
        self.rows.clear()
        self.standing.clear()
        self.now = 0

    def receive(self, channel, messages):
        if channel not in self.rows:
            self.rows[channel] = self._rows(channel, messages.dtype, self.units[channel])
        messages = messages[np.argsort(messages["simulated_time"], kind="stable")]
        encoded = self.rows[channel].encoded(messages)
        size = encoded.dtype.itemsize
        data = encoded.tobytes()
        times = np.maximum(messages["simulated_time"], 0)
        self.waiting.append(zip(map(int, times), itertools.repeat(channel), (data[begin:begin + size] for begin in range(0, len(data), size))))
        self.now = max(self.now, int(times[-1]))
        if channel in SPORADIC:
            self.standing[channel] = data[-size:]

    def send(self):
        """What was received since the last time, in the order of simulated time: a viewer has one clock for all topics."""
        for time, channel, data in heapq.merge(*self.waiting, key=operator.itemgetter(0)):
            self.topics[channel].log(data, log_time=time)
        self.waiting.clear()
        while not self.late.empty():
            viewer, channel = self.late.get()
            if channel in self.standing:  # it holds now: a viewer places it where its clock stands. The SDK numbers viewers and sinks alike
                self.topics[channel].log(self.standing[channel], log_time=self.now, sink_id=viewer)


class Latecomers(ServerListener):
    """Notes who subscribes to what is said when something changes. Called in threads of the server."""

    def __init__(self, topics):
        self.topics = topics

    def on_subscribe(self, client, channel):
        if channel.topic in SPORADIC:
            self.topics.late.put((client.id, channel.topic))


def main(arguments):
    parser = ArgumentParser(prog="slewlab bridge", description="Serves a run's messages to other people's viewers",
                                     epilog="A PLC as the controller: slewlab bridge modbus|opcua|ads --map MAP.yaml (docs/plc.md)")
    parser.add_argument("log", metavar="LOG", nargs="?", type=Path, help="log that is being written, or the folder of a run")
    parser.add_argument("--bus", metavar="URL", type=bus, help="LCM address of a bus to listen to")
    parser.add_argument("--run", type=Path, metavar="FOLDER", help="with --bus: a run's folder, whose run.json tells the machine, and so the units")
    parser.add_argument("--foxglove", action="store_true", help="as Foxglove, Lichtblick and PlotJuggler ask for it")
    parser.add_argument("--host", default="127.0.0.1", help="loopback address to serve on (127.0.0.1)")
    parser.add_argument("--port", type=port, default=DEFAULT_PORT, help=f"port to serve on ({DEFAULT_PORT}); 0: any that is free")
    options = parser.parse_args(arguments)
    if not options.foxglove:
        near = known_names(str(options.log or ""), ["--foxglove", "modbus", "opcua", "ads"])
        parser.error(f"to whom? expected {near}")
    if bool(options.log) == bool(options.bus):
        parser.error("a LOG or --bus is wanted")
    if options.run and not options.bus:
        parser.error("--run belongs to --bus")
    if not is_loopback(options.host):
        parser.error(f"--host {options.host}: this protocol knows no token, so it is served on loopback alone; "
                     "from elsewhere take a tunnel, e.g. ssh -L")
    end = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: end.set())
    topics = Topics()
    heard = {"receive": topics.receive, "begin": topics.begin, "channels": tuple(table())}
    try:
        source = Bus(options.bus, options.run, **heard) if options.bus else Growing(growing_log(options.log), **heard)
        topics.advertise(source.facts)
        if options.log:
            source.skip_what_is_there()
            topics.send()  # to nobody
        server = foxglove.start_server(name="slewlab", host=options.host, port=0, message_backlog_size=BACKLOG, capabilities=[Capability.Time],
                                       server_listener=Latecomers(topics))
        proxy = SubprotocolProxy(options.host, options.port, server.port).start()
    except (NoBus, OSError, RuntimeError) as problem:
        print(f"slewlab bridge: {problem}", file=sys.stderr)
        return 1
    except LogProblem as problem:
        print(f"slewlab bridge: {problem}", file=sys.stderr)
        return 2
    print(f"bridge: ws://{options.host}:{proxy.port}", flush=True)
    while not end.wait(POLL):
        source.poll()
        if source.facts is not topics.facts:
            topics.advertise(source.facts)
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
