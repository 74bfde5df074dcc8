from __future__ import annotations

import functools
import warnings
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _log
from .control import Margins, StateSpace, bode_table, margins
from .files import Changes, check, pairs, path_of
from .installed import installed_module
from .machine import Machine
from .program import call, program
from .tables import Channels, Log, open_log

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

CHANNELS = ("ENCODER", "TORQUE", "OPERATOR", "SENSORS", "TRUTH", "CONTROLLER_STATE", "PLANT_STATUS", "MOTION")


class Computes(Protocol):
    """Asked once a controller period. Answers with the motor torque [N m] of each group, or an Answer."""

    def __call__(self, encoder: _core.Encoder, operator: _core.Operator, /) -> Sequence[float] | NDArray[np.floating] | _core.Answer: ...


# A function, an object that can be called, or a class of such objects, of which one is made at every start of the controller.
Controller = Computes | type[Computes]


class Run(Channels):
    """A run's messages, channel by channel."""

    def __init__(self, scenario: "Scenario", tables: dict[str, Any]) -> None:
        super().__init__()
        self.scenario = scenario
        self._messages = {channel: rows.view(np.dtype(layout)) for channel, (layout, rows) in tables.items()}

    @property
    def channels(self) -> list[str]:
        return list(self._messages)

    @functools.cached_property
    def units(self) -> dict[str, dict[str, str]]:
        machine = self.scenario.machine
        return installed_module("signals").units_of({"machine": machine.facts()}) if machine.kind == "axis" else _log.signals()

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

        `controller`: a callable in place of the scenario's own controller, or a class of such. A fault that restarts the controller
        makes the class anew, and calls the same callable on. `channels`: whose messages are kept. `log`: a log to write, as `slewlab run` writes it.
        """
        if isinstance(channels, str):
            raise TypeError(f"found {channels!r} for channels, expected a list of names: [{channels!r}]")
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
        if not (controller is None or isinstance(controller, str)):
            raise TypeError(f"found {controller!r} for a controller, expected a shell command; a callable goes with run()")
        words = [program(), "run", str(self.path), "--out", str(out), "--progress", "none"]
        words += ["--controller", controller] if controller else []
        words += ["--realtime"] if realtime else []
        for key, value in pairs(self.changes):
            words += ["--set", f"{key}={value}"]
        call(words)
        return open_log(out)

    def speed_controller(self) -> StateSpace:
        """The scenario's PI speed control, from the error of the shaft speed [rad/s] to the torque per motor [N m], taken to be continuous.
        The filter on the measured speed is no part of it."""
        gain, time, _ = self._core.speed_loop
        return StateSpace(np.zeros((1, 1)), np.ones((1, 1)), np.full((1, 1), gain / time), np.full((1, 1), gain),
                          {"integral": "rad"}, {"speed_error": "rad/s"}, {"motor_torque": "N m"})

    @property
    def highest_frequency(self) -> float:
        """[Hz] Half the controller's rate, up to which a sampled loop has a response (Nyquist)."""
        return 0.5 / self.controller_period

    @property
    def loop_leaves_out(self) -> list[str]:
        """Effects of the machine that open_loop() has not: all that are no plain delay."""
        return self._core.loop_effects[2]

    def open_loop(self, frequencies: ArrayLike, controller: Callable[[np.ndarray], ArrayLike] | None = None) -> np.ndarray:
        """The speed loop cut at the torque: complex response over frequency [Hz], up to `highest_frequency`.

        It is the sampled loop as it runs: the machine with the torque held over a controller period and with its delays, the PI and the filter
        on the measured speed as the controller computes them. Motor groups act together; ramp, play compensation, limits and droop are left
        out, and so are the machine's other effects, with a warning that names them. `controller`: the transfer function of one's own, of
        z = exp(2j pi f period) to torque per motor [N m] over speed error [rad/s]: lambda z: 20.0.
        """
        _warn_of(self.loop_leaves_out, "open_loop()")
        frequencies = np.atleast_1d(np.asarray(frequencies, float))
        plant = self.machine.state_space().part("shaft_speed_1").sampled_response(frequencies, self.controller_period, self._core.loop_effects[0])
        z = np.exp(2j * np.pi * frequencies * self.controller_period)
        return plant[:, 0, 0] * np.asarray((controller or self._computed)(z))

    def _computed(self, z: np.ndarray) -> np.ndarray:
        """What the scenario's controller makes of a speed error: the integral by the trapezoidal rule (controller/speed_control.h), the filter
        exact for a speed held over the period (controller/speed_filter.h)."""
        gain, integral_time, filter_time = self._core.speed_loop
        period = self.controller_period
        kept = np.exp(-period / filter_time) if filter_time > 0.0 else 0.0
        return gain * (1.0 + 0.5 * period / integral_time * (z + 1.0) / (z - 1.0)) * (1.0 - kept) * z / (z - kept)

    def margins(self) -> Margins:
        """Of open_loop(), over all frequencies that it has."""
        frequencies = np.geomspace(1e-3 * self.highest_frequency, self.highest_frequency, 4000)
        return margins(frequencies, self.open_loop(frequencies))

    def closed_loop(self, output: str = "shaft_speed_1") -> StateSpace:
        """From the wanted shaft speed [rad/s] to an output, the controller with its filter taken to be continuous. The machine's effects are
        left out, with a warning that names them."""
        _warn_of(self._core.loop_effects[1] + self.loop_leaves_out, "closed_loop()")
        plant, control = self.machine.state_space().part(output), self.speed_controller()
        speed = self.machine.state_space().part("shaft_speed_1")
        n = len(plant.a)
        gain, integral = control.d[0, 0], control.c[0, 0]
        filter_time = self._core.speed_loop[2]
        is_filtered = filter_time > 0.0
        seen = np.hstack([np.zeros((1, n + 1)), np.ones((1, 1))]) if is_filtered else np.hstack([speed.c, np.zeros((1, 1))])
        m = seen.shape[1]
        integrated = np.zeros((1, m))
        integrated[0, n] = integral
        torque = integrated - gain * seen  # of the state; the request adds gain times itself
        a = np.zeros((m, m))
        a[:n, :n] = plant.a
        a[:n] += plant.b @ torque
        a[n] = -seen
        states = plant.states | control.states
        b = np.vstack([gain * plant.b, np.ones((1, 1)), np.zeros((m - n - 1, 1))])
        if is_filtered:
            a[n + 1, :n], a[n + 1, n + 1] = speed.c[0] / filter_time, -1.0 / filter_time
            states = states | {"filtered_speed": "rad/s"}
        c = np.hstack([plant.c, np.zeros((1, m - n))]) + plant.d @ torque
        return StateSpace(a, b, c, gain * plant.d, states, {"shaft_speed_request": "rad/s"}, plant.outputs)

    def bode(self, frequencies: ArrayLike) -> pd.DataFrame:
        """The open speed loop's magnitude [dB] and phase [deg]."""
        return bode_table(frequencies, self.open_loop(frequencies))

    def __repr__(self) -> str:
        return f"<Scenario {self.path}{' with ' + str(self.changes) if self.changes else ''}>"


def _warn_of(effects: list[str], what: str) -> None:
    if effects:
        warnings.warn(f"{what} leaves out what the machine's effects do to it: {', '.join(effects)}", stacklevel=3)
