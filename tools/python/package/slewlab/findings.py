"""`slewlab diagnose` with its answer as objects."""

import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .program import call, program


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
    """Effects that together explain the gap; of an axis, laws of its torque balance."""

    effects: tuple[str, ...]
    same_motion: tuple[tuple[str, ...], ...]  # effects that move the machine just as these do: one answer by another name
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
    probability_nothing_missing: float | None  # None of an axis
    probability_unknown: float
    remarks: tuple[str, ...]
    folder: Path | None  # with the page, the machine's file with the effect, and all numbers
    raw: dict[str, Any] = field(repr=False)  # diagnosis.json


def _cause(told: dict[str, Any]) -> Cause:
    alike = told.get("cannot_be_told_from", ())
    sizes = tuple(Size(one["parameter"], one["value"], one["low_90"], one["high_90"], one["unit"]) for one in told["sizes"])
    return Cause(tuple(told["effects" if "effects" in told else "laws"]), tuple(map(tuple, told.get("or", ()))), told["probability"], sizes, tuple(one["cause"] for one in alike),
                 told["validation"]["holds"] if "validation" in told else None)


def read_diagnosis(folder: str | Path) -> Diagnosis:
    """What `slewlab diagnose --out FOLDER` left there."""
    folder = Path(folder)
    raw = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    is_axis, causes = raw.get("kind") == "axis", list(map(_cause, raw["causes"]))
    if is_axis and causes:  # the first one alone is validated
        causes[0] = replace(causes[0], validated=raw["validation"]["holds"])
    # An axis's answer is its verdict; it has no subsystems to blame.
    return Diagnosis(raw["verdict" if is_axis else "answer"], raw["gap"], tuple(causes),
                     raw.get("subsystems") or {}, raw.get("probability_nothing_missing"), raw["probability_unknown"],
                     tuple(raw["remarks"]), folder, raw)


def diagnose(machine: str | Path, logs: Sequence[str | Path], *, controller: str | Path | None = None, out: str | Path | None = None,
             threads: int | None = None) -> Diagnosis:
    """Diagnoses measured logs of a crane or an axis against its file, as `slewlab diagnose` does. Without `out` the files go with the
    temporary folder they were made in. ProgramFailed, with what was said, where the records are refused."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(out) if out is not None else Path(temporary) / "findings"
        words = [program(), "diagnose", "--crane", str(machine), "--out", str(folder)]
        words += ["--threads", str(threads)] if threads is not None else []
        words += ["--controller", str(controller)] if controller is not None else []
        for log in logs:
            words += ["--log", str(log)]
        call(words)
        found = read_diagnosis(folder)
        return found if out is not None else Diagnosis(**{**vars(found), "folder": None})
