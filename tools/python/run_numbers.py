"""The numbers of a run that a crane engineer asks for, and the table of one or more runs side by side."""

import functools
import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from run_log import LogProblem, read_run_log
from run_overview import AFTER_STOP, BEFORE_STOP, Overview, phase_of
from spectrum import find_peaks
from whole_file import is_free

# Of the frequencies that are looked for: from between the load's swing and the machine's first mode to above its boom's fifth
# bending mode, the highest that a boom of a few elements has right; spectra over so many periods of the first mode.
FROM_FIRST, TO_FIFTH, FIRST_PERIODS = 0.38, 1.18, 6.535
UNKNOWN_FIRST = 1.3          # [Hz] of a machine that nothing is known of: chosen, as of a large crane
SHARE = 0.25                 # of the largest peak that a peak must reach to be named
FLOOR = 0.002                # [m/s^2] below which a spectrum is called quiet
MOST_PEAKS = 3
BEGINNING_OF_AN_IMPORT = b'{\n  "imported_from": '  # of the facts beside an imported log, by which they are told from a file of its user


@dataclass(frozen=True)
class Band:
    """Frequencies [Hz] of a machine that are looked for, and the length [s] of a spectrum that tells them apart."""

    lowest: float
    highest: float
    segment: float


def band_of(facts):
    """The band of a machine whose modes run.json names."""
    modes = {mode["name"]: mode["frequency"] for mode in facts.get("modes", []) if not mode["name"].startswith(("load", "rigid"))}
    first = min(modes.values(), default=UNKNOWN_FIRST)
    return Band(FROM_FIRST * first, TO_FIFTH * modes.get("bending 5", np.inf), FIRST_PERIODS / first)


@dataclass
class Run:
    """A run's log and what stands beside it (empty where nothing does)."""

    name: str
    log: object
    facts: dict = field(default_factory=dict)

    @functools.cached_property
    def overview(self):
        """What the log shows, gone through once."""
        return Overview(self.log, self.band.segment)

    @property
    def band(self):
        return band_of(self.facts)


def read_run(place):
    """The run in a folder that holds run.lcmlog, or in a log file of any name; LogProblem where it cannot be read."""
    place = Path(place)
    if not place.exists():
        raise LogProblem(f"{place}: there is no such folder or log")
    path = place if place.is_file() else place / "run.lcmlog"
    if not path.is_file() and (place / "run.lcmlog.partial").is_file():
        path = place / "run.lcmlog.partial"  # a run that was broken off
    return beside(read_run_log(path))


def is_of_a_run(log):
    return log.name in ("run.lcmlog", "run.lcmlog.partial")


def facts_path(log):
    """Where it stands what machine a log is of: run.json beside run.lcmlog, NAME.json beside NAME.lcmlog."""
    return log.with_name(log.name.removesuffix(".partial").removesuffix(".lcmlog") + ".json")


def facts_beside(log):
    """What stands beside a log: run.json of a run, or what `slewlab import` wrote; any other file of that name is not slewlab's."""
    path = facts_path(log)
    if not path.is_file() or not is_of_a_run(log) and not is_of_an_import(path):
        return {}
    try:
        return json.loads(path.read_text())
    except ValueError as error:
        raise LogProblem(f"{path}: {error}") from error


def is_of_an_import(facts):
    return facts.stat().st_size > 0 and is_free(facts, BEGINNING_OF_AN_IMPORT)


def beside(log):
    """The run of a log, with what stands beside it."""
    path = log.path
    return Run(path.resolve().parent.name if is_of_a_run(path) else path.stem, log, facts_beside(path))


def early_end(run):
    """What to say of a run that did not come to its end; nothing of others."""
    end = run.facts.get("end", "complete")
    if end == "complete" and run.log.path.suffix != ".partial":
        return ""
    why = {"complete": "", "under way": ": it was broken off"}.get(end, f": {end}")
    return f"{run.name}: this run ended before its time{why}"


def phase_peaks(spectrum, band):
    """The frequencies found in an acceleration: (frequency [Hz], amplitude [m/s^2]), largest first."""
    return find_peaks(*spectrum, band.lowest, band.highest, SHARE, FLOOR)[:MOST_PEAKS]


def numbers(run):
    """The run's numbers: {quantity: {phase: value}}, SI units, angles in rad; None where the log cannot tell."""
    overview = run.overview
    result = {"phases": [name for name, _, _ in overview.phases]}
    for number, (name, _, _) in enumerate(overview.phases):
        largest, values = overview.largest[number], {}
        for place in ("tip", "house"):
            signal = f"{place}_acceleration"
            if overview.measured(signal):
                values[f"peak_{signal}"] = largest[signal]
                values[f"{place}_frequencies"] = phase_peaks(overview.spectra[number][signal], run.band)
        if run.log.has("TRUTH"):
            values["largest_sidelead"] = largest["rope_angle"]
            values["play_crossings"] = overview.crossings[number]
        if run.log.has("TORQUE"):
            values["largest_motor_torque"] = largest["motor_torque"]
        result[name] = values
    return result


def _frequencies(peaks):
    if peaks is None:
        return "not in the log"
    if not peaks:
        return "quiet"
    return ", ".join(f"{frequency:.1f}" for frequency, _ in peaks) + " Hz"


def shown_path(path):
    """Relative to the working directory where it lies below it."""
    path = Path(path).resolve()
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def table(runs):
    """Rows (label, one text per run) of the table for people."""
    all_numbers = [numbers(run) for run in runs]
    names = max((n["phases"] for n in all_numbers), key=len)

    def row(label, phase, key, text):
        cells = []
        for run, n in zip(runs, all_numbers):
            number = phase_of(n["phases"], phase)
            value = None if number is None else n[n["phases"][number]].get(key)
            cells.append("no stop" if number is None else "not in the log" if value is None else text(run, value))
        return (label + (f", {phase}" if phase else ""), cells)

    def of_rated(run, torque):
        rated = run.facts.get("rated_torque")
        return f"{100 * torque / rated:.0f} % of T100" if rated else f"{torque:.0f} Nm per motor"

    rows = []
    for place in ("tip", "house"):
        for phase in names:
            rows.append(row(f"peak {place} acceleration", phase, f"peak_{place}_acceleration",
                            lambda run, v: f"{v:.2f} m/s²"))
    for place in ("tip", "house"):
        for phase in names:
            rows.append(row(f"frequencies at the {place}", phase, f"{place}_frequencies",
                            lambda run, v: _frequencies(v)))
    for phase in names:
        rows.append(row("crossings of the play, per gearbox", phase, "play_crossings",
                        lambda run, v: " / ".join(map(str, v))))
    for phase in names:
        rows.append(row("largest sidelead", phase, "largest_sidelead",
                        lambda run, v: f"{np.degrees(v):.1f}°"))
    for phase in names:
        rows.append(row("largest motor torque", phase, "largest_motor_torque", of_rated))

    def rate(facts):
        if not facts.get("wall_time"):
            return "not in run.json"
        simulated, wall = facts["simulated_time"], facts["wall_time"]
        return f"{simulated / wall:.1f} × ({simulated:.0f} s in {wall:.1f} s)"

    rows.append(("lockstep rate against real time", [rate(run.facts) for run in runs]))
    return rows


def table_text(headings, rows):
    """The table as text in columns."""
    widths = [max(len(row[0]) for row in rows)]
    for column, heading in enumerate(headings):
        widths.append(max([len(heading)] + [len(cells[column]) for _, cells in rows]))
    lines = ["  ".join([" " * widths[0]] + [h.ljust(w) for h, w in zip(headings, widths[1:])]).rstrip()]
    lines.append("  ".join("─" * w for w in widths))
    for label, cells in rows:
        lines.append("  ".join([label.ljust(widths[0])] + [c.ljust(w) for c, w in zip(cells, widths[1:])]).rstrip())
    return "\n".join(lines)


def finding(with_compensation, without_compensation):
    """One sentence on what play compensation did, from the numbers of the two runs."""
    on, off = numbers(with_compensation), numbers(without_compensation)
    before, after = BEFORE_STOP, AFTER_STOP
    if not all(before in n and "play_crossings" in n[before] for n in (on, off)):
        return "The runs have no emergency stop or no TRUTH in their logs, so there is nothing to compare."

    def count(crossed):
        if not any(crossed):
            return "no gearbox crosses its play"
        if len(set(crossed)) == 1:
            return f"every gearbox crosses its play {crossed[0]} times"
        return f"the gearboxes cross their play {' and '.join(map(str, crossed))} times"

    peak_on, peak_off = on[after]["peak_tip_acceleration"], off[after]["peak_tip_acceleration"]
    relation = "less" if peak_on < peak_off else "more"
    return (
        f"With play compensation {count(on[before]['play_crossings'])} before the emergency stop, without it "
        f"{count(off[before]['play_crossings'])}; after the stop the tip then peaks at {peak_on:.1f} m/s² instead of "
        f"{peak_off:.1f} m/s², {abs(1 - peak_on / peak_off) * 100:.0f} % {relation}."
    )
