"""Many runs of one scenario, side by side, as one table with a row per run."""

from __future__ import annotations

import itertools
import numbers
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from .engine import run_in_threads
from .scenario import CHANNELS, Controller, Run, Scenario
from .tables import Channels, factor, unit_text

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

Measure = Callable[[Run], Mapping[str, float] | float]

UNITS = {"peak_tip_acceleration": "m/s^2", "peak_house_acceleration": "m/s^2", "largest_sidelead": "rad",
         "largest_motor_torque": "N m", "play_crossings": "-", "end_angle": "rad"}


def measures(run: Channels) -> dict[str, float]:
    """What is asked of a run first: peaks of the accelerations, sidelead, motor torque, crossings of the play, where it ends.
    Of a run without a channel, what that one tells is left out, and the sidelead where no load swings."""
    found: dict[str, float] = {}
    if "SENSORS" in run:
        sensors = run.messages("SENSORS")
        found["peak_tip_acceleration"] = float(np.abs(sensors["tip_acceleration"]).max())
        found["peak_house_acceleration"] = float(np.abs(sensors["house_acceleration"]).max())
        found["end_angle"] = float(sensors["slew_angle"][-1])
    if "TRUTH" in run:
        truth = run.messages("TRUTH")
        sidelead = float(np.abs(truth["rope_angle"]).max())
        if sidelead > 0.0:  # a machine without a load says 0 throughout
            found["largest_sidelead"] = sidelead
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
    is_number = np.ndim(found) == 0 and isinstance(found, (numbers.Number, np.generic))
    if is_number:
        name = getattr(measure, "__name__", "")
        return {name if name.isidentifier() else "measured": found}
    raise TypeError(f"measure: found {found!r} for a run, expected a number, or numbers by name: {{'peak': 1.2}}")


def quantity(text: Any) -> tuple[float, str]:
    """Number and unit of a text as files have them; ValueError where it is none."""
    parts = _core.number_and_unit(text.strip()) if isinstance(text, str) else None
    if parts is None:
        raise ValueError(f"found {text!r}, expected a number with its unit")
    number, unit = parts
    if unit:
        _core.spellings(unit)  # refuses what is no unit, as the end of a file's name
    return number, unit_text(unit)


def as_numbers(values: Sequence[Any]) -> tuple[Sequence[Any], str]:
    """Texts of a number with a unit as numbers in the first one's unit, and that unit; what is anything else stays as it is, without one."""
    try:
        found = [quantity(value) for value in values]
        common = found[0][1]
        return [number if unit == common else number * factor(unit, common) for number, unit in found], common
    except ValueError:
        return values, ""


def table_of(cases: Sequence[Mapping[str, Any]], rows: Sequence[Mapping[str, float]]) -> pd.DataFrame:
    """A row per run: what was set, as numbers, then what was measured."""
    import pandas as pd

    columns: dict[str, Sequence[Any]] = {}
    units = dict(UNITS)
    for key in cases[0] if cases else ():
        columns[key], units[key] = as_numbers([case[key] for case in cases])
    table = pd.DataFrame(columns, index=pd.RangeIndex(len(cases))).join(pd.DataFrame(list(rows)))
    table.index.name = "run"
    table.attrs["units"] = {name: units[name] for name in table if units.get(name)}
    return table


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
    return table_of(cases, [found[number] for number in range(len(cases))])


def values_of(key: str, given: Any) -> list[Any]:
    """A text or a number is one value."""
    values = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    if not values:
        raise ValueError(f"{key}: found no value, expected at least one")
    return values


def sweep(scenario: Scenario, over: Mapping[str, Sequence[Any] | Any], *, measure: Measure = measures, channels: Iterable[str] = CHANNELS,
          controller: Callable[[], Controller] | None = None, threads: int | None = None, progress: bool | None = None) -> pd.DataFrame:
    """Every combination of the values: {"crane.boom.angle": ["40 deg", "60 deg"], "crane.load.mass": "10 t"}; a text is one value.

    A row per run, in the order of the values, the last key's first: what was set, as numbers in the unit of a key's first value, then what
    `measure` finds: numbers by name, or one number, which is called as the function is. Units in attrs["units"]. `controller`
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
    if runs < 1:
        raise ValueError(f"runs: found {runs}, expected at least 1")
    cases = []
    for number in range(runs):
        random = np.random.default_rng([seed, number])
        cases.append({key: value(random) for key, value in draw.items()})
    return run_all(scenario, cases, measure, channels, controller, threads, progress)
