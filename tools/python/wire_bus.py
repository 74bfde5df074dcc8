"""The bus over LCM's UDP multicast, for processes of the Python side that answer in lockstep. As msgs/lcm_bus.h on a socket of its own: the
thread that waits is the one that reads (liblcm's reader thread costs two changes of thread in every round trip), and a signal's handler
runs while it waits. Messages of one datagram alone, as all of slewlab's are."""

import ctypes
import socket
import struct
from urllib.parse import parse_qs, urlsplit

WORD = 0x4C433032  # "LC02"
HEAD = struct.Struct(">II")  # the word, a running number
LARGEST_DATAGRAM = 65_507  # [bytes] of UDP over IPv4
UDP_HEAD = 8  # [bytes] before the datagram's own, of what the kernel's filter sees
SO_ATTACH_FILTER = 26  # asm-generic/socket.h; Python's module has no name for it
RECEIVE_BUFFER = 4 << 20  # [bytes] for all that may arrive while this side does not run
LONGEST_WAIT = 200_000  # [us] for which a signal may go unnoticed that came just before the wait and does not interrupt it


class WireBus:
    def __init__(self, url):
        address = urlsplit(url)
        if address.scheme != "udpm" or not address.hostname:
            raise ValueError(f"'{url}' is no bus; one looks like udpm://239.255.76.67:7667?ttl=0")
        self.group = (address.hostname, address.port or 7667)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("ll", 0, LONGEST_WAIT))
        self.socket.bind(self.group)  # to the group: other groups on the port are not heard
        everywhere = socket.inet_aton(self.group[0]) + socket.inet_aton("0.0.0.0")
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, everywhere)
        time_to_live = int(parse_qs(address.query).get("ttl", ["0"])[0])
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, time_to_live)
        self.sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, time_to_live)
        self.sender.connect(self.group)
        self.handlers = {}  # by the channel's name with its zero
        self.sent = 0

    def subscribe(self, channel, handler):
        """`handler(data)` is called of every message on the channel."""
        self.handlers[channel.encode()] = handler

    def hear_subscribed_only(self):
        """Nobody is woken for a datagram of another channel: what the bus carries besides (its own messages come back too) is dropped by the
        kernel, by a filter of the classic Berkeley form over the first four letters of the channel, three and its zero. After the last subscribe()."""
        begins = sorted({(channel + b"\0")[:4] for channel in self.handlers})
        if any(len(begin) < 4 for begin in begins):
            raise ValueError("a channel's name of less than three letters cannot be told by the kernel's filter")
        load, equal, answer = 0x20, 0x15, 0x06  # linux/bpf_common.h: ld [k]; jeq #k, jt, jf; ret #k
        steps = [(load, 0, 0, UDP_HEAD + HEAD.size)]
        steps += [(equal, len(begins) - number, 0, int.from_bytes(begin, "big")) for number, begin in enumerate(begins)]
        steps += [(answer, 0, 0, 0), (answer, 0, 0, LARGEST_DATAGRAM + UDP_HEAD)]
        program = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *step) for step in steps))
        self.socket.setsockopt(socket.SOL_SOCKET, SO_ATTACH_FILTER, struct.pack("HP", len(steps), ctypes.addressof(program)))

    def publish(self, channel, data):
        self.sender.send(HEAD.pack(WORD, self.sent & 0xFFFFFFFF) + channel.encode() + b"\0" + data)
        self.sent += 1

    def handle(self):
        """Waits for a datagram, not for ever; its handler, where its channel has one."""
        try:
            datagram = self.socket.recv(LARGEST_DATAGRAM)
        except BlockingIOError:
            return
        end = datagram.find(b"\0", HEAD.size)
        if end < 0 or HEAD.unpack_from(datagram)[0] != WORD:
            return
        handler = self.handlers.get(datagram[HEAD.size:end])
        if handler is not None:
            handler(datagram[end + 1:])
