"""`slewlab diagnose` with its answer as objects."""

import contextlib
import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .files import path_of
from .machine import Machine
from .program import ProgramFailed, call, program
from .tables import Channels, Log, unit_text

CANNOT_TELL, REFUSAL = 3, "cannot tell, because "  # exit code of `slewlab diagnose`, and what it says


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
class Remainder:
    """What of the gap no stated law explains, and what it follows."""

    share: float  # of the gap, 0 to 1, on data that were not fitted
    follows: str  # torque, speed, position, time, ...; empty: nothing that was tried
    followed_share: float  # of the remainder's mean square, 0 to 1, that follows it
    words: str  # the same as a sentence says it: "follows the torque"
    is_unknown: bool  # more than noise and what known laws would make as well: outside the catalogue


@dataclass(frozen=True)
class Diagnosis:
    """Where measured records differ from the nominal machine, and what causes it."""

    answer: str  # in one sentence
    gap: bool
    causes: tuple[Cause, ...]
    subsystems: dict[str, float]  # probabilities
    probability_nothing_missing: float | None  # None of an axis
    probability_hidden: float  # that an effect acts which is too small for these records, where nothing missing leads; 0 of an axis
    probability_unknown: float
    remarks: tuple[str, ...]
    is_stated: bool | None  # of an axis: the answer names laws, or says that none is missing; None of a crane
    action: str  # of an axis: what to do, in one sentence; "" of a crane
    explained_share: float | None  # of an axis: of the gap, 0 to 1, by the first cause on blocks left out of the fit; None of a crane
    remainder: Remainder | None  # of an axis; None of a crane
    folder: Path | None  # with the page, the machine's file with the effect, and all numbers
    raw: dict[str, Any] = field(repr=False)  # diagnosis.json


def _cause(told: dict[str, Any]) -> Cause:
    alike = told.get("cannot_be_told_from", ())
    sizes = tuple(Size(one["parameter"], one["value"], one["low_90"], one["high_90"], unit_text(one["unit"])) for one in told["sizes"])
    return Cause(tuple(told["effects" if "effects" in told else "laws"]), tuple(map(tuple, told.get("or", ()))), told["probability"], sizes, tuple(one["cause"] for one in alike),
                 told["validation"]["holds"] if "validation" in told else None)


def read_diagnosis(folder: str | Path) -> Diagnosis:
    """What `slewlab diagnose --out FOLDER` left there. FileNotFoundError where that is nothing."""
    folder = Path(folder)
    if not (folder / "diagnosis.json").is_file():
        raise FileNotFoundError(f"{folder}: found no diagnosis.json there, expected the folder of a finished diagnosis (slewlab diagnose --out {folder})")
    raw = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    is_axis, causes = raw.get("kind") == "axis", list(map(_cause, raw["causes"]))
    if is_axis and causes:  # the first one alone is validated
        causes[0] = replace(causes[0], validated=raw["validation"]["holds"])
    remainder = None
    if is_axis:
        told = raw["remainder"]
        remainder = Remainder(raw["unexplained_share"], told["follows"], told["share"], told["words"], raw["has_unknown_remainder"])
    # An axis's answer is its verdict; it has no subsystems to blame.
    return Diagnosis(raw["verdict" if is_axis else "answer"], raw["gap"], tuple(causes),
                     raw.get("subsystems") or {}, raw.get("probability_nothing_missing"), raw.get("probability_hidden", 0.0), raw["probability_unknown"],
                     tuple(raw["remarks"]), raw.get("is_stated"), raw.get("action", ""), raw.get("explained_share"), remainder, folder, raw)


class CannotTell(ProgramFailed):
    """The records cannot tell: nothing is wrong with the call, and no answer is given. `reasons` say why, and what would be right."""

    def __init__(self, text: str, reasons: tuple[str, ...] = ()) -> None:
        super().__init__(text, CANNOT_TELL)
        self.reasons = reasons


def _paths(logs: Any) -> list[Path]:
    """One log or several, each a path or what open_log() gave."""
    paths = []
    for log in [logs] if isinstance(logs, (str, os.PathLike, Channels)) else list(logs):
        if not isinstance(log, (str, os.PathLike, Log)):
            raise TypeError(f"found {log!r} for a log, expected a path or what open_log() gave; of a run in this process, run(log=PATH) writes one")
        paths.append(log.path if isinstance(log, Log) else Path(log))
    return paths


@contextlib.contextmanager
def _file_of(machine: Any, folder: Path) -> Iterator[Path]:
    """Of a Machine with changes a file among the findings, where the file with the effect finds it."""
    if not isinstance(machine, Machine):
        yield path_of(machine, "a crane's or an axis's file, or a Machine")
        return
    if not machine.changes:
        yield machine.path
        return
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    written = machine.write(folder / "machine.yaml")
    try:
        yield written
    except BaseException:
        written.unlink()
        if is_new:
            folder.rmdir()
        raise


def diagnose(machine: Machine | str | Path, logs: Log | str | Path | Iterable[Log | str | Path], *,
             unseen: Log | str | Path | Iterable[Log | str | Path] = (), controller: str | Path | None = None, without: Iterable[str] = (),
             measured_torque: bool = False, fitted_seconds: float | None = None, out: str | Path | None = None,
             threads: int | None = None) -> Diagnosis:
    """Diagnoses a measured log, or several, of a crane or an axis against its file or a Machine, as `slewlab diagnose` does. `unseen` logs
    have no part in the answer, which is tried on them; `without` names effects that the catalogue is to do without (of an axis: laws of its
    torque balance); `measured_torque` says that a crane's torques were measured, not commanded, so that their scatter is noise;
    `fitted_seconds` is how much of long logs is fitted at most. Without `out`
    the files go with the temporary folder they were made in. CannotTell, with the reasons, where the records are refused; ProgramFailed, with
    what was said, where a file is wrong."""
    paths, unseen_paths = _paths(logs), _paths(unseen)
    if not paths:
        raise ValueError("found no log, expected at least one")
    if isinstance(without, str):
        raise TypeError(f"found {without!r} for without, expected a list of effects: [{without!r}]")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(out) if out is not None else Path(temporary) / "findings"
        with _file_of(machine, folder) as file:
            words = [program(), "diagnose", "--crane", str(file), "--out", str(folder)]
            words += ["--threads", str(threads)] if threads is not None else []
            words += ["--controller", str(path_of(controller, "a controller's file"))] if controller is not None else []
            words += ["--measured-torque"] if measured_torque else []
            words += ["--fitted-seconds", str(fitted_seconds)] if fitted_seconds is not None else []
            for option, given in (("--log", paths), ("--unseen", unseen_paths), ("--without", without)):
                for one in given:
                    words += [option, str(one)]
            try:
                call(words)
            except ProgramFailed as failed:
                if failed.code != CANNOT_TELL:
                    raise
                said = str(failed).partition(REFUSAL)[2].splitlines()
                raise CannotTell(str(failed), tuple(filter(None, map(str.strip, said)))) from None
        found = read_diagnosis(folder)
        return found if out is not None else Diagnosis(**{**vars(found), "folder": None})
