"""The bus of the Python side against LCM's own library, both ways, and against bytes that are none of its."""

import signal
import socket
import unittest

import lcm

from wire_bus import HEAD, WORD, WireBus


def free_bus():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return f"udpm://239.255.76.67:{probe.getsockname()[1]}?ttl=0"


class WireBusTest(unittest.TestCase):
    def setUp(self):
        self.url = free_bus()
        self.bus = WireBus(self.url)

    def tearDown(self):
        self.bus.socket.close()
        self.bus.sender.close()

    def test_it_and_lcms_library_hear_each_other(self):
        library, heard = lcm.LCM(self.url), []
        library.subscribe("TORQUE", lambda channel, data: heard.append((channel, data)))
        self.bus.subscribe("ENCODER", lambda data: heard.append(("ENCODER", data)))
        self.bus.publish("TORQUE", b"a\0b")
        self.assertGreater(library.handle_timeout(10_000), 0)
        library.publish("ENCODER", b"c\0d")
        while len(heard) < 2:
            self.bus.handle()  # its own TORQUE first
        self.assertEqual(heard, [("TORQUE", b"a\0b"), ("ENCODER", b"c\0d")])

    def test_bytes_that_are_no_message_are_passed_over(self):
        heard = []
        self.bus.subscribe("A", heard.append)
        whole = HEAD.pack(WORD, 0) + b"A\0data"
        for datagram in (b"", b"LC", whole[:9], b"XC02" + whole[4:], HEAD.pack(WORD, 0) + b"B\0data", whole):
            self.bus.sender.send(datagram)
        for _ in range(6):
            self.bus.handle()
        self.assertEqual(heard, [b"data"])

    def test_it_is_woken_by_what_it_subscribed_to_alone(self):
        heard = []
        for channel in ("ENCODER", "ENCORE", "ABC"):
            self.bus.subscribe(channel, lambda data, channel=channel: heard.append((channel, data)))
        self.bus.hear_subscribed_only()
        for channel in ("TORQUE", "ENCODER", "ABCD", "ABC", "SENSORS", "ENCORE"):
            self.bus.publish(channel, channel.encode())
        for _ in range(3):
            self.bus.handle()
        self.assertEqual(heard, [("ENCODER", b"ENCODER"), ("ABC", b"ABC"), ("ENCORE", b"ENCORE")])
        self.bus.handle()  # there is nothing more; it comes back
        self.assertEqual(len(heard), 3)

    def test_a_wait_for_nothing_comes_back_for_a_signal_may_have_come_just_before_it(self):
        self.bus.subscribe("ENCODER", self.fail)
        self.bus.handle()

    def test_a_signal_ends_the_wait(self):
        class Ended(Exception):
            pass

        def end(number, frame):
            raise Ended

        before = signal.signal(signal.SIGALRM, end)
        try:
            with self.assertRaises(Ended):
                signal.setitimer(signal.ITIMER_REAL, 0.05)
                while True:
                    self.bus.handle()
        finally:
            signal.signal(signal.SIGALRM, before)

    def test_what_is_no_address_is_refused(self):
        with self.assertRaisesRegex(ValueError, "is no bus"):
            WireBus("tcpq://localhost")


if __name__ == "__main__":
    unittest.main()
