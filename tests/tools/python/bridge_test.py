"""The bridge against a client of Foxglove's protocol: schema, units and values of what a growing log gets."""

import base64
import contextlib
import json
import os
import re
import socket
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

import made_run

SLEWLAB = Path(os.environ["SLEWLAB_PYTHON_MESSAGES"]).parent / "bin" / "slewlab"
PATIENCE = 60.0  # [s]
DATA = struct.Struct("<BIQ")  # of the protocol: opcode, subscription, time [ns]


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


class BridgeTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def start(self, *arguments):
        process = subprocess.Popen([SLEWLAB, "bridge", "--foxglove", "--port", "0", *map(str, arguments)], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait, PATIENCE)
        self.addCleanup(process.terminate)
        return re.search(r"ws://\S+", process.stdout.readline()).group(0)

    def test_a_log_that_grows_is_served_with_schema_units_and_values(self):
        log = self.folder / "run.lcmlog.partial"
        events = made_run.messages()
        made_run.write_log(self.folder / "whole.lcmlog", events)
        whole = (self.folder / "whole.lcmlog").read_bytes()
        log.write_bytes(b"")
        address = self.start(self.folder)
        with connect(address, subprotocols=["foxglove.sdk.v1", "foxglove.websocket.v1"]) as viewer:
            with log.open("ab") as stream:
                stream.write(whole[:100_000])
            channels = {}
            while set(channels) < {"SENSORS", "TORQUE", "ENCODER", "TRUTH", "OPERATOR"}:
                told = viewer.recv(PATIENCE)
                if isinstance(told, str) and json.loads(told)["op"] == "advertise":
                    channels |= {each["topic"]: each for each in json.loads(told)["channels"]}
            wanted = {7: "SENSORS", 8: "TORQUE"}

            def subscribe(numbers):
                viewer.send(json.dumps({"op": "unsubscribe", "subscriptionIds": numbers}))
                viewer.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": number, "channelId": channels[wanted[number]]["id"]}
                                                                             for number in numbers]}))

            subscribe([7, 8])
            types = {7: message_class(channels["SENSORS"]), 8: message_class(channels["TORQUE"])}
            found = {7: {}, 8: {}}

            def hear(patience):
                told = viewer.recv(patience)
                if isinstance(told, bytes) and told[0] == 1:
                    _, subscription, time = DATA.unpack_from(told)
                    found[subscription][time] = types[subscription].FromString(told[DATA.size:])

            # Nobody says when a subscription begins to count, or whether it came too early: the log grows a little at a time until
            # something is heard of both.
            written, last = 100_000, len(whole) - 100_000
            while not (found[7] and found[8]):
                self.assertLess(written, last, "nothing was heard of a log that grew")
                with log.open("ab") as stream:
                    stream.write(whole[written:min(written + 10_000, last)])
                written = min(written + 10_000, last)
                with contextlib.suppress(TimeoutError):
                    while True:
                        hear(0.5)
                if missing := [number for number in found if not found[number]]:
                    subscribe(missing)
            with log.open("ab") as stream:
                stream.write(whole[written:])
            while max(found[7]) < 20_000_000_000:
                hear(PATIENCE)
        for time, message in found[7].items():
            self.assertEqual(message.simulated_time, time)
            self.assertEqual(message.tip_acceleration, made_run.tip_acceleration(time // 1_000_000 / 5 * 0.005))
        for time, message in found[8].items():
            self.assertEqual(list(message.motor_torque), [100.0, -50.0] if time < 10e9 else [-240.0, 30.0])
        self.assertEqual(channels["SENSORS"]["metadata"]["tip_acceleration"], "m/s^2")
        self.assertEqual(channels["TORQUE"]["metadata"]["motor_torque"], "Nm")
        self.assertEqual(units_of(channels["SENSORS"])["tip_acceleration"], "[m/s^2]")
        self.assertEqual(units_of(channels["TORQUE"])["motor_torque"], "[Nm]")

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

    def test_it_is_served_on_loopback_alone(self):
        run = subprocess.run([SLEWLAB, "bridge", "--foxglove", self.folder, "--host", "0.0.0.0"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(run.returncode, 2)
        self.assertIn("loopback alone", run.stderr)


if __name__ == "__main__":
    unittest.main()
