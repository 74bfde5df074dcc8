"""Many runs of one scenario, side by side, as one table with a row per run."""

from __future__ import annotations

import itertools
import numbers
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .engine import run_in_threads
from .scenario import CHANNELS, Controller, Run, Scenario
from .tables import Channels

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

Measure = Callable[[Run], Mapping[str, float] | float]

UNITS = {"peak_tip_acceleration": "m/s^2", "peak_house_acceleration": "m/s^2", "largest_sidelead": "rad",
         "largest_motor_torque": "N m", "play_crossings": "-", "end_angle": "rad"}


def measures(run: Channels) -> dict[str, float]:
    """What is asked of a run first: peaks of the accelerations, sidelead, motor torque, crossings of the play, where it ends.
    Of a run without a channel, what that one tells is left out."""
    found: dict[str, float] = {}
    if "SENSORS" in run:
        sensors = run.messages("SENSORS")
        found["peak_tip_acceleration"] = float(np.abs(sensors["tip_acceleration"]).max())
        found["peak_house_acceleration"] = float(np.abs(sensors["house_acceleration"]).max())
        found["end_angle"] = float(sensors["slew_angle"][-1])
    if "TRUTH" in run:
        truth = run.messages("TRUTH")
        found["largest_sidelead"] = float(np.abs(truth["rope_angle"]).max())
        found["play_crossings"] = float(truth["play_crossings"][-1].sum())
    if "TORQUE" in run:
        found["largest_motor_torque"] = float(np.abs(run.messages("TORQUE")["motor_torque"]).max())
    return found


class ProgressBar:
    """On standard error, where that is a terminal."""

    def __init__(self, total: int, wanted: bool | None) -> None:
        self.total, self.wanted = total, sys.stderr.isatty() if wanted is None else wanted

    def show(self, done: int) -> None:
        if not self.wanted:
            return
        filled = 40 * done // max(self.total, 1)
        sys.stderr.write(f"\r[{'#' * filled}{'.' * (40 - filled)}] {done} of {self.total} runs" + ("\n" if done == self.total else ""))
        sys.stderr.flush()


def row_of(measure: Callable, found: Any) -> Mapping[str, float]:
    """What was measured, by name. A number alone is called as its function is."""
    if isinstance(found, Mapping):
        return found
    if np.ndim(found) == 0 and isinstance(found, (numbers.Number, np.generic)):
        name = getattr(measure, "__name__", "")
        return {name if name.isidentifier() else "measured": found}
    raise TypeError(f"measure: found {found!r} for a run, expected a number, or numbers by name: {{'peak': 1.2}}")


def run_all(scenario: Scenario, cases: Sequence[Mapping[str, Any]], measure: Measure, channels: Iterable[str],
            controller: Callable[[], Controller] | None, threads: int | None, progress: bool | None) -> pd.DataFrame:
    bar = ProgressBar(len(cases), progress)
    channels = list(channels)

    def one(case: Mapping[str, Any]) -> Mapping[str, float]:
        return row_of(measure, measure(scenario.changed(case).run(None if controller is None else controller(), channels=channels)))

    found: dict[int, Mapping[str, float]] = {}
    bar.show(0)
    for number, result in run_in_threads(one, cases, threads):
        found[number] = result
        bar.show(len(found))
    import pandas as pd

    table = pd.DataFrame([dict(case) | dict(found[number]) for number, case in enumerate(cases)])
    table.index.name = "run"
    table.attrs["units"] = {name: unit for name, unit in UNITS.items() if name in table}
    return table


def values_of(key: str, given: Any) -> list[Any]:
    """A text or a number is one value."""
    values = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    if not values:
        raise ValueError(f"{key}: found no value, expected at least one")
    return values


def sweep(scenario: Scenario, over: Mapping[str, Sequence[Any] | Any], *, measure: Measure = measures, channels: Iterable[str] = CHANNELS,
          controller: Callable[[], Controller] | None = None, threads: int | None = None, progress: bool | None = None) -> pd.DataFrame:
    """Every combination of the values: {"crane.boom.angle": ["40 deg", "60 deg"], "crane.load.mass": "10 t"}; a text is one value.

    A row per run, in the order of the values, the last key's first: what was set, then what `measure` finds: numbers by name, or one number,
    which is called as the function is. `controller`
    makes a callable for each run. `channels`: fewer make it faster. `threads`: as many as there are processors. The rows do
    not depend on it.
    """
    columns = [values_of(key, given) for key, given in over.items()]
    cases = [dict(zip(over, values, strict=True)) for values in itertools.product(*columns)]
    return run_all(scenario, cases, measure, channels, controller, threads, progress)


def monte_carlo(scenario: Scenario, draw: Mapping[str, Callable[[np.random.Generator], Any]], runs: int, *, seed: int,
                measure: Measure = measures, channels: Iterable[str] = CHANNELS,
                controller: Callable[[], Controller] | None = None, threads: int | None = None,
                progress: bool | None = None) -> pd.DataFrame:
    """`runs` runs with values drawn anew: {"crane.load.mass": lambda random: f"{random.uniform(10, 40)} t"}. The same seed
    draws the same values, and the first runs of a longer table are those of a shorter one."""
    for key, value in draw.items():
        if not callable(value):
            raise TypeError(f"{key}: found {value!r}, expected a function of a random generator; what is the same for all runs is the scenario's own")
    cases = []
    for number in range(runs):
        random = np.random.default_rng([seed, number])
        cases.append({key: value(random) for key, value in draw.items()})
    return run_all(scenario, cases, measure, channels, controller, threads, progress)
