"""Foxglove's protocol under its older name.

foxglove-sdk serves "foxglove.sdk.v1" and turns away who asks for "foxglove.websocket.v1", as Lichtblick did until the end of 2025 and
others still do; the two are one protocol. So viewers connect here, the name is the only thing that is changed in what they say first,
and everything behind that is handed on as it comes. Nothing is held but what is under way: who reads slowly is seen as slow by the server.
"""

import asyncio
import contextlib
import threading

NAME, OLDER = b"foxglove.sdk.v1", b"foxglove.websocket.v1"
LONGEST_HEAD = 1 << 14  # [bytes] of a request or its answer
PIECE = 1 << 16         # [bytes] handed on at a time
PATIENCE = 10.0         # [s] for a request and its answer


def renamed(head, old, new):
    """An HTTP head in which another subprotocol is asked for or granted."""
    lines = head.split(b"\r\n")
    return b"\r\n".join(line.replace(old, new) if line.lower().startswith(b"sec-websocket-protocol:") else line for line in lines)


async def hand_on(reader, writer):
    try:
        while piece := await reader.read(PIECE):
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
                await asyncio.gather(hand_on(viewer, to_server), hand_on(server, to_viewer))

    def stop(self):
        self.loop.call_soon_threadsafe(self.end.set)
        self.thread.join(PATIENCE)
