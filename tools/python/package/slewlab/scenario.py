from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import _core
from .control import StateSpace, bode_table
from .files import Changes, check, pairs, path_of
from .machine import Machine
from .program import call, program
from .tables import Channels, Log, open_log

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

CHANNELS = ("ENCODER", "TORQUE", "OPERATOR", "SENSORS", "TRUTH", "CONTROLLER_STATE", "PLANT_STATUS", "MOTION")

# Asked once a controller period. Answers with the motor torque [Nm] of each group, or an Answer.
Controller = Callable[[_core.Encoder, _core.Operator], Sequence[float] | _core.Answer]


class Run(Channels):
    """A run's messages, channel by channel."""

    def __init__(self, scenario: "Scenario", tables: dict) -> None:
        super().__init__()
        self.scenario = scenario
        self._messages = {channel: rows.view(np.dtype(layout)) for channel, (layout, rows) in tables.items()}

    @property
    def channels(self) -> list[str]:
        return list(self._messages)

    def messages(self, channel: str) -> np.ndarray:
        self.require(channel)
        return self._messages[channel]

    def __repr__(self) -> str:
        return f"<Run of {self.scenario.path.name}: {', '.join(self.channels)}>"


class Scenario:
    """Which machine, which controller, what the operator does. `changes` are laid over the files as `--set` does:
    {"duration": 20, "crane.load.mass": "60 t", "controller.ramp.curved_share": 0.2}."""

    def __init__(self, path: str | Path, changes: Changes | None = None) -> None:
        self.path, self.changes = path_of(path, "a scenario's file"), dict(changes or {})
        self._core = _core.Scenario(self.path, pairs(changes))

    def changed(self, changes: Changes) -> "Scenario":
        """The same scenario with more changes."""
        return Scenario(self.path, self.changes | dict(changes))

    def check(self) -> list[str]:
        """What is possible and yet unlikely of it and its machine. InputError where a run would refuse it."""
        return check(self.path, self.changes)

    @property
    def duration(self) -> float:
        """[s]"""
        return self._core.duration

    @property
    def plant_step(self) -> float:
        """[s]"""
        return self._core.plant_step

    @property
    def controller_period(self) -> float:
        """[s]"""
        return self._core.controller_period

    @property
    def seed(self) -> int:
        return self._core.seed

    @property
    def machine(self) -> Machine:
        key = self._core.machine_key + "."
        changes = {name[len(key):]: value for name, value in self.changes.items() if name.startswith(key)}
        return Machine(self._core.machine_file, changes)

    def run(self, controller: Controller | None = None, *, channels: Iterable[str] = CHANNELS, log: str | Path | None = None) -> Run:
        """Runs it in this process, in lockstep: the same messages, to the bit, as `slewlab run`.

        `controller`: a callable in place of the scenario's own controller. A fault that restarts the controller calls the
        same callable on. `channels`: whose messages are kept. `log`: a log to write, as `slewlab run` writes it.
        """
        kept = list(channels)
        for channel in kept:
            if channel not in CHANNELS:
                raise KeyError(f"no channel {channel}, expected {_core.known_names_text(channel, list(CHANNELS))}")
        if not (controller is None or callable(controller)):
            raise TypeError(f"found {controller!r} for a controller, expected a callable; a program of one's own goes with run_over_lcm()")
        return Run(self, self._core.run(controller, kept, "" if log is None else log))

    def run_over_lcm(self, out: str | Path, controller: str | None = None, *, realtime: bool = False) -> Log:
        """Runs it in two processes over LCM, into the folder `out`. `controller`: shell command of a program that answers
        on the bus ($SLEWLAB_BUS)."""
        words = [program(), "run", str(self.path), "--out", str(out), "--progress", "none"]
        words += ["--controller", controller] if controller else []
        words += ["--realtime"] if realtime else []
        for key, value in pairs(self.changes):
            words += ["--set", f"{key}={value}"]
        call(words)
        return open_log(out)

    def speed_controller(self) -> StateSpace:
        """The scenario's PI speed control, from the error of the shaft speed [rad/s] to the torque per motor [Nm]."""
        gain, time = self._core.speed_loop
        return StateSpace(np.zeros((1, 1)), np.ones((1, 1)), np.full((1, 1), gain / time), np.full((1, 1), gain),
                          {"integral": "rad"}, {"speed_error": "rad/s"}, {"motor_torque": "N m"})

    def open_loop(self, frequencies: np.ndarray) -> np.ndarray:
        """The speed loop cut at the torque: complex response over frequency [Hz], with what holding the torque over a
        controller period does to it. Motor groups act together; ramp, play compensation, limits and droop are left out."""
        frequencies = np.asarray(frequencies, float)
        plant = self.machine.state_space().part("shaft_speed_1").response(frequencies)[:, 0, 0]
        control = self.speed_controller().response(frequencies)[:, 0, 0]
        turn = 2j * np.pi * frequencies * self.controller_period
        return plant * control * (1.0 - np.exp(-turn)) / turn

    def closed_loop(self, output: str = "shaft_speed_1") -> StateSpace:
        """From the wanted shaft speed [rad/s] to an output, the controller taken to be continuous."""
        plant, control = self.machine.state_space().part(output), self.speed_controller()
        speed = self.machine.state_space().part("shaft_speed_1")
        n = len(plant.a)
        gain, integral = control.d[0, 0], control.c[0, 0]
        a = np.zeros((n + 1, n + 1))
        a[:n, :n] = plant.a - gain * plant.b @ speed.c
        a[:n, n:] = integral * plant.b
        a[n:, :n] = -speed.c
        b = np.vstack([gain * plant.b, np.ones((1, 1))])
        c = np.hstack([plant.c - gain * plant.d @ speed.c, integral * plant.d])
        return StateSpace(a, b, c, gain * plant.d, plant.states | control.states, {"shaft_speed_request": "rad/s"}, plant.outputs)

    def bode(self, frequencies: np.ndarray) -> pd.DataFrame:
        """The open speed loop's magnitude [dB] and phase [deg]."""
        return bode_table(frequencies, self.open_loop(frequencies))

    def __repr__(self) -> str:
        return f"<Scenario {self.path}{' with ' + str(self.changes) if self.changes else ''}>"
