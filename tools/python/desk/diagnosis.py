"""The newest minute of a run for `slewlab diagnose`, which runs beside the desk."""

import asyncio
import contextlib
from collections import deque
from pathlib import Path

from run_log import slewlab_program
from whole_file import next_folder
from desk.source import event_bytes

SPAN = 60.0  # [s]
STANDING = ("OPERATOR", "PLANT_STATUS")  # what their last message says stands until the next one
LATER = (0.0, 1.5, 3.0)  # [s] by which the minute begins later where it is refused: not every moment is one to begin at; chosen
MOST = 1 << 20  # [events] that are held of it: a run that stands still may say the same again and again
CANNOT_TELL = 3  # exit code of slewlab diagnose (docs/command_line.md)
LAST_WORDS = 3


class Minute:
    """The newest events as they came, no older than SPAN before the newest ENCODER, and what still stands of those before."""

    def __init__(self):
        self.events, self.standing = deque(), {}

    def copy(self):
        held = Minute()
        held.events, held.standing = self.events.copy(), self.standing.copy()
        return held

    def take(self, events, newest):
        self.events.extend((newest, channel, data) for channel, data in events)
        while self.events and (self.events[0][0] < newest - SPAN or len(self.events) > MOST):
            drop(self.events, self.standing)

    def clear(self):
        """As at the beginning: of another run."""
        self.events.clear()
        self.standing.clear()

    def write(self, path, later=0.0):
        """`later` [s]: without so much of its beginning."""
        cut = self.copy()
        begin = cut.events[0][0] + later if cut.events else 0.0
        while cut.events and cut.events[0][0] < begin:
            drop(cut.events, cut.standing)
        cut.events.extendleft((begin, channel, data) for channel, data in cut.standing.items())
        with path.open("wb") as file:
            for number, (time, channel, data) in enumerate(cut.events):
                file.write(event_bytes(number, time, channel, data))


def drop(events, standing):
    """Takes the oldest event away; of a channel whose messages stand it stays in `standing`."""
    _, channel, data = events.popleft()
    if channel in STANDING:
        standing[channel] = data


class Diagnosis:
    def __init__(self, nominal, controller, out):
        self.nominal, self.controller, self.out = nominal, controller, Path(out)
        self.minute, self.process, self.words, self.folder = Minute(), None, deque(maxlen=LAST_WORDS), None
        self.listening = None

    async def begin(self, source):
        if self.is_under_way:
            return
        self.folder = next_folder(self.out, "diagnosis_")
        self.folder.mkdir(parents=True)
        minute = self.minute.copy()
        await self._try(minute, LATER[0])
        self.listening = asyncio.create_task(self._listen(minute))

    async def _try(self, minute, later):
        log = self.folder / "last_minute.lcmlog"
        minute.write(log, later)
        controller = ["--controller", self.controller] if self.controller else []
        self.words.clear()
        self.process = await asyncio.create_subprocess_exec(
            slewlab_program(), "diagnose", "--crane", self.nominal, *controller, "--log", log,
            "--out", self.folder, stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT, start_new_session=True)

    async def _listen(self, minute):
        for later in (*LATER[1:], None):
            async for line in self.process.stdout:
                words = line.decode(errors="replace").strip()
                if words:
                    self.words.append(words)
            if await self.process.wait() != CANNOT_TELL or later is None:
                return
            await self._try(minute, later)

    @property
    def is_under_way(self):
        return self.listening is not None and not self.listening.done()

    def state(self):
        if self.listening is None:
            return {"state": "ready"}
        state = "under way" if self.is_under_way else {0: "done", CANNOT_TELL: "cannot tell"}.get(self.process.returncode, "failed")
        return {"state": state, "folder": str(self.folder), "words": list(self.words)}

    async def end(self):
        if self.is_under_way:
            self.listening.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self.listening
            if self.process.returncode is None:
                self.process.terminate()
                await self.process.wait()
