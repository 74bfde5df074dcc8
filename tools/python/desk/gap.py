"""The gap between a running machine and its nominal model: the diagnosis' observer as a process beside the desk
(tools/python/live_observer.cpp), what it says in the store of the run, and when that is more than usual."""

import asyncio
import collections
import json
import math

import numpy as np

from run_log import messages_folder
from desk.source import event_bytes

CHANNEL = "OBSERVER"
FEWEST_BLOCKS = 10  # until something is called usual
UNUSUAL = 4.0      # times the usual size, chosen: sizes of noise over a block stay within a third of each other
FLOOR_SHARE = 0.02  # of the rated torque, chosen: below it a missing torque is none that anybody looks for
FLOOR_ACCELERATION = 0.02  # [m/s^2] chosen: four times the noise of an ordinary accelerometer
MOST_WAITING = 1 << 26  # [bytes] that the observer may be behind
USED = ("ENCODER", "TORQUE", "SENSORS", "PLANT_STATUS")


class Sizes:
    """Of one signal, a block of `length` [s] after the other: its size (root mean square), what is usual, whether it is more than that."""

    def __init__(self, floor, length):
        self.floor, self.length, self.sizes, self.square, self.count, self.block = floor, length, collections.deque(maxlen=600), 0.0, 0, None
        self.newest, self.is_open = math.nan, False

    @property
    def usual(self):
        """The median of the blocks that were not called unusual."""
        return float(np.median(self.sizes)) if len(self.sizes) >= FEWEST_BLOCKS else math.nan

    def add(self, time, values):
        blocks = np.floor(time / self.length)
        for block in np.unique(blocks):
            mine = values[(blocks == block) & np.isfinite(values)]
            if block != self.block:
                self._close()
                self.block = block
            self.square, self.count = self.square + float(np.sum(mine**2)), self.count + len(mine)

    def _close(self):
        if self.count:
            self.newest = math.sqrt(self.square / self.count)
            usual = self.usual
            self.is_open = self.newest > max(self.floor, UNUSUAL * usual) if math.isfinite(usual) else False
            if not self.is_open:
                self.sizes.append(self.newest)
        self.square, self.count = 0.0, 0


class Gap:
    def __init__(self, source, nominal, minute):
        """`minute` keeps the newest events, for a diagnosis."""
        self.source, self.nominal, self.minute = source, nominal, minute
        self.sizes, self.since, self.problem, self.remark = {}, None, "", ""
        self.block = math.nan  # [s] the machine's characteristic time, which the observer says first
        source.incoming.taps.append(self.feed)

    async def start(self):
        self.process = await asyncio.create_subprocess_exec(
            messages_folder() / "slewlab-live-observer", self.nominal, stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE, limit=1 << 24, start_new_session=True)
        self.listening = asyncio.create_task(self._listen())

    def feed(self, events):
        """Hands the events on; an observer that cannot keep up is left behind and says so."""
        self.minute.take(events, self.source.store.last)
        pipe = self.process.stdin
        if self.problem or pipe.is_closing():
            return
        if pipe.transport.get_write_buffer_size() > MOST_WAITING:
            self.problem = "the observer cannot keep up with the run"
            return
        pipe.write(b"".join(event_bytes(0, 0.0, channel, data) for channel, data in events if channel in USED))

    async def _listen(self):
        async for line in self.process.stdout:
            said = json.loads(line)
            if "characteristic_time" in said:
                self.block = said["characteristic_time"]
            elif "time" in said:
                self._take(said)
            elif "begins_again" in said:
                self.remark = f"the observer began again: {said['begins_again']}"
        words = (await self.process.stderr.read()).decode(errors="replace").strip()
        if await self.process.wait() != 0:
            self.problem = words or "the observer ended"

    def _take(self, said):
        time = np.array(said["time"])
        columns = {"missing_torque": np.array(said["missing_torque"], float).T}
        for place, values in said["acceleration_difference"].items():
            columns[f"{place}_difference"] = np.array(values, float)
        self.source.store.append(CHANNEL, time, columns)
        rated = self.source.facts.get("rated_torque", 0.0)
        for group, values in enumerate(columns["missing_torque"].T):
            self._size(f"missing_torque.{group}", f"missing torque of group {group + 1}", FLOOR_SHARE * rated, time, values)
        for place in said["acceleration_difference"]:
            self._size(f"{place}_difference", f"acceleration at the {place}", FLOOR_ACCELERATION, time, columns[f"{place}_difference"])
        is_open = any(sizes.is_open for _, sizes in self.sizes.values())
        self.since = (self.since if self.since is not None else float(time[-1])) if is_open else None

    def _size(self, signal, label, floor, time, values):
        if signal not in self.sizes:
            self.sizes[signal] = label, Sizes(floor, self.block)
        self.sizes[signal][1].add(time, values)

    def state(self):
        def known(value):
            return value if math.isfinite(value) else None

        return {"problem": self.problem, "remark": self.remark, "since": self.since,
                "signals": [{"signal": f"{CHANNEL}.{signal}", "label": label, "size": known(sizes.newest), "usual": known(sizes.usual),
                             "open": sizes.is_open} for signal, (label, sizes) in self.sizes.items()]}

    async def end(self):
        self.process.stdin.close()
        try:
            await asyncio.wait_for(asyncio.shield(self.listening), 5.0)
        except TimeoutError:
            self.process.kill()
            await self.listening
