"""A run that pages steer: `slewlab run --steered` as a process of its own, told by lines what the operator does
(sim/drive/steering.h), and the scenario that does the same again to the bit."""

import asyncio
import contextlib
import sys
import time
from pathlib import Path

from run_log import slewlab_program
from unit import factor_to_si
from whole_file import growing, next_folder
from yaml_tree import file_text, flow, read_yaml
from desk.source import Growing, motor_groups

SLOWEST, FASTEST = 0.01, 1000.0  # of the speeds that a page may ask for; 0 is as fast as it goes
END_PATIENCE = 20.0  # [s] of wall clock for a run to put its log in order
LAST_WORDS = 12
PROCESSES = ": plant is process "  # in the line by which slewlab run begins: no last word
BEGIN_LOOK = 0.02  # [s] between two looks whether a run has begun
MOTIONS = ("hoisting", "luffing", "travelling")  # beside slewing: with these the scenario's operator goes on
REPEAT = 0.1  # [s] after which it is said again where the lever stands: of a desk that stands still the plant lets go


def chosen(value, unit=None):
    """A value as a scenario has it."""
    given = {"value": value} | ({"unit": unit} if unit else {})
    return given | {"source": "chosen: at the desk"}


def fault_choices(group_count):
    """{name: (label, keys of a scenario's fault)}: what a page may switch while the run goes on."""
    def message(kind, channel, **more):
        return {"fault": chosen(kind), "channel": chosen(channel), "probability": chosen(1, "-")} | more

    def of_group(kind, group, **more):
        return {"fault": chosen(kind), "group": chosen(group, "-")} | more

    choices = {
        "power": ("main power lost", {"fault": chosen("main_power_lost")}),
        "silence": ("all TORQUE lost", message("message_lost", "TORQUE")),
        "some_torque": ("every fifth TORQUE lost", message("message_lost", "TORQUE") | {"probability": chosen(0.2, "-")}),
        "some_encoder": ("every fifth ENCODER lost", message("message_lost", "ENCODER") | {"probability": chosen(0.2, "-")}),
        "late": ("TORQUE late by two cycles", message("message_delayed", "TORQUE", cycles=chosen(2, "-"))),
        "garbage": ("TORQUE garbled", message("message_corrupted", "TORQUE", corruption=chosen("garbage"))),
        "controller": ("controller stopped", {"fault": chosen("controller_stopped")}),
    }
    for group in range(group_count):
        choices[f"group_{group}"] = (f"motor group {group + 1} lost", of_group("motor_group_lost", group))
        choices[f"frozen_{group}"] = (f"encoder {group + 1} frozen", of_group("encoder_frozen", group))
        choices[f"dropped_{group}"] = (f"encoder {group + 1} without signal", of_group("encoder_dropped", group))
    return choices


def motion_requests(operator):
    """{motion: [(time [ns], request as the scenario has it)]} of a scenario's operator, whose emergency stop ends each of them
    (sim/drive/scenario_file.cpp)."""
    requests, is_stopped = {motion: [] for motion in MOTIONS}, False
    for move in operator:
        at = round(move["time"]["value"] * factor_to_si("time", move["time"]["unit"]) * 1e9)
        is_stopped = move["emergency_stop"]["value"] if "emergency_stop" in move else is_stopped
        for motion, mine in requests.items():
            request = move.get(f"{motion}_request")
            if is_stopped:
                request = {"value": 0, "unit": "-", "source": "chosen: ended by the scenario's emergency stop"} if mine and is_asked(mine[-1][1]) else None
            if request is not None:
                mine.append((at, request))
    return requests


def is_asked(request):
    return request["value"] != 0


def moves_under_a_stop(requests, moves, until):
    """Names of the motions that are asked for, until a time [ns], while an emergency stop of the desk is pressed. In the run they go on; in
    a scenario the stop would end them. `moves`: (time [ns], whether the emergency stop is pressed) where that may change."""
    found = set()
    for (begin, is_pressed), (end, _) in zip(moves, [*moves[1:], (until, False)]):
        for motion, mine in requests.items() if is_pressed else ():
            standing = [request for at, request in mine if at <= begin][-1:]
            if any(map(is_asked, [*standing, *(request for at, request in mine if begin < at < end)])):
                found.add(motion)
    return sorted(found)


def write_yaml(path, keys):
    with growing(path) as partial:
        partial.write_text(file_text(keys), encoding="utf-8")
    return path


class SteeredRun:
    def __init__(self, scenario, out, duration, options=(), realtime=False):
        self.scenario, self.out, self.duration, self.realtime = Path(scenario), Path(out), duration, realtime
        self.options = [*options, *(["--realtime"] if realtime else [])]
        self.process = None

    async def start(self, play_compensation=None):
        """The source of its signals. `play_compensation`: other than the controller's file has it, for this run."""
        switched = [] if play_compensation is None else ["--set", f"controller.play_compensation.enabled={str(play_compensation).lower()}"]
        self.folder = next_folder(self.out)
        self.folder.mkdir(parents=True)
        self.paused, self.speed, self.ended, self.why = False, 1.0, False, ""
        self.told, self.faults, self.effects, self.compensation, self.words = None, [], [], [], []
        self.process = await asyncio.create_subprocess_exec(
            slewlab_program(), "run", self.scenario, "--steered", "--out", self.folder, "--progress", "none",
            "--set", f"duration={self.duration:.9g}", *self.options, *switched, stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT, start_new_session=True)
        self.listening = asyncio.create_task(self._listen())
        self.source = Growing(self.folder / "run.lcmlog", f"{self.scenario.stem}, {self.folder.name}")
        return self.source

    @property
    def has_begun(self):
        """Whether its files were in order: slewlab run then writes what the run is, before anything moves."""
        return (self.folder / "run.json").exists()

    async def begins(self):
        """Waits until the run has begun, or has ended without that; which of the two."""
        while not self.ended and not self.has_begun:
            await asyncio.sleep(BEGIN_LOOK)
        return self.has_begun

    async def _listen(self):
        async for line in self.process.stdout:
            words = line.decode(errors="replace").rstrip()
            if words.startswith("steering fault "):
                _, _, name, which, time = words.split()
                self._fault_switched(name, which, float(time))
            elif words.startswith("steering effect "):
                _, _, name, what, time = words.split()
                self.effects.append({"name": name, "on": what == "on", "time": float(time)})
            elif words.startswith("steering play_compensation "):
                _, _, what, time = words.split()
                self.compensation.append({"on": what == "on", "time": float(time)})
            elif words.startswith("steering refused "):
                self.why = words.removeprefix("steering refused ")
            else:
                self.words = [*self.words, words][-LAST_WORDS:]
        await self.process.wait()
        self.ended = True
        if self.process.returncode != 0:
            self.why = "the run ended: " + " · ".join(words for words in self.words if PROCESSES not in words)
            if self.has_begun:
                print(f"slewlab desk: {self.why}", file=sys.stderr)

    def _fault_switched(self, name, which, time):
        if which == "from":
            self.faults.append({"name": name, "from": time, "until": None})
            return
        for fault in self.faults:
            if fault["name"] == name and fault["until"] is None:
                fault["until"] = time

    def _say(self, line):
        if not self.ended and self.process.stdin is not None:
            with contextlib.suppress(ConnectionError, RuntimeError):  # it has just ended
                self.process.stdin.write(line.encode() + b"\n")

    def operate(self, joystick):
        """Tells the run where lever and buttons stand."""
        stands, now = (joystick.request, joystick.stop, joystick.acknowledge), time.monotonic()
        if self.told is None:
            self._say(f"patience {2 * joystick.patience!r}")  # longer than the desk's own, which says why
        if stands != self.told or now - self.told_at > REPEAT:
            self.told, self.told_at = stands, now
            self._say(f"operator {stands[0]!r} {stands[1]:d} {stands[2]:d}")

    @property
    def groups(self):
        """How many motor groups the machine has; 0 where run.json is not there yet."""
        return motor_groups(self.source.facts)

    @property
    def choices(self):
        return fault_choices(self.groups)

    def state(self):
        on = {fault["name"] for fault in self.faults if fault["until"] is None}
        return {"paused": self.paused, "speed": self.speed, "ended": self.ended, "why": self.why, "lockstep": not self.realtime,
                "folder": str(self.folder), "play_compensation": self._compensates(), "is_switchable": self.is_switchable,
                "effects": [{"name": name, "label": name.replace("_", " "), "on": self._acts(name)}
                            for name in self.source.facts.get("switchable_effects", [])],
                "faults": [{"name": name, "label": label, "on": name in on} for name, (label, _) in self.choices.items()]}

    @property
    def is_switchable(self):
        """Whether the play compensation can be switched: another controller than slewlab's own cannot be told."""
        return self.source.facts.get("controller_command") == "slewlab-controller"

    def _compensates(self):
        """Whether the play compensation acts; None where the controller has none, or one motor group alone, which nothing holds against."""
        return None if self.groups == 1 else next((each["on"] for each in reversed(self.compensation)), self.source.facts.get("play_compensation"))

    def _acts(self, name):
        """Whether an effect is on: as it was switched last, from the beginning on as the scenario has it."""
        return next((each["on"] for each in reversed(self.effects) if each["name"] == name), True)

    async def command(self, kind, request):
        """What a page asks for besides lever and buttons; what to tell it."""
        if kind in ("pause", "resume", "cycle", "speed") and self.realtime:
            return {"type": "refused", "why": "a run against the wall clock keeps its own time"}
        if kind == "pause":
            self.paused = True
            self._say("pause")
        elif kind == "resume":
            self.paused = False
            self._say("resume")
        elif kind == "cycle":
            self._say("cycle")
        elif kind == "speed":
            speed = float(request["speed"])
            if speed != 0.0 and not SLOWEST <= speed <= FASTEST:
                raise ValueError(f"a speed of {speed:g}: 0 or {SLOWEST:g} to {FASTEST:g} is wanted")
            self.speed = speed
            self._say(f"speed {speed!r}")
        elif kind == "fault":
            name = request["name"]
            if name not in self.choices:
                raise ValueError("there is no such fault")
            self._say(f"fault begin {name} {flow(self.choices[name][1])[1:-1]}" if request["on"] else f"fault end {name}")
        elif kind == "effect":
            if request["name"] not in self.source.facts.get("switchable_effects", []):
                raise ValueError("there is no such effect")
            self._say(f"effect {request['name']} {'on' if request['on'] else 'off'}")
        elif kind == "play_compensation":
            if not self.is_switchable:
                raise ValueError("only slewlab's own controller can be told to switch its play compensation")
            self._say(f"play_compensation {'on' if request['on'] else 'off'}")
        elif kind == "save":
            why = self.unrepeatable()
            return {"type": "refused", "why": why} if why else {"type": "told", "text": f"written: {self.save()}"}
        else:
            raise ValueError(f"'{kind}' is nothing that a run does")
        return None

    def unrepeatable(self):
        """Why no scenario does what was done up to now; nothing where one does."""
        requests = motion_requests(read_yaml(self.folder / "scenario.yaml").get("operator") or [])
        under_a_stop = moves_under_a_stop(requests, [(at, stop) for at, _, stop, _ in self.source.incoming.moves], self.source.store.last * 1e9)
        return under_a_stop and (f"no scenario does the same: the machine went on {' and '.join(under_a_stop)} while the emergency stop of the desk was "
                                 "pressed, and a scenario's emergency stop ends that")

    def save(self):
        """Writes the scenario that does the same from the start up to now; its path."""
        resolved = read_yaml(self.folder / "scenario.yaml")
        period = self.source.facts["controller_period"]
        moves = {at: {"speed_request": chosen(request, "-"), "emergency_stop": chosen(stop), "acknowledge": chosen(acknowledge)}
                 for at, request, stop, acknowledge in self.source.incoming.moves}
        for motion, requests in motion_requests(resolved.get("operator") or []).items():
            for at, request in requests:
                moves.setdefault(at, {})[f"{motion}_request"] = request
        moves = [{"time": chosen(round(at * 1e-9, 9), "s")} | moves[at] for at in sorted(moves)]
        faults = list(resolved.get("faults") or [])
        for fault in self.faults:
            entry = dict(self.choices[fault["name"]][1]) | {"from": chosen(fault["from"], "s")}
            faults.append(entry | ({"until": chosen(fault["until"], "s")} if fault["until"] is not None else {}))
        switches = list(resolved.get("effect_switches") or []) + [
            {"time": chosen(each["time"], "s"), "effect": each["name"], "on": chosen(each["on"])} for each in self.effects]
        switches.sort(key=lambda each: float(each["time"]["value"]))
        scenario = {"include": "scenario.yaml", "description": "What the operator did at the desk.",
                    "duration": chosen(round(max(1, round(self.source.store.last / period)) * period, 9), "s"), "operator": moves,
                    "faults": faults or None, "effect_switches": switches or None, "expect": None}
        if self.compensation:
            scenario["controller"] = self._save_controller().name
        return write_yaml(self.folder / "steered.yaml", scenario)

    def _save_controller(self):
        """Writes the run's controller with what was switched; its path."""
        resolved = read_yaml(self.folder / "controller.yaml")
        switches = list(resolved["play_compensation"].get("switches") or []) + [
            {"time": chosen(each["time"], "s"), "enabled": chosen(each["on"])} for each in self.compensation]
        switches.sort(key=lambda each: float(each["time"]["value"]))
        return write_yaml(self.folder / "steered_controller.yaml",
                          {"include": "controller.yaml", "description": "With what the operator switched at the desk.",
                           "play_compensation": {"switches": switches}})

    async def end(self):
        """The run's end, with its log in order and its scenario written."""
        if self.process is None:
            return
        self._say("end")
        try:
            await asyncio.wait_for(asyncio.shield(self.listening), END_PATIENCE)
        except TimeoutError:
            self.process.terminate()
            await self.listening
        while self.source.poll():
            pass
        if self.source.incoming.moves:
            why = self.unrepeatable()
            if why:
                print(f"slewlab desk: {self.folder}: no steered.yaml up to its end: {why}", file=sys.stderr)
            else:
                self.save()
