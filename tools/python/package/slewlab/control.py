"""The linear machine for control design: responses, speed loop, margins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

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

    def part(self, output: str) -> "StateSpace":
        """From the same torque on every motor [N m] to one output."""
        if output not in self.outputs:
            raise ValueError(f"no output '{output}' here, expected {_core.known_names_text(output, list(self.outputs))}")
        row = list(self.outputs).index(output)
        both = np.ones((len(self.inputs), 1))
        unit = next(iter(self.inputs.values()))
        return StateSpace(self.a, self.b @ both, self.c[row:row + 1], self.d[row:row + 1] @ both, self.states,
                          {"motor_torque": unit}, {output: self.outputs[output]})

    def response(self, frequencies: ArrayLike) -> np.ndarray:
        """Complex response at each frequency [Hz], shape (frequencies, outputs, inputs)."""
        s = 2j * np.pi * usable(frequencies)
        return self.c @ _solved(s, self.a, self.b[None]) + self.d

    def sampled_response(self, frequencies: ArrayLike, period: float, delay: float = 0.0) -> np.ndarray:
        """As `response`, of the outputs read once a period [s], each input held over the period and arriving `delay` [s] late: exact, with what
        lies above half the sampling rate folded back."""
        z = np.exp(2j * np.pi * usable(frequencies, most=0.5 / period) * period)
        periods = int(np.floor(delay / period * (1.0 + 1e-12)))
        late = max(0.0, delay - periods * period)  # within a period: the older input acts that long, then the newer one
        advance, newer = held(self.a, self.b, period - late)
        old_advance, older = held(self.a, self.b, late)
        driven = newer + (advance @ older) / z[:, None, None]
        direct = self.d if late == 0.0 else self.d / z[:, None, None]
        return (self.c @ _solved(z, advance @ old_advance, driven) + direct) * z[:, None, None] ** -periods

    def bode(self, output: str, frequencies: ArrayLike) -> pd.DataFrame:
        """Magnitude [dB] and phase [deg] over frequency [Hz], the same torque on every motor."""
        response = self.part(output).response(frequencies)[:, 0, 0]
        return bode_table(frequencies, response)

    def step(self, output: str, times: ArrayLike, size: float = 1.0) -> pd.Series:
        """The output's answer to a step of `size` in its one input, or of the same torque on every motor; units in attrs["units"]."""
        system = self if len(self.inputs) == 1 and list(self.outputs) == [output] else self.part(output)
        times = np.asarray(times, float)
        grid = np.diff(times)
        if len(times) < 2 or times[0] != 0.0 or not np.allclose(grid, grid[0], rtol=1e-9, atol=0.0) or grid[0] <= 0.0:
            raise ValueError("times must be 0 and even multiples of one step")
        advance, driven = held(system.a, system.b, grid[0])
        state, values = np.zeros(len(system.a)), []
        for _ in times:
            values.append(float((system.c @ state + system.d[:, 0] * size)[0]))
            state = advance @ state + driven[:, 0] * size
        import pandas as pd

        series = pd.Series(values, index=pd.Index(times, name="time"), name=output)
        series.attrs["units"] = {output: system.outputs[output], "time": "s"}
        return series

    def to_control(self) -> Any:
        """The same as python-control's StateSpace, with names; needs that package."""
        import control

        return control.ss(self.a, self.b, self.c, self.d, states=list(self.states), inputs=list(self.inputs), outputs=list(self.outputs))


def usable(frequencies: ArrayLike, most: float = np.inf) -> np.ndarray:
    """[Hz] as an array; ValueError where one is none. At 0 a machine that turns freely has no finite response, and a logarithm no value."""
    found = np.atleast_1d(np.asarray(frequencies, float))
    wrong = found[~(np.isfinite(found) & (found > 0.0))]
    if len(wrong):
        raise ValueError(f"found a frequency of {wrong[0]:g} Hz, expected finite numbers above 0")
    if found.max(initial=0.0) > most * (1.0 + 1e-9):
        raise ValueError(f"found a frequency of {found.max():g} Hz, expected at most {most:g} Hz, half the controller's rate")
    return found


def _solved(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(p - a)^-1 b at every point p of the complex plane; b has one matrix for all points, or one for each."""
    dynamic = points[:, None, None] * np.eye(len(a)) - a
    return np.linalg.solve(dynamic, np.broadcast_to(b.astype(complex), (len(points), *b.shape[1:])))


def held(a: np.ndarray, b: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """x(time) = first x(0) + second u, u held meanwhile."""
    n, inputs = b.shape
    both = np.zeros((n + inputs, n + inputs))
    both[:n, :n], both[:n, n:] = a, b
    advance = exponential(both * time)
    return advance[:n, :n], advance[:n, n:]


def exponential(matrix: np.ndarray) -> np.ndarray:
    """e to the matrix: halved until it is small, its series, squared again."""
    halvings = max(0, int(np.ceil(np.log2(max(float(np.linalg.norm(matrix, 1)), 1e-300)))) + 1)
    small = matrix / 2.0**halvings
    term, total = np.eye(len(matrix)), np.eye(len(matrix))
    for power in range(1, 20):  # of a norm below a half: the rest is below 1e-24
        term = term @ small / power
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def bode_table(frequencies: ArrayLike, response: np.ndarray) -> pd.DataFrame:
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


def margins(frequencies: ArrayLike, response: ArrayLike) -> Margins:
    """The smallest margins of an open loop's response over frequency [Hz]; between the points it is taken to be straight in
    decibel and phase over the logarithm of the frequency. Frequencies should reach half the sampling rate, where a sampled loop is real and
    often has its gain margin; a point that is real and negative is a crossing of -180 deg."""
    used, values = usable(frequencies), np.atleast_1d(np.asarray(response, complex))
    if len(used) != len(values):
        raise ValueError(f"found {len(values)} values at {len(used)} frequencies, expected one at each")
    table = bode_table(used, values)
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
    for at in np.flatnonzero((values.real < 0.0) & (np.abs(values.imag) <= 1e-6 * np.abs(values))):
        gains.append((abs(magnitude[at]), -magnitude[at], used[at]))
    _, gain, gain_at = min(gains, default=(None, None, None))
    _, phase_margin, phase_at = min(phases, default=(None, None, None))
    as_float = lambda value: None if value is None else float(value)  # noqa: E731
    return Margins(as_float(gain), as_float(gain_at), as_float(phase_margin), as_float(phase_at))
