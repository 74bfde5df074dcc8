"""`slewlab diagnose` with its answer as objects."""

import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .scenario import call, program


@dataclass(frozen=True)
class Size:
    """A fitted parameter of an effect with its 90 % interval."""

    parameter: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Cause:
    """Effects that together explain the gap."""

    effects: tuple[str, ...]
    probability: float
    sizes: tuple[Size, ...]
    cannot_be_told_from: tuple[str, ...]
    validated: bool | None  # whether it predicts data that were not fitted better than parameters alone; None: not tested


@dataclass(frozen=True)
class Diagnosis:
    """Where measured records differ from the nominal machine, and what causes it."""

    answer: str  # in one sentence
    gap: bool
    causes: tuple[Cause, ...]
    subsystems: dict[str, float]  # probabilities
    probability_nothing_missing: float
    probability_unknown: float
    remarks: tuple[str, ...]
    folder: Path | None  # with the page, the machine's file with the effect, and all numbers
    raw: dict[str, Any] = field(repr=False)  # diagnosis.json


def _cause(told: dict[str, Any]) -> Cause:
    sizes = tuple(Size(one["parameter"], one["value"], one["low_90"], one["high_90"], one["unit"]) for one in told["sizes"])
    return Cause(tuple(told["effects"]), told["probability"], sizes, tuple(one["cause"] for one in told["cannot_be_told_from"]),
                 told["validation"]["holds"] if "validation" in told else None)


def read_diagnosis(folder: str | Path) -> Diagnosis:
    """What `slewlab diagnose --out FOLDER` left there."""
    folder = Path(folder)
    raw = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    return Diagnosis(raw["answer"], raw["gap"], tuple(map(_cause, raw["causes"])), raw.get("subsystems") or {},
                     raw["probability_nothing_missing"], raw["probability_unknown"], tuple(raw["remarks"]), folder, raw)


def diagnose(machine: str | Path, logs: Sequence[str | Path], *, controller: str | Path | None = None, out: str | Path | None = None,
             threads: int = 2) -> Diagnosis:
    """Diagnoses measured logs of a crane against its file, as `slewlab diagnose` does. Without `out` the files go with the
    temporary folder they were made in. ProgramFailed, with what was said, where the records are refused."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(out) if out is not None else Path(temporary) / "findings"
        words = [program(), "diagnose", "--crane", str(machine), "--out", str(folder), "--threads", str(threads)]
        words += ["--controller", str(controller)] if controller is not None else []
        for log in logs:
            words += ["--log", str(log)]
        call(words)
        found = read_diagnosis(folder)
        return found if out is not None else Diagnosis(**{**vars(found), "folder": None})
