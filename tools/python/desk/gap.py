"""The gap between a running machine and its nominal model: the diagnosis' observer as a process beside the desk
(tools/python/live_observer.cpp), what it says in the store of the run, and when that is more than usual."""

import asyncio
import collections
import json
import math
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from run_log import LogProblem, message_types, messages_folder
from desk.source import event_bytes, motor_groups

CHANNEL = "OBSERVER"
FEWEST_BLOCKS = 10  # until something is called usual
UNUSUAL = 4.0      # times the usual size, chosen: sizes of noise over a block stay within a third of each other
FLOOR_SHARE = 0.02  # of the rated torque, chosen: below it a missing torque is none that anybody looks for
FLOOR_ACCELERATION = 0.02  # [m/s^2] chosen: four times the noise of an ordinary accelerometer
MOST_WAITING = 1 << 26  # [bytes] that the observer may be behind
USED = ("ENCODER", "TORQUE", "SENSORS", "PLANT_STATUS")
MOTIONS = {"rope_length": "hoists", "boom_angle": "luffs", "travelled": "travels"}  # by field of MOTION
MOVED = 1e-6  # [m], [rad] chosen: above rounding


@dataclass(frozen=True)
class Nominal:
    """The nominal machine: its file, and what its motors are rated for, each in [N m], or in [N] where they do not turn."""

    path: Path
    rated: float
    unit: str

    @property
    def effort(self):
        return "force" if self.unit == "N" else "torque"


def read_machine(path):
    """LogProblem where the file is none of a machine, or anything in it is wrong."""
    from core_module import core

    try:
        return core.Machine(Path(path), [])
    except core.InputError as problems:
        raise LogProblem(str(problems)) from problems


def refuse_controller_of_an_axis(path):
    """LogProblem where the nominal machine is an axis: its diagnosis takes no controller's file."""
    if read_machine(path).kind == "axis":
        raise LogProblem(f"{path}: found an axis, expected no --nominal-controller beside it")


def refuse_another_machine(path, facts):
    """LogProblem where run.json tells a machine of another kind, or of another number of motor groups, than the nominal one is."""
    if "machine" not in facts:
        return
    nominal, runs = read_machine(path), facts["machine"]
    found, expected = (nominal.kind, nominal.group_count), (runs.get("kind", nominal.kind), motor_groups(facts) or nominal.group_count)
    if found != expected:
        raise LogProblem(f"{path}: found {in_words(*found)}, expected {in_words(*expected)}, as the machine that runs")


def in_words(kind, groups):
    return f"{'an axis' if kind == 'axis' else f'a {kind}'} with {groups} motor group{'s' if groups > 1 else ''}"


def read_nominal(path):
    machine = read_machine(path)
    return Nominal(Path(path), machine.rated_torque, "N" if machine.is_shaft_linear else "N m")


def is_effort(signal):
    """Whether a signal is the motors' missing torque, or force; else it is an acceleration."""
    return signal.startswith("missing_torque")


class Sizes:
    """Of one signal, a block of `length` [s] after the other: its size (root mean square), what is usual, whether it is more than that."""

    def __init__(self, floor, length):
        self.floor, self.length, self.sizes, self.square, self.count, self.block = floor, length, collections.deque(maxlen=600), 0.0, 0, None
        self.newest, self.is_open = math.nan, False

    @property
    def usual(self):
        """The median of the blocks that were not called unusual."""
        return float(np.median(self.sizes)) if len(self.sizes) >= FEWEST_BLOCKS else math.nan

    def usual_from(self, now):
        """[s] from when on something is called usual, where from now on values come all the time."""
        return (max(self.block, math.floor(now / self.length)) + FEWEST_BLOCKS - len(self.sizes)) * self.length

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
        """`nominal`: a Nominal; `minute` keeps the newest events, for a diagnosis."""
        self.source, self.nominal, self.minute = source, nominal, minute
        self.sizes, self.since, self.problem, self.remark = {}, None, "", ""
        self.stood, self.moved = None, None  # MOTION's fields as the run began; (time [s], what the machine does) from when on it is not compared
        self.block = math.nan  # [s] the machine's characteristic time, which the observer says first
        self.run = None  # of the source, that is heard
        self.beginning, self.waiting = None, []  # another observer, and what it will be told

    async def start(self):
        """Hears nothing before the observer is there: a source that goes on meanwhile is not to be polled."""
        await self._start_observer()
        self.source.incoming.taps.append(self.feed)

    async def _start_observer(self):
        self.process = await asyncio.create_subprocess_exec(
            messages_folder() / "slewlab-live-observer", self.nominal.path, stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE, limit=1 << 24, start_new_session=True)
        self.listening = asyncio.create_task(self._listen(self.process))

    def feed(self, events):
        """Keeps the events and hands them on."""
        if self.source.incoming.run != self.run:
            events = self._begin_another(events)
        self.minute.take(events, self.source.store.last)
        self._look_for_motion(events)
        if self._is_beginning:
            self.waiting += events
        else:
            self._hand_on(events)

    def _look_for_motion(self, events):
        """The nominal machine slews and does nothing else: one whose rope, boom or place is no more that of its beginning is another."""
        for channel, data in events if self.moved is None else ():
            if channel != "MOTION":
                continue
            try:
                message = message_types().motion_t.decode(data)
            except (ValueError, struct.error):  # a bit turned over on its way
                continue
            if self.stood is None:
                shape = self.source.facts.get("geometry", {})
                self.stood = {field: shape.get(field, getattr(message, field)) for field in MOTIONS}
            does = [words for field, words in MOTIONS.items() if abs(getattr(message, field) - self.stood[field]) > MOVED]
            if does:
                self.moved = message.simulated_time / 1e9, " and ".join(does)
                self.since = None
                return

    def _hand_on(self, events):
        """An observer that cannot keep up is left behind and says so."""
        pipe = self.process.stdin
        if self.problem or pipe.is_closing():
            return
        if pipe.transport.get_write_buffer_size() > MOST_WAITING:
            self.problem = "the observer cannot keep up with the run"
            return
        pipe.write(b"".join(event_bytes(0, 0.0, channel, data) for channel, data in events if channel in USED))

    def _begin_another(self, events):
        """Another run: what is usual, and what is diagnosed, is its own. Its events, without the last ones of the run before."""
        is_first, self.run = self.run is None, self.source.incoming.run
        self.minute.clear()
        if is_first:
            return events
        self.sizes, self.since, self.problem, self.remark, self.waiting = {}, None, "", "", []
        self.stood, self.moved = None, None
        if not self._is_beginning:
            self.beginning = asyncio.create_task(self._replace_observer())
        return self.source.incoming.of_this_run(events)

    @property
    def _is_beginning(self):
        return self.beginning is not None and not self.beginning.done()

    async def _replace_observer(self):
        """An observer is of one run."""
        process, self.process = self.process, None
        process.stdin.close()
        if process.returncode is None:
            process.kill()
        await self.listening
        await self._start_observer()
        self._hand_on(self.waiting)
        self.waiting = []

    async def _listen(self, process):
        async for line in process.stdout:
            if process is not self.process:  # of a run before
                continue
            said = json.loads(line)
            if "characteristic_time" in said:
                self.block = said["characteristic_time"]
            elif "time" in said:
                self._take(said)
            elif "begins_again" in said:
                self._learn_anew(said["begins_again"])
        words = (await process.stderr.read()).decode(errors="replace").strip()
        if await process.wait() != 0 and process is self.process:
            self.problem = words or "the observer ended"

    def _learn_anew(self, why):
        """The load may swing where an observer that begins takes it to hang still: nothing from before says what is usual then."""
        self.remark = f"the observer began again, and what is usual is learned anew: {why}"
        self.sizes, self.since = {}, None

    def _take(self, said):
        time = np.array(said["time"])
        is_compared = time < (math.inf if self.moved is None else self.moved[0])
        if not is_compared.any():
            return
        time = time[is_compared]
        columns = {"missing_torque": np.array(said["missing_torque"], float).T[is_compared]}
        for place, values in said["acceleration_difference"].items():
            columns[f"{place}_difference"] = np.array(values, float)[is_compared]
        self.source.store.append(CHANNEL, time, columns)
        nominal = self.nominal
        for group, values in enumerate(columns["missing_torque"].T):
            self._size(f"missing_torque.{group}", f"missing {nominal.effort} of group {group + 1}", nominal.unit, FLOOR_SHARE * nominal.rated, time, values)
        for place in said["acceleration_difference"]:
            self._size(f"{place}_difference", f"acceleration at the {place}", "m/s²", FLOOR_ACCELERATION, time, columns[f"{place}_difference"])
        is_open = any(sizes.is_open for _, _, sizes in self.sizes.values())
        self.since = (self.since if self.since is not None else float(time[-1])) if is_open else None

    def _size(self, signal, label, unit, floor, time, values):
        if signal not in self.sizes:
            self.sizes[signal] = label, unit, Sizes(floor, self.block)
        self.sizes[signal][2].add(time, values)

    def state(self):
        def known(value):
            return value if math.isfinite(value) else None

        if self.moved is not None and not self.problem:
            since, does = self.moved
            return {"problem": f"the machine {does}, and so moves otherwise than by slewing: from {since:.1f} s on it is not compared", "remark": "", "since": None,
                    "usual_from": None, "signals": []}
        now = self.source.store.last
        waited_for = [sizes.usual_from(now) for signal, (_, _, sizes) in self.sizes.items() if is_effort(signal) and not math.isfinite(sizes.usual)]
        return {"problem": self.problem, "remark": self.remark, "since": self.since, "usual_from": max(waited_for, default=None),
                "signals": [{"signal": f"{CHANNEL}.{signal}", "label": label, "unit": unit, "is_effort": is_effort(signal), "size": known(sizes.newest),
                             "usual": known(sizes.usual), "open": sizes.is_open} for signal, (label, unit, sizes) in self.sizes.items()]}

    async def end(self):
        if self._is_beginning:
            await self.beginning
        self.process.stdin.close()
        try:
            await asyncio.wait_for(asyncio.shield(self.listening), 5.0)
        except TimeoutError:
            self.process.kill()
            await self.listening
