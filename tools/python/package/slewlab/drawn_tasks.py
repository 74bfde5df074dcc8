"""Campaigns whose runs are drawn by the core itself: tasks of a soak and withheld cases, a row of the table each."""

import os
import shlex
import tempfile
from pathlib import Path
from typing import Any

from . import _core
from .study import Case, Soak, Study

LOGS = ("a", "b", "unseen")  # of a withheld case
SET = "cases"                # folder of a campaign in which its withheld cases lie


def soak_command(case: Case, soak: Soak, seed: int) -> str:
    words = ["slewlab", "soak", "--seed", str(seed), *(["--faults"] if soak.faults else []), "--config", soak.settings, "--crane", soak.crane,
             "--controller", soak.controller, "--task", str(case.run)]
    return shlex.join(words)


def withheld_command(study: Study) -> str:
    """Of every case the same: it makes what is missing of the set."""
    withheld = study.withheld
    assert withheld is not None
    words = ["slewlab", "withhold", "make", "--cases", str(study.runs), "--seed", str(study.seed), "--crane", withheld.crane, "--controller",
             withheld.controller, "--rate", f"{withheld.rate:g}", "--sensors", withheld.sensors, "--begin", withheld.begin, "--out", SET]
    return shlex.join(words)


def plan_of(soak: Soak, seed: int, folder: str = "") -> Any:
    return _core.SoakPlan(Path(folder) / soak.settings, Path(folder) / soak.crane, Path(folder) / soak.controller, soak.faults, seed)


def set_of(study: Study, out: Path, folder: str = "") -> Any:
    withheld = study.withheld
    assert withheld is not None
    return _core.WithheldSet(study.runs, study.seed, out / SET, Path(folder) / withheld.crane, Path(folder) / withheld.controller, withheld.rate,
                             withheld.sensors, withheld.begin)


def run_task(case: Case, soak: Soak, seed: int, folder: str) -> dict[str, Any]:
    """A task with every invariant as a check. Files are named as seen from `folder`."""
    row: dict[str, Any] = {"run": case.run, "scenario": case.scenario, "changes": {}, "seed": seed, "broken": "", "reason": "", "units": {}}
    try:
        plan = plan_of(soak, seed, folder)
        with tempfile.TemporaryDirectory(prefix="slewlab-") as own:
            told = plan.run(case.run, Path(own))
    except _core.InputError as error:
        return row | {"outcome": "refused", "reason": str(error).replace(os.path.join(folder, ""), "")}
    except Exception as error:  # whatever a task dies of is its result; the others go on
        return row | {"outcome": "failed", "reason": f"{type(error).__name__}: {error}"}
    broken = told["violations"]
    row |= {"configuration_hash": plan.configuration_hash, "log_digest": told["log_digest"], "outcome": "not accepted" if broken else "accepted",
            "broken": ", ".join(name for name, _, _ in broken), "reason": "; ".join(f"{name} at {time:.3f} s: {what}" for name, time, what in broken),
            "description": told["description"], "simulated_time": told["simulated_seconds"], "trips": told["trips"],
            "play_crossings": told["play_crossings"]}
    row |= {f"verdict.{name}": verdict for name, verdict in told["verdicts"].items()}
    units = {"simulated_time": "s"}
    for name, (measured, limit, unit) in told["measured"].items():
        row |= {f"measured.{name}": measured, f"limit.{name}": limit}
        units |= {f"measured.{name}": unit, f"limit.{name}": unit}
    return row | {"units": units}


def make_case(case: Case, study: Study, out: str, folder: str) -> dict[str, Any]:
    """A withheld case; nothing of what the machine was is told. Files are named as seen from `folder`."""
    name = f"case_{case.run + 1:04d}"
    row: dict[str, Any] = {"run": case.run, "scenario": case.scenario, "changes": {}, "seed": study.seed, "case": name, "outcome": "complete", "broken": "",
                           "reason": "", "units": {}}
    try:
        set_of(study, Path(out), folder).make(case.run + 1)
        digests = {log: _core.log_digest(Path(out) / SET / name / f"{log}.lcmlog") for log in LOGS}
    except Exception as error:  # whatever a case dies of is its result; the others go on
        return row | {"outcome": "failed", "reason": f"{type(error).__name__}: {error}"}
    return row | {"log_digest": digests["a"], "log_digest.b": digests["b"], "log_digest.unseen": digests["unseen"]}
