"""The linear machine for control design: responses, speed loop, margins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd


@dataclass(frozen=True)
class StateSpace:
    """x' = a x + b u, y = c x + d u. `states`, `inputs` and `outputs` are {name: unit} in the order of the matrices."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    states: dict[str, str]
    inputs: dict[str, str]
    outputs: dict[str, str]

    def part(self, output: str, per_motor: bool = True) -> "StateSpace":
        """From the same torque on every motor [Nm] to one output."""
        if output not in self.outputs:
            raise ValueError(f"no output '{output}' here, expected {_core.known_names_text(output, list(self.outputs))}")
        row = list(self.outputs).index(output)
        both = np.ones((len(self.inputs), 1))
        unit = next(iter(self.inputs.values()))
        return StateSpace(self.a, self.b @ both, self.c[row:row + 1], self.d[row:row + 1] @ both, self.states,
                          {"motor_torque": unit}, {output: self.outputs[output]})

    def response(self, frequencies: np.ndarray) -> np.ndarray:
        """Complex response at each frequency [Hz], shape (frequencies, outputs, inputs)."""
        frequencies = usable(frequencies)
        iw = 2j * np.pi * np.atleast_1d(np.asarray(frequencies, float))
        dynamic = iw[:, None, None] * np.eye(len(self.a)) - self.a
        return self.c @ np.linalg.solve(dynamic, np.broadcast_to(self.b.astype(complex), (len(iw), *self.b.shape))) + self.d

    def bode(self, output: str, frequencies: np.ndarray) -> pd.DataFrame:
        """Magnitude [dB] and phase [deg] over frequency [Hz], the same torque on every motor."""
        response = self.part(output).response(frequencies)[:, 0, 0]
        return bode_table(frequencies, response)

    def step(self, output: str, times: np.ndarray, size: float = 1.0) -> pd.Series:
        """The output's answer to a step of `size` in its one input, or of the same torque on every motor."""
        system = self if len(self.inputs) == 1 and list(self.outputs) == [output] else self.part(output)
        times = np.asarray(times, float)
        grid = np.diff(times)
        if len(times) < 2 or times[0] != 0.0 or not np.allclose(grid, grid[0], rtol=1e-9, atol=0.0) or grid[0] <= 0.0:
            raise ValueError("times must be 0 and even multiples of one step")
        n = len(system.a)
        both = np.zeros((n + 1, n + 1))
        both[:n, :n], both[:n, n:] = system.a, system.b * size
        advance = exponential(both * grid[0])
        state, values = np.zeros(n + 1), []
        state[n] = 1.0
        for _ in times:
            values.append(float((system.c @ state[:n] + system.d[:, 0] * size)[0]))
            state = advance @ state
        import pandas as pd

        return pd.Series(values, index=pd.Index(times, name="time"), name=output)

    def to_control(self) -> Any:
        """The same as python-control's StateSpace, with names; needs that package."""
        import control

        return control.ss(self.a, self.b, self.c, self.d, states=list(self.states), inputs=list(self.inputs), outputs=list(self.outputs))


def usable(frequencies: np.ndarray) -> np.ndarray:
    """[Hz] as an array; ValueError where one is none."""
    found = np.atleast_1d(np.asarray(frequencies, float))
    wrong = found[~(np.isfinite(found) & (found >= 0.0))]
    if len(wrong):
        raise ValueError(f"found a frequency of {wrong[0]:g} Hz, expected finite numbers of at least 0")
    return found


def exponential(matrix: np.ndarray) -> np.ndarray:
    """e to the matrix: halved until it is small, its series, squared again."""
    halvings = max(0, int(np.ceil(np.log2(max(np.linalg.norm(matrix, 1), 1e-300)))) + 1)
    small = matrix / 2.0**halvings
    term, total = np.eye(len(matrix)), np.eye(len(matrix))
    for power in range(1, 20):  # of a norm below a half: the rest is below 1e-24
        term = term @ small / power
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def bode_table(frequencies: np.ndarray, response: np.ndarray) -> pd.DataFrame:
    import pandas as pd

    table = pd.DataFrame({"magnitude": 20.0 * np.log10(np.abs(response)), "phase": np.degrees(np.unwrap(np.angle(response)))},
                         index=pd.Index(np.asarray(frequencies, float), name="frequency"))
    table.attrs["units"] = {"magnitude": "dB", "phase": "deg", "frequency": "Hz"}
    return table


@dataclass(frozen=True)
class Margins:
    """Of an open loop; None where it never crosses."""

    gain: float | None            # [dB] by which the gain may grow
    gain_frequency: float | None  # [Hz] where the phase is -180 deg
    phase: float | None           # [deg] by which the phase may fall
    phase_frequency: float | None  # [Hz] where the gain is 1


def margins(frequencies: np.ndarray, response: np.ndarray) -> Margins:
    """The smallest margins of an open loop's response over frequency [Hz]; between the points it is taken to be straight in
    decibel and phase over the logarithm of the frequency."""
    if len(usable(frequencies)) != len(response):
        raise ValueError(f"found {len(response)} values at {len(frequencies)} frequencies, expected one at each")
    table = bode_table(frequencies, response)
    log_f, magnitude, phase = np.log(table.index.to_numpy()), table.magnitude.to_numpy(), table.phase.to_numpy()
    phases, gains = [], []
    for at in np.flatnonzero(np.diff(np.sign(magnitude)) != 0):
        share = magnitude[at] / (magnitude[at] - magnitude[at + 1])
        here = phase[at] + share * (phase[at + 1] - phase[at])
        distance = (here + 180.0 + 180.0) % 360.0 - 180.0
        phases.append((abs(distance), distance, np.exp(log_f[at] + share * (log_f[at + 1] - log_f[at]))))
    turns = np.floor((phase + 180.0) / 360.0)
    for at in np.flatnonzero(np.diff(turns) != 0):
        crossing = 360.0 * max(turns[at], turns[at + 1]) - 180.0
        share = (crossing - phase[at]) / (phase[at + 1] - phase[at])
        here = magnitude[at] + share * (magnitude[at + 1] - magnitude[at])
        gains.append((abs(here), -here, np.exp(log_f[at] + share * (log_f[at + 1] - log_f[at]))))
    _, gain, gain_at = min(gains, default=(None, None, None))
    _, phase_margin, phase_at = min(phases, default=(None, None, None))
    as_float = lambda value: None if value is None else float(value)  # noqa: E731
    return Margins(as_float(gain), as_float(gain_at), as_float(phase_margin), as_float(phase_at))
