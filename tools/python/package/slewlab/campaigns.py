"""Campaigns: every run of a study judged, journalled and put into one table."""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
import shlex
import signal
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core, drawn_tasks
from .engine import WorkerDied, run_in_processes, run_on_cluster
from .program import ProgramFailed
from .scenario import Scenario
from .study import Case, Study, load_study
from .sweep import UNITS, ProgressBar, measures
from .tables import Channels, open_log

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd

MEASURED = ("TORQUE", "SENSORS", "TRUTH")  # what `measures` looks at
JOURNAL, TABLE, PAGE = "journal.jsonl", "campaign.parquet", "campaign.html"
OUTCOMES = ("accepted", "not accepted", "no verdict", "complete", "refused", "failed")
ROW = {"run", "scenario", "changes", "outcome", "broken", "reason", "units"}  # what a line of every run has
SYNC = 1.0  # [s] of wall clock after which the journal is on the disk whatever happens to the machine


class CampaignMismatch(ValueError):
    """The folder holds another campaign."""


class JournalDamaged(ValueError):
    """A whole line of the journal is none that a campaign writes. The file is as it was found."""


def run_command(case: Case, study: Study, controller: str | None) -> str:
    """The one command that makes this run again."""
    if study.soak:
        return drawn_tasks.soak_command(case, study.soak, study.seed)
    if study.withheld:
        return drawn_tasks.withheld_command(study)
    words = ["slewlab", "accept" if study.limits else "run", case.scenario]
    words += ["--limits", study.limits] if study.limits else []
    words += ["--controller", controller] if controller else []
    for key, value in case.changes:
        words += ["--set", f"{key}={value}"]
    return shlex.join(words)


def check_columns(checks: Iterable[tuple]) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for name, verdict, measured, limit, unit, _, _ in checks:
        word = name.replace(" ", "_")
        columns[f"verdict.{word}"] = verdict
        if unit:
            columns[f"measured.{word}"] = measured
            columns[f"limit.{word}"] = limit
    return columns


def judged(scenario: Scenario, log: Path, limits: Path) -> tuple[dict[str, Any], dict[str, str]]:
    no_verdict, checks = scenario._core.judge(log, limits)
    broken = [(name, reason) for name, verdict, *_, reason in checks if verdict == "fail"]
    outcome = "no verdict" if no_verdict else "not accepted" if broken else "accepted"
    row = {"outcome": outcome, "broken": ", ".join(name for name, _ in broken),
           "reason": no_verdict or "; ".join(f"{name}: {reason}" for name, reason in broken)}
    units = {f"{kind}.{name.replace(' ', '_')}": unit for name, _, _, _, unit, _, _ in checks if unit for kind in ("measured", "limit")}
    return row | check_columns(checks), units


def made_run(scenario: Scenario, folder: Path, controller: str | None) -> tuple[Channels, Path]:
    """A run's messages and its log: in this process, or over LCM where the controller is a program."""
    if not controller:
        log = folder / "run.lcmlog"
        return scenario.run(channels=MEASURED, log=log), log
    log = folder / "run" / "run.lcmlog"
    try:
        return scenario.run_over_lcm(log.parent, controller), log
    except ProgramFailed:
        if not log.is_file():
            summary = log.with_name("summary.json")
            # Without when it was noticed, which differs from time to time.
            raise ProgramFailed(json.loads(summary.read_text())["reason"].partition(" at about ")[0] if summary.is_file() else "no run") from None
        return open_log(log), log  # the run is whole: what it broke of `expect:` is a check


def run_case(case: Case, limits: str | None, folder: str, controller: str | None = None,
             measure: Callable[[Channels], Mapping[str, float]] = measures) -> dict[str, Any]:
    """A row of the table: what can be known of one run, and nothing that depends on the machine that made it. Files are named
    as seen from `folder`: a worker of a cluster works elsewhere."""
    row: dict[str, Any] = {"run": case.run, "scenario": case.scenario, "changes": dict(case.changes), "outcome": "complete",
                           "broken": "", "reason": "", "units": {}}
    try:
        scenario = Scenario(Path(folder) / case.scenario, dict(case.changes))
        row |= {"seed": scenario.seed, "configuration_hash": scenario._core.configuration_hash}
        with tempfile.TemporaryDirectory(prefix="slewlab-") as own:
            run, log = made_run(scenario, Path(own), controller)
            found = measure(run)
            row["log_digest"] = _core.log_digest(log)
            if limits:
                verdicts, units = judged(scenario, log, Path(folder) / limits)
                row |= verdicts
                row["units"] = units
        row |= {name: value if math.isfinite(value) else None for name, value in found.items()}
        row["units"] = row["units"] | {name: UNITS[name] for name in found if name in UNITS}
    except _core.InputError as error:
        row |= {"outcome": "refused", "reason": str(error).replace(os.path.join(folder, ""), "")}
    except Exception as error:  # whatever a run dies of is its result; the others go on
        row |= {"outcome": "failed", "reason": f"{type(error).__name__}: {error}"}
    return row


def died(case: Case, why: WorkerDied) -> dict[str, Any]:
    return {"run": case.run, "scenario": case.scenario, "changes": dict(case.changes), "outcome": "failed", "broken": "",
            "reason": f"the worker's process ended twice: {why.reason}", "units": {}}


def content_digest(path: str) -> str:
    """Of what a file says, with what it includes: no comments, no sources."""
    lines = [f"{key},{value},{unit}\n" for key, value, unit, *_ in _core.file_values(Path(path), [])]
    return hashlib.sha256("".join(lines).encode()).hexdigest()[:16]


def identity(study: Study, controller: str | None) -> dict[str, Any]:
    """What has to be the same for rows of an earlier session to be rows of this one. Which runs there are is compared run by
    run, so that a random draw may be made longer; the kinds of withheld cases depend on how many there are."""
    if study.soak:
        plan = drawn_tasks.plan_of(study.soak, study.seed)
        return {"slewlab": _core.__version__, "soak": plan.configuration_hash, "faults": study.soak.faults, "seed": study.seed}
    if study.withheld:
        withheld = study.withheld
        return {"slewlab": _core.__version__, "withheld": study.runs, "seed": study.seed, "crane": content_digest(withheld.crane),
                "controller": content_digest(withheld.controller), "rate": withheld.rate, "sensors": withheld.sensors, "begin": withheld.begin}
    return {"slewlab": _core.__version__,
            "scenarios": {path: [content_digest(path), Scenario(path)._core.configuration_hash] for path in study.scenarios},
            "limits": content_digest(study.limits) if study.limits else None, "controller": controller}


class Journal:
    """OUT/journal.jsonl: a head, then a line per run as it ends. What is in it is never computed again."""

    def __init__(self, path: Path, head: Mapping[str, Any], cases: list[Case]) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.rows: dict[int, dict[str, Any]] = {}
        self.file = open(path, "a+b")
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self.file.close()
            raise CampaignMismatch(f"{path}: another process writes into it") from None
        try:
            self._read(head, cases)
        except BaseException:
            self.file.close()
            raise
        self.synced = time.monotonic()

    def _read(self, head: Mapping[str, Any], cases: list[Case]) -> None:
        self.file.seek(0)
        whole, cut, _ = self.file.read().rpartition(b"\n")
        lines = whole.split(b"\n") if cut else []
        entries = [self._entry(number, line) for number, line in enumerate(lines, 1)]
        self.file.truncate(len(whole) + len(cut))  # a line that a kill cut off is computed again
        if not lines:
            self._write({"campaign": head})
        else:
            self._compare(entries[0].get("campaign"), head)
        for row in entries[1:]:
            run = row["run"]
            if run >= len(cases) or [row["scenario"], row["changes"]] != [cases[run].scenario, dict(cases[run].changes)]:
                raise CampaignMismatch(f"{self.path}: holds another campaign: its run {run} is not this study's; name another folder with --out")
            self.rows[run] = row

    def _entry(self, number: int, line: bytes) -> dict[str, Any]:
        what, remedy = (("the campaign's head", "name another folder with --out, or put the line back: it says which campaign the others are of") if number == 1
                        else ("a run", "delete that line: its run is made again, and the other lines' are kept"))
        try:
            entry = json.loads(line)
        except ValueError as error:  # of bytes that are no UTF-8, too
            raise JournalDamaged(f"{self.path}:{number}: damaged ({error}), expected {what}; {remedy}") from None
        if not isinstance(entry, dict) or not ROW <= entry.keys() and number > 1:
            raise JournalDamaged(f"{self.path}:{number}: found {line[:40].decode(errors='replace')}, expected {what}; {remedy}")
        return entry

    def _compare(self, found: Any, head: Mapping[str, Any]) -> None:
        head = json.loads(json.dumps(head))
        if found == head:
            return
        differing = [key for key in head if not isinstance(found, dict) or found.get(key) != head[key]]
        raise CampaignMismatch(f"{self.path}: holds another campaign: {', '.join(differing)} differ; name another folder with --out")

    def _write(self, entry: Mapping[str, Any]) -> None:
        self.file.write(json.dumps(entry, separators=(",", ":")).encode() + b"\n")
        self.file.flush()

    def add(self, row: dict[str, Any]) -> None:
        self._write(row)
        self.rows[row["run"]] = row
        now = time.monotonic()
        if now - self.synced >= SYNC:
            os.fsync(self.file.fileno())
            self.synced = now

    def close(self) -> None:
        os.fsync(self.file.fileno())
        self.file.close()


def table_of(study: Study, rows: list[dict[str, Any]], controller: str | None = None) -> Any:
    """One Arrow table, a row per run in their order; units in the fields' metadata."""
    import pyarrow as pa

    units: dict[str, str] = {}
    for row in rows:
        units |= row["units"]
    numbers = {name for row in rows for name, value in row.items() if isinstance(value, float)}
    columns: dict[str, pa.Array] = {"run": pa.array([row["run"] for row in rows], pa.int64()),
                                    "scenario": pa.array([row["scenario"] for row in rows], pa.string())}
    for varied in study.vary:
        tail = 0 if varied.unit == "-" else len(varied.unit) + 1
        texts = [row["changes"][varied.key] for row in rows]
        texts = [text[:-tail] if tail else text for text in texts]
        try:
            columns[varied.key] = pa.array([float(text) for text in texts], pa.float64())
        except ValueError:
            columns[varied.key] = pa.array(texts, pa.string())
        units[varied.key] = varied.unit
    columns.setdefault("seed", pa.array([row.get("seed") for row in rows], pa.int64()))
    for name in ("configuration_hash", "log_digest", "outcome", "broken", "reason"):
        columns[name] = pa.array([row.get(name) for row in rows], pa.string())
    found = sorted({name for row in rows for name in row} - {"run", "scenario", "changes", "units", "seed", *columns})
    for name in sorted(found, key=lambda name: (not name.startswith(("verdict.", "measured.", "limit.")), name.partition(".")[2], name)):
        columns[name] = pa.array([row.get(name) for row in rows], pa.float64() if name in numbers else None)
    columns["command"] = pa.array([run_command(Case(row["run"], row["scenario"], tuple(row["changes"].items())), study, controller)
                                   for row in rows], pa.string())
    fields = [pa.field(name, column.type, metadata={"unit": units[name]} if name in units else None) for name, column in columns.items()]
    about = {"study": study.name, "draw": study.draw, "seed": str(study.seed), "slewlab": _core.__version__,
             "varied": json.dumps([each.key for each in study.vary])}
    return pa.table(list(columns.values()), schema=pa.schema(fields, metadata=about))


def write_table(table: Any, path: Path) -> None:
    import pyarrow.parquet as pq

    partial_path = path.with_name(path.name + ".partial")
    pq.write_table(table, partial_path, compression="zstd")
    os.replace(partial_path, path)


def read_table(path: str | Path) -> pd.DataFrame:
    """The table of a campaign; units in attrs["units"], which keys varied in attrs["varied"]."""
    import pyarrow.parquet as pq

    table = pq.read_table(path)
    frame = table.to_pandas().set_index("run")
    frame.attrs["units"] = {field.name: field.metadata[b"unit"].decode() for field in table.schema if field.metadata and b"unit" in field.metadata}
    frame.attrs["varied"] = json.loads(table.schema.metadata[b"varied"])
    frame.attrs["study"] = table.schema.metadata[b"study"].decode()
    return frame


def task_function(study: Study, out: Path, controller: str | None) -> Callable[[Case], dict[str, Any]]:
    folder = os.getcwd()
    if study.soak:
        return partial(drawn_tasks.run_task, soak=study.soak, seed=study.seed, folder=folder)
    if study.withheld:
        drawn_tasks.set_of(study, out).begin()
        return partial(drawn_tasks.make_case, study=study, out=str(out.absolute()), folder=folder)
    return partial(run_case, limits=study.limits, folder=folder, controller=controller)


def campaign(study: str | Path | Study, out: str | Path, *, controller: str | None = None, workers: int | None = None,
             client: Any = None, progress: bool | None = None) -> pd.DataFrame:
    """Runs what of the study is not yet in `out`, and writes `out`/campaign.parquet when all of it is there.

    `controller`: shell command of a program in place of the scenarios' controller; every run is one of two processes over LCM
    then; a soak and withheld cases have none. `workers`: processes of this machine, as many as there are processors; 0: in this one. `client`: a distributed.Client in their place. The
    table's bytes depend on neither. Ended early, by whatever, the same call goes on where it was. CampaignMismatch where the
    folder holds another campaign, JournalDamaged where its journal is damaged; InputError where a file is wrong.
    """
    study = study if isinstance(study, Study) else load_study(study)
    out = Path(out)
    if controller and (study.soak or study.withheld):
        raise ValueError("controller: found one beside a soak or withheld cases, expected it beside scenarios; those have their study's own")
    cases = study.cases()
    journal = Journal(out / JOURNAL, identity(study, controller), cases)
    try:
        for stale in (PAGE, TABLE):  # of an earlier time: what is there is whole
            (out / stale).unlink(missing_ok=True)
        bar = ProgressBar(len(cases), progress)
        open_cases = [case for case in cases if case.run not in journal.rows]
        bar.show(len(journal.rows))
        function = task_function(study, out, controller)
        done = run_in_processes(function, open_cases, workers) if client is None else run_on_cluster(function, open_cases, client)
        for index, row in done:
            journal.add(died(open_cases[index], row) if isinstance(row, WorkerDied) else row)
            bar.show(len(journal.rows))
        rows = [journal.rows[case.run] for case in cases]
        if study.withheld and all(row["outcome"] == "complete" for row in rows):
            drawn_tasks.set_of(study, out).seal()
        write_table(table_of(study, rows, controller), out / TABLE)
    finally:
        journal.close()
    return read_table(out / TABLE)


def ends_as_by_ctrl_c(*_: Any) -> None:
    raise KeyboardInterrupt


def stop_on_termination() -> None:
    """SIGTERM ends a campaign as Ctrl-C does: the journal is whole."""
    signal.signal(signal.SIGTERM, ends_as_by_ctrl_c)
