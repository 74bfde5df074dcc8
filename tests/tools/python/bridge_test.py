"""The bridge against a client of Foxglove's protocol: schema, units, values and times of what a growing log gets."""

import base64
import contextlib
import json
import os
import random
import re
import socket
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import made_run
from subprotocol_proxy import with_clock

SLEWLAB = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin" / "slewlab"
PATIENCE = 60.0  # [s]
DATA = struct.Struct("<BIQ")  # of the protocol: opcode, subscription, time [ns]
TIME = struct.Struct("<BQ")   # of the protocol: opcode, time [ns]
END = round(made_run.END * 1e9)  # [ns]
BEGINNING = 100_000           # [bytes] of a made run in which every channel has a message
REPEATED = 30                 # [-] made runs, 40 MB: more than sockets hold for who does not read


LINEAR_MOTOR = {"kind": "axis", "position_unit": "m", "speed_unit": "m/s",
                "efforts": [{"name": "motor force", "unit": "N"}, {"name": "force on the axis", "unit": "N"}],
                "sensors": [{"name": name, "unit": unit, "channel": "ENCODER", "field": field}
                            for name, unit, field in (("motor speed", "m/s", "shaft_speed"), ("motor position", "m", "shaft_position"))]}


def message_class(channel):
    schema = channel["schema"]
    files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(schema))
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"]))


def units_of(channel):
    """{field: comment behind it} of a channel's schema."""
    file = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(channel["schema"])).file[0]
    return {file.message_type[0].field[place.path[-1]].name: place.trailing_comments.strip() for place in file.source_code_info.location}


class Viewer:
    """Who subscribes to some channels of a log that grows, and keeps what is heard in its order."""

    def __init__(self, connection, wanted):
        self.connection, self.wanted = connection, dict(enumerate(wanted, 7))
        self.capabilities, self.channels = None, {}
        self.told = []  # (channel, or None: the server's time; time [ns]; message)

    def hear(self, patience=PATIENCE):
        """Channel and time of a message, None for anything else."""
        told = self.connection.recv(patience)
        if isinstance(told, bytes):
            if told[0] == 1:
                _, subscription, time = DATA.unpack_from(told)
                self.told.append((self.wanted[subscription], time, told[DATA.size:]))
                return self.wanted[subscription], time
            if told[0] == 2:
                self.told.append((None, TIME.unpack(told)[1], b""))
            return None
        told = json.loads(told)
        if told["op"] == "serverInfo":
            self.capabilities = told["capabilities"]
        elif told["op"] == "advertise":
            self.channels |= {each["topic"]: each for each in told["channels"]}
        elif told["op"] == "unadvertise":
            self.channels = {topic: each for topic, each in self.channels.items() if each["id"] not in told["channelIds"]}
        return None

    def of(self, channel):
        return {time: message for name, time, message in self.told if name == channel}

    def subscribe(self, numbers):
        self.connection.send(json.dumps({"op": "unsubscribe", "subscriptionIds": numbers}))
        self.connection.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": number, "channelId": self.channels[self.wanted[number]]["id"]}
                                                                              for number in numbers]}))

    def attend(self):
        """Subscribes when all channels are there, and waits until that counts: a ping is answered in its turn."""
        while not set(self.channels) >= set(self.wanted.values()):
            self.hear()
        self.subscribe(list(self.wanted))
        self.connection.ping().wait(PATIENCE)

    def watch(self, log, data):
        """Subscribes while `data` is written to `log` a part at a time, and hears it to its last SENSORS. Nobody says when a subscription
        begins to count, or whether it came too early: the log grows a little until something is heard of every channel."""
        def write(part):
            with log.open("ab") as stream:
                stream.write(part)

        write(data[:BEGINNING])
        while not set(self.channels) >= {"SENSORS", "TORQUE", "ENCODER", "TRUTH", "OPERATOR"}:
            self.hear()
        self.subscribe(list(self.wanted))
        written, last = BEGINNING, len(data) - BEGINNING
        while missing := [number for number, channel in self.wanted.items() if not self.of(channel)]:
            if written > BEGINNING:
                self.subscribe(missing)
            if written >= last:
                raise AssertionError("nothing was heard of a log that grew")
            write(data[written:min(written + 10_000, last)])
            written = min(written + 10_000, last)
            with contextlib.suppress(TimeoutError):
                while True:
                    self.hear(0.5)
        write(data[written:])
        self.hear_to_the_end()

    def hear_to_the_end(self):
        while self.hear() != ("SENSORS", END):
            pass


def frame(first, payload):
    """Of WebSocket, as a server sends it (RFC 6455, section 5.2)."""
    if len(payload) < 126:
        return bytes([first, len(payload)]) + payload
    if len(payload) < 1 << 16:
        return bytes([first, 126]) + struct.pack(">H", len(payload)) + payload
    return bytes([first, 127]) + struct.pack(">Q", len(payload)) + payload


class BridgeTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def start(self, *arguments, stderr=None):
        self.bridge = process = subprocess.Popen([SLEWLAB, "bridge", "--foxglove", "--port", "0", *map(str, arguments)], stdin=subprocess.DEVNULL,
                                                 stdout=subprocess.PIPE, stderr=stderr, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait, PATIENCE)
        self.addCleanup(process.terminate)
        return re.search(r"ws://\S+", process.stdout.readline()).group(0)

    def made(self, **of_the_run):
        """A made run's log, as bytes."""
        made_run.write_log(self.folder / "whole.lcmlog", made_run.messages(**of_the_run))
        return (self.folder / "whole.lcmlog").read_bytes()

    def begun(self):
        """A run's log that has just begun."""
        log = self.folder / "run.lcmlog.partial"
        log.write_bytes(b"")
        return log

    def test_a_log_that_grows_is_served_with_schema_units_and_values(self):
        log = self.begun()
        with connect(self.start(self.folder), subprotocols=["foxglove.sdk.v1", "foxglove.websocket.v1"]) as connection:
            viewer = Viewer(connection, ["SENSORS", "TORQUE"])
            viewer.watch(log, self.made())
        sensors, torque = (viewer.channels[name] for name in ("SENSORS", "TORQUE"))
        types = message_class(sensors), message_class(torque)
        for time, data in viewer.of("SENSORS").items():
            message = types[0].FromString(data)
            self.assertEqual(message.simulated_time, time)
            self.assertEqual(message.tip_acceleration, made_run.tip_acceleration(time // 1_000_000 / 5 * 0.005))
        for time, data in viewer.of("TORQUE").items():
            self.assertEqual(list(types[1].FromString(data).motor_torque), [100.0, -50.0] if time < 10e9 else [-240.0, 30.0])
        self.assertEqual(sensors["metadata"]["tip_acceleration"], "m/s^2")
        self.assertEqual(torque["metadata"]["motor_torque"], "Nm")
        self.assertEqual(units_of(sensors)["tip_acceleration"], "[m/s^2]")
        self.assertEqual(units_of(torque)["motor_torque"], "[Nm]")

    def test_who_waits_for_a_run_hears_every_channel_from_its_first_message(self):
        log = self.begun()
        motion = made_run.types.motion_t()
        motion.configuration_hash, motion.run_identity, motion.rope_length = made_run.HASH, made_run.RUN, 57.5
        motion.simulated_time = 500_000_000
        events = [*made_run.messages(), ("MOTION", motion.simulated_time, motion)]
        made_run.write_log(self.folder / "whole.lcmlog", sorted(events, key=lambda event: event[1]))
        wanted = {channel for channel, *_ in events}
        with connect(self.start(self.folder), subprotocols=["foxglove.sdk.v1"]) as connection:
            viewer = Viewer(connection, sorted(wanted))
            viewer.attend()
            with log.open("ab") as stream:
                stream.write((self.folder / "whole.lcmlog").read_bytes())
            viewer.hear_to_the_end()
        for channel in wanted:
            self.assertEqual(min(viewer.of(channel)), min(time for name, time, _ in events if name == channel), channel)
        self.assertEqual(sorted(viewer.of("OPERATOR")), [0, 2_000_000_000, 10_000_000_000])
        self.assertEqual(message_class(viewer.channels["MOTION"]).FromString(viewer.of("MOTION")[500_000_000]).rope_length, 57.5)

    def append(self, log, *events):
        """Writes (channel, time [ns], message) behind what is in a log."""
        made_run.write_log(self.folder / "more.lcmlog", events)
        with log.open("ab") as stream:
            stream.write((self.folder / "more.lcmlog").read_bytes())

    def operator(self, time, request):
        message = made_run.types.operator_t()
        message.simulated_time, message.run_identity, message.speed_request = time, made_run.RUN, request
        return "OPERATOR", time, message

    def test_who_comes_late_hears_at_once_what_stands(self):
        """The operator said something when the stop was pressed at 10 s, and nothing since; the run has come to 20 s."""
        log = self.begun()
        log.write_bytes(self.made())
        second = 1_000_000_000
        address = self.start(self.folder)
        with connect(address, subprotocols=["foxglove.sdk.v1"]) as first, connect(address, subprotocols=["foxglove.sdk.v1"]) as second_one:
            viewers = [Viewer(connection, ["OPERATOR"]) for connection in (first, second_one)]
            viewers[0].attend()
            while not viewers[0].of("OPERATOR"):
                viewers[0].hear()
            self.append(log, self.operator(21 * second, 0.25))
            while len(viewers[0].of("OPERATOR")) < 2:
                viewers[0].hear()
            viewers[1].attend()
            while not viewers[1].of("OPERATOR"):
                viewers[1].hear()
            self.append(log, self.operator(22 * second, 0.5))
            for viewer in viewers:
                while 22 * second not in viewer.of("OPERATOR"):
                    viewer.hear()
            kind = message_class(viewers[0].channels["OPERATOR"])
        said = [[(time / second, message.simulated_time / second, message.speed_request, message.emergency_stop)
                 for channel, time, data in viewer.told if channel for message in [kind.FromString(data)]] for viewer in viewers]
        # What stands is placed where the run has come to, and told to nobody who has heard it.
        self.assertEqual(said[0], [(19.99, 10, 1.0, True), (21, 21, 0.25, False), (22, 22, 0.5, False)])
        self.assertEqual(said[1], [(21, 21, 0.25, False), (22, 22, 0.5, False)])

    def test_a_run_of_another_machine_has_its_own_arrays_and_units(self):
        log = self.begun()
        with connect(self.start(self.folder), subprotocols=["foxglove.sdk.v1"]) as connection:
            viewer = Viewer(connection, ["SENSORS", "TORQUE"])
            viewer.attend()
            of_crane = dict(viewer.channels)
            with log.open("ab") as stream:
                stream.write(self.made())
            viewer.hear_to_the_end()
            self.assertEqual(list(message_class(of_crane["TORQUE"]).FromString(viewer.of("TORQUE")[0]).motor_torque), [100.0, -50.0])
            viewer.told.clear()
            # A linear motor, of one group, whose run begins in the same folder.
            (self.folder / "run.json").write_text(json.dumps({"machine": LINEAR_MOTOR}))
            events = made_run.messages(run_identity=made_run.RUN + 1)
            for channel, _time, message in events:
                if channel in ("ENCODER", "TORQUE"):
                    message.group_count = 1
                if channel == "ENCODER":
                    message.shaft_speed, message.shaft_position = [0.25], [0.0]
                if channel == "TORQUE":
                    message.motor_torque = [300.0]
            self.append(log, *[event for event in events if event[1] == 0])
            while any(viewer.channels.get(name) in (None, of_crane[name]) for name in viewer.wanted.values()):
                viewer.hear()
            viewer.wanted = {90: "TORQUE", 91: "SENSORS"}
            viewer.attend()
            self.append(log, *[event for event in events if event[1] > 0])
            viewer.hear_to_the_end()
        axis = viewer.channels["TORQUE"]
        self.assertEqual((axis["metadata"]["motor_torque"], units_of(axis)["motor_torque"]), ("N", "[N]"))
        messages = viewer.of("TORQUE")
        self.assertLessEqual(set(range(10_000_000, END, 10_000_000)), set(messages))
        self.assertEqual({tuple(message_class(axis).FromString(data).motor_torque) for data in messages.values()}, {(300.0,)})

    def test_a_linear_axis_has_its_own_units(self):
        (self.folder / "run.json").write_text(json.dumps({"machine": LINEAR_MOTOR}))
        log = self.begun()
        with connect(self.start(self.folder), subprotocols=["foxglove.sdk.v1"]) as connection:
            viewer = Viewer(connection, ["TORQUE", "SENSORS"])
            viewer.watch(log, self.made())
        torque = viewer.channels["TORQUE"]
        self.assertEqual(torque["metadata"]["motor_torque"], "N")
        self.assertEqual(units_of(torque)["motor_torque"], "[N]")

    def test_the_servers_clock_is_the_simulated_time(self):
        log = self.begun()
        channels = ["SENSORS", "TORQUE", "ENCODER", "TRUTH"]
        with connect(self.start(self.folder), subprotocols=["foxglove.sdk.v1"]) as connection:
            viewer = Viewer(connection, channels)
            viewer.watch(log, self.made())
            with log.open("ab") as stream:
                stream.write(self.made(run_identity=made_run.RUN + 1))
            viewer.hear_to_the_end()
        self.assertIn("time", viewer.capabilities)
        self.assertEqual({channel for channel, *_ in viewer.told}, {None, *channels})
        # Each of the two runs is in the order of time, so every message comes at its own, whichever channel it is of.
        clock = None
        for channel, time, _ in viewer.told:
            if channel is None:
                clock = time
            self.assertEqual(time, clock, channel)
        clocks = [time for channel, time, _ in viewer.told if channel is None]
        falls = [(before, after) for before, after in zip(clocks, clocks[1:]) if after <= before]
        self.assertEqual([before for before, _ in falls], [END])
        self.assertLess(falls[0][1], 1_000_000_000)

    def test_the_time_is_told_between_frames_wherever_they_are_cut(self):
        second = 1_000_000_000
        late = frame(0x82, DATA.pack(1, 7, 90 * second))
        frames = [  # and the time [ns] that is told ahead
            (frame(0x81, b'{"op": "serverInfo"}'), None),
            (frame(0x82, DATA.pack(1, 7, 3 * second) + b"abc"), 3 * second),
            (frame(0x82, DATA.pack(1, 8, 3 * second) + bytes(200)), None),                     # the same time
            (frame(0x82, DATA.pack(1, 8, 10 * second) + bytes([0x82, 13, 1] * 100)), 10 * second),  # heads in a message
            (frame(0x89, b"ping"), None),
            (frame(0x82, DATA.pack(1, 7, 12 * second) + bytes(70_000)), 12 * second),
            (frame(0x82, DATA.pack(1, 7, 8 * second)), None),                                  # late
            (frame(0x82, DATA.pack(1, 7, 7 * second)), None),
            (frame(0x82, DATA.pack(3, 7, 50 * second)), None),                                 # another opcode
            (frame(0x82, b"\x01\x07"), None),                                                  # no message
            (frame(0x82, b""), None),
            (frame(0x02, DATA.pack(1, 7, 60 * second)), None),                                 # one message in three parts
            (frame(0x00, late), None),
            (frame(0x80, late), None),
            (frame(0x81, late), None),
            (frame(0x82, DATA.pack(1, 7, 13 * second) + bytes(65_535 - DATA.size)), 13 * second),
            (frame(0x82, DATA.pack(1, 7, 8 * second - 1)), 8 * second - 1),                    # another run
            (frame(0x82, DATA.pack(1, 7, 0)), 0),
            (frame(0x82, DATA.pack(1, 7, 1)), 1),
            (frame(0x88, b"\x03\xe8"), None),
        ]
        said = b"".join(each for each, _ in frames)
        wanted = b"".join((b"" if time is None else frame(0x82, TIME.pack(2, time))) + each for each, time in frames)
        heads, place = [], 0
        for each, _ in frames:
            heads += range(place, min(place + 24, len(said)))
            place += len(each)
        drawn = random.Random(1)
        for _ in range(300):
            cuts = sorted(drawn.sample(heads, drawn.randrange(30)) + drawn.choices(range(len(said)), k=drawn.randrange(10)))
            made, rest, clock = [], b"", None
            for begin, end in zip([0, *cuts], [*cuts, len(said)]):
                whole, rest, clock = with_clock(rest + said[begin:end], clock)
                made.append(whole)
            self.assertEqual((b"".join(made) == wanted, rest, clock), (True, b"", 1), cuts)

    def test_the_end_is_told_to_viewers(self):
        self.begun()
        with (self.folder / "stderr").open("w+") as stderr:
            with connect(self.start(self.folder, stderr=stderr), subprotocols=["foxglove.sdk.v1"]) as connection:
                Viewer(connection, []).hear()
                self.bridge.terminate()
                with self.assertRaises(ConnectionClosed) as closed:
                    while True:
                        connection.recv(PATIENCE)
            self.assertEqual(self.bridge.wait(PATIENCE), 0)
            self.assertIsNotNone(closed.exception.rcvd)
            self.assertEqual((self.folder / "stderr").read_text(), "")

    def test_a_viewer_that_reads_nothing_holds_up_no_end(self):
        log, data = self.begun(), self.made()
        address = self.start(self.folder)
        self.addCleanup(self.bridge.kill)
        with connect(address, subprotocols=["foxglove.sdk.v1"], max_queue=1, close_timeout=0) as silent, \
                connect(address, subprotocols=["foxglove.sdk.v1"]) as other:
            Viewer(silent, ["SENSORS", "TORQUE", "ENCODER", "TRUTH"]).watch(log, data)
            viewer = Viewer(other, ["SENSORS"])
            viewer.watch(log, data)
            with log.open("ab") as stream:
                stream.write(data * REPEATED)
            for _ in range(REPEATED):
                viewer.hear_to_the_end()
            self.bridge.terminate()
            self.assertEqual(self.bridge.wait(PATIENCE), 0)

    def test_a_viewer_may_ask_by_the_protocols_older_name(self):
        (self.folder / "run.lcmlog.partial").write_bytes(b"")
        address = self.start(self.folder)
        for asked, granted in ((["foxglove.websocket.v1"], "foxglove.websocket.v1"), (["foxglove.sdk.v1"], "foxglove.sdk.v1"),
                               (["foxglove.sdk.v1", "foxglove.websocket.v1"], "foxglove.sdk.v1")):
            with self.subTest(asked=asked), connect(address, subprotocols=asked) as viewer:
                self.assertEqual(viewer.subprotocol, granted)
                self.assertEqual(json.loads(viewer.recv(PATIENCE))["name"], "slewlab")
        with self.assertRaises(InvalidStatus) as refused, connect(address, subprotocols=["mqtt"]):
            pass
        self.assertEqual(refused.exception.response.status_code, 400)
        self.assertIn(b"sec-websocket-protocol", refused.exception.response.body)

    def test_a_port_that_is_taken_is_said(self):
        with socket.create_server(("127.0.0.1", 0)) as other:
            run = subprocess.run([SLEWLAB, "bridge", "--foxglove", made_run.write_run(self.folder / "a"), "--port", str(other.getsockname()[1])],
                                 stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(run.returncode, 1)
        self.assertIn("in use", run.stderr)

    def test_what_is_no_log_is_refused(self):
        table = self.folder / "rec.csv"
        table.write_text("time,speed\n" + "0.1,2.5\n" * 20)
        for wrong, words in ((self.folder / "nothere", "found no log and no folder of that name"), (table, "found a file that is no log of LCM"),
                             (self.folder, "found a folder without run.lcmlog")):
            for command in (["bridge", "--foxglove", wrong, "--port", "0"], ["desk", wrong, "--follow"]):
                with self.subTest(wrong=wrong, command=command[0]):
                    run = subprocess.run([SLEWLAB, *command], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
                    self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), run.stderr)
                    self.assertIn(words, run.stderr)

    def test_a_log_tells_its_machine_itself_and_a_bus_only_by_a_folder_that_is_there(self):
        for arguments, words in (([self.folder, "--run", self.folder], "--run belongs to --bus"),
                                 (["--bus", "udpm://239.255.76.67:7667?ttl=0", "--run", self.folder], "run.json: there is no such file")):
            run = subprocess.run([SLEWLAB, "bridge", "--foxglove", *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
            self.assertEqual(run.returncode, 2)
            self.assertIn(words, run.stderr)

    def test_it_is_served_on_loopback_alone(self):
        run = subprocess.run([SLEWLAB, "bridge", "--foxglove", self.folder, "--host", "0.0.0.0"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(run.returncode, 2)
        self.assertIn("loopback alone", run.stderr)


if __name__ == "__main__":
    unittest.main()
