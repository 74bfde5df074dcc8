"""Foxglove's protocol under its older name, and with a clock.

foxglove-sdk serves "foxglove.sdk.v1" and turns away who asks for "foxglove.websocket.v1", as Lichtblick did until the end of 2025 and
others still do; the two are one protocol. So viewers connect here, and the name is the only thing that is changed in what they say.

Foxglove Studio and Lichtblick place a message at the server's clock when it comes, not at the time that it carries, and at the wall clock
where the server tells none. So every message that is later than all before it gets its time told ahead of it. The SDK's broadcast_time does
not: it goes by another queue than the messages.

Nothing is held but what is under way, which is a frame at most: who reads slowly is seen as slow by the server.
"""

import asyncio
import contextlib
import struct
import threading

NAME, OLDER = b"foxglove.sdk.v1", b"foxglove.websocket.v1"
LONGEST_HEAD = 1 << 14  # [bytes] of a request or its answer
PIECE = 1 << 16         # [bytes] handed on at a time
PATIENCE = 10.0         # [s] for a request and its answer
GRANTED = b"HTTP/1.1 101"  # begins the answer behind which frames come; behind any other one stands why
WHOLE_BINARY = 0x82     # first byte of a frame that is a binary message as a whole (RFC 6455, section 5.2); the server sends no message in parts
MESSAGE, TIME = 1, 2    # Foxglove's opcodes
MESSAGE_HEAD = struct.Struct("<BIQ")  # opcode, subscription, time [ns]
TIME_FRAME = struct.Struct("<BBBQ")   # WHOLE_BINARY, length of what follows, opcode, time [ns]
ANOTHER_RUN = 5_000_000_000  # [ns] by which only the messages of another run lie behind the clock


def renamed(head, old, new):
    """An HTTP head in which another subprotocol is asked for or granted."""
    lines = head.split(b"\r\n")
    return b"\r\n".join(line.replace(old, new) if line.lower().startswith(b"sec-websocket-protocol:") else line for line in lines)


def with_clock(data, clock):
    """What a server says, from the beginning of a frame on: its whole frames, with the time ahead of a message that is later than `clock` [ns]
    (None before the first one) or of another run; the rest, which is no frame yet; the clock then."""
    told, place = [], 0
    while place + 2 <= len(data):
        begin, length = place + 2, data[place + 1]  # a server masks nothing
        if length >= 126:
            begin += 2 if length == 126 else 8
            length = int.from_bytes(data[place + 2:begin], "big")
        end = begin + length
        if end > len(data):
            break
        if data[place] == WHOLE_BINARY and length >= MESSAGE_HEAD.size and data[begin] == MESSAGE:
            _, _, time = MESSAGE_HEAD.unpack_from(data, begin)
            if clock is None or not clock - ANOTHER_RUN <= time <= clock:
                clock = time
                told.append(TIME_FRAME.pack(WHOLE_BINARY, TIME_FRAME.size - 2, TIME, time))
        told.append(data[place:end])
        place = end
    return b"".join(told), data[place:], clock


async def hand_on(reader, writer, is_clocked=False):
    rest, clock = b"", None
    try:
        while piece := await reader.read(PIECE):
            if is_clocked:
                piece, rest, clock = with_clock(rest + piece, clock)
            writer.write(piece)
            await writer.drain()
    finally:
        writer.close()


class SubprotocolProxy:
    """Listens on (host, port) and hands on to the server at (host, behind), in a thread of its own."""

    def __init__(self, host, port, behind):
        self.host, self.behind, self.port, self.problem = host, behind, port, None
        self.is_ready = threading.Event()
        self.thread = threading.Thread(target=lambda: asyncio.run(self.serve()), daemon=True)

    def start(self):
        """OSError where it cannot listen there."""
        self.thread.start()
        self.is_ready.wait()
        if self.problem is not None:
            raise self.problem
        return self

    async def serve(self):
        self.loop, self.end = asyncio.get_running_loop(), asyncio.Event()
        try:
            server = await asyncio.start_server(self.connect, self.host, self.port, limit=LONGEST_HEAD)
        except OSError as problem:
            self.problem = problem
            self.is_ready.set()
            return
        self.port = server.sockets[0].getsockname()[1]
        self.is_ready.set()
        await self.end.wait()
        server.close()

    async def connect(self, viewer, to_viewer):
        with contextlib.suppress(OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, TimeoutError), contextlib.closing(to_viewer):
            request = await asyncio.wait_for(viewer.readuntil(b"\r\n\r\n"), PATIENCE)
            server, to_server = await asyncio.open_connection(self.host, self.behind, limit=LONGEST_HEAD)
            with contextlib.closing(to_server):
                is_older = OLDER in request and NAME not in request
                to_server.write(renamed(request, OLDER, NAME) if is_older else request)
                answer = await asyncio.wait_for(server.readuntil(b"\r\n\r\n"), PATIENCE)
                to_viewer.write(renamed(answer, NAME, OLDER) if is_older else answer)
                await asyncio.gather(hand_on(viewer, to_server), hand_on(server, to_viewer, answer.startswith(GRANTED)))

    def stop(self):
        self.loop.call_soon_threadsafe(self.end.set)
        self.thread.join(PATIENCE)
