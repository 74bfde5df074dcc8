"""The newest minute of a run for `slewlab diagnose`, which runs beside the desk."""

import asyncio
from collections import deque
from pathlib import Path

from run_log import slewlab_program
from desk.source import EVENT, SYNC

SPAN = 60.0  # [s]
LAST_WORDS = 3


class Minute:
    """The newest events as they came, no older than SPAN before the newest ENCODER."""

    def __init__(self):
        self.events = deque()

    def take(self, events, newest):
        self.events.extend((newest, channel, data) for channel, data in events)
        while self.events and self.events[0][0] < newest - SPAN:
            self.events.popleft()

    def write(self, path):
        with path.open("wb") as file:
            for number, (time, channel, data) in enumerate(self.events):
                name = channel.encode()
                file.write(EVENT.pack(SYNC, number, max(0, int(time * 1e6)), len(name), len(data)) + name + data)


class Diagnosis:
    def __init__(self, nominal, controller, out):
        self.nominal, self.controller, self.out = nominal, controller, Path(out)
        self.minute, self.process, self.words, self.folder = Minute(), None, deque(maxlen=LAST_WORDS), None

    async def begin(self, source):
        if self.process is not None and self.process.returncode is None:
            return
        number = 1
        while (self.out / f"diagnosis_{number}").exists():
            number += 1
        self.folder = self.out / f"diagnosis_{number}"
        self.folder.mkdir(parents=True)
        log = self.folder / "last_minute.lcmlog"
        self.minute.write(log)
        self.words.clear()
        controller = ["--controller", self.controller] if self.controller else []
        self.process = await asyncio.create_subprocess_exec(
            slewlab_program(), "diagnose", "--crane", self.nominal, *controller, "--log", log,
            "--out", self.folder, stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT, start_new_session=True)
        self.listening = asyncio.create_task(self._listen())

    async def _listen(self):
        async for line in self.process.stdout:
            words = line.decode(errors="replace").strip()
            if words:
                self.words.append(words)
        await self.process.wait()

    def state(self):
        if self.process is None:
            return {"state": "ready"}
        code = self.process.returncode
        return {"state": "under way" if code is None else "done" if code == 0 else "failed", "folder": str(self.folder), "words": list(self.words)}

    async def end(self):
        if self.process is not None and self.process.returncode is None:
            self.process.terminate()
            await self.listening
