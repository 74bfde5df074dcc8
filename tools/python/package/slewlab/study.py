"""A study file (docs/campaign.md) and the runs that it asks for."""

import itertools
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import _core
from .files import pairs

DIGITS = 6  # of a drawn value: its text is the value, and a command with it can be read


@dataclass(frozen=True)
class Varied:
    """A key that varies. `values`: the choices; lowest and highest; mean and standard deviation."""

    key: str
    spread: str  # values, range, log_range or normal
    values: tuple[str, ...]
    unit: str
    whole: bool

    def text(self, value: str) -> str:
        """As `--set` takes it."""
        return value if self.unit == "-" else f"{value} {self.unit}"

    def at(self, share: float) -> str:
        """The value below which this share of all draws lies."""
        if self.spread == "values":
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        first, second = map(float, self.values)
        if self.spread == "range":
            value = first + share * (second - first)
        elif self.spread == "log_range":
            value = first * (second / first) ** share
        else:
            from scipy.special import ndtri  # of the standard normal distribution

            value = first + second * float(ndtri(share))
        if self.whole:
            return str(round(value))
        return repr(float(f"{value:.{DIGITS}g}"))


@dataclass(frozen=True)
class Case:
    """One run of a campaign."""

    run: int
    scenario: str
    changes: tuple[tuple[str, str], ...]  # as `--set` takes them


@dataclass(frozen=True)
class Soak:
    """Tasks of a soak in place of runs of scenarios (docs/soak.md), from number 0 on."""

    settings: str
    crane: str
    controller: str
    faults: bool


@dataclass(frozen=True)
class Withheld:
    """Withheld cases in their place (docs/withheld.md), from number 1 on."""

    crane: str
    controller: str
    rate: float  # [Hz]
    sensors: str
    begin: str


@dataclass(frozen=True)
class Study:
    name: str
    scenarios: tuple[str, ...]
    limits: str | None
    draw: str  # grid, random or latin_hypercube
    runs: int  # of each scenario; 0 of a grid
    seed: int
    vary: tuple[Varied, ...]
    soak: Soak | None = None
    withheld: Withheld | None = None

    def draws(self) -> list[tuple[str, ...]]:
        """The values of every run of one scenario, in the order of `vary`."""
        if self.draw == "grid":
            return list(itertools.product(*(each.values for each in self.vary)))
        if self.draw == "random":
            # A run's values depend on seed and number alone: the first runs of a longer campaign are those of a shorter one.
            shares = np.array([np.random.default_rng([self.seed, run]).random(len(self.vary)) for run in range(self.runs)])
        else:
            from scipy.stats import qmc

            shares = qmc.LatinHypercube(len(self.vary), rng=np.random.default_rng(self.seed)).random(self.runs)
        # The ends of a normal distribution lie at infinity.
        shares = np.clip(shares, 1e-12, 1.0 - 1e-12)
        return [tuple(each.at(float(share)) for each, share in zip(self.vary, row)) for row in shares]

    def cases(self) -> list[Case]:
        """Run by run: the scenarios one after the other, each with the same draws. Of a soak the scenario is its settings' file, of
        withheld cases the nominal crane's: what is run is drawn of it by seed and number alone."""
        if self.soak or self.withheld:
            subject = self.soak.settings if self.soak else self.withheld.crane if self.withheld else ""
            return [Case(run, subject, ()) for run in range(self.runs)]
        draws = self.draws()
        return [Case(run, scenario, tuple((each.key, each.text(value)) for each, value in zip(self.vary, values)))
                for run, (scenario, values) in enumerate(itertools.product(self.scenarios, draws))]


def load_study(path: str | Path, changes: Mapping | None = None) -> Study:
    """InputError, a line per problem, where a file is wrong."""
    told = _core.load_study(Path(path), pairs(changes))

    def shown(file: Path) -> str:  # config/campaigns/../scenarios/x.yaml is config/scenarios/x.yaml
        return os.path.normpath(file)

    def files(part: Mapping) -> dict:
        return {key: shown(value) if isinstance(value, Path) else value for key, value in part.items()}

    vary = tuple(Varied(each["key"], each["spread"], tuple(each["values"]), each["unit"], each["whole"]) for each in told["vary"])
    return Study(Path(path).stem, tuple(map(shown, told["scenarios"])), shown(told["limits"]) if told["limits"] else None,
                 told["draw"], told["runs"], told["seed"], vary,
                 Soak(**files(told["soak"])) if told["soak"] else None, Withheld(**files(told["withheld"])) if told["withheld"] else None)
