"""The numbers of a run that a crane engineer asks for, and the table of one or more runs side by side."""

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from run_log import LogProblem, read_run_log, seconds
from spectrum import amplitude_spectrum, find_peaks

LOWEST, HIGHEST = 0.5, 45.0  # [Hz] of the frequencies looked for: above the load's swing, up to the boom's fifth mode
SHARE = 0.25                 # of the largest peak that a peak must reach to be named
FLOOR = 0.002                # [m/s^2] below which a spectrum is called quiet
MOST_PEAKS = 3


@dataclass
class Run:
    """A run's log and what run.json beside it says of it (empty where there is none)."""

    name: str
    log: object
    facts: dict = field(default_factory=dict)


def read_run(place):
    """The run in a folder that holds run.lcmlog, or in a log file of any name; LogProblem where it cannot be read."""
    place = Path(place)
    if not place.exists():
        raise LogProblem(f"{place}: there is no such folder or log")
    path = place if place.is_file() else place / "run.lcmlog"
    if not path.is_file() and (place / "run.lcmlog.partial").is_file():
        path = place / "run.lcmlog.partial"  # a run that was broken off
    log = read_run_log(path)
    facts = {}
    facts_path = path.parent / "run.json"
    of_a_run = path.name in ("run.lcmlog", "run.lcmlog.partial")
    if of_a_run and facts_path.is_file():
        try:
            facts = json.loads(facts_path.read_text())
        except ValueError as error:
            raise LogProblem(f"{facts_path}: {error}") from error
    return Run(path.resolve().parent.name if of_a_run else path.stem, log, facts)


def measured(run, signal):
    """Whether the log's SENSORS hold the signal; what a crane has no sensor for stands there as NaN."""
    return run.log.has("SENSORS") and bool(np.all(np.isfinite(run.log.channel("SENSORS")[signal])))


def stop_time(log):
    """[s] when the operator pressed the emergency stop; None where that never happened."""
    if not log.has("OPERATOR"):
        return None
    moves = log.channel("OPERATOR")
    pressed = moves[moves["emergency_stop"]]
    return float(seconds(pressed)[0]) if len(pressed) else None


def phases(run):
    """(name, first, end) [s] of the parts of a run that are told apart: before and after the emergency stop.

    What happens at `end` belongs to the next part; the last one's end lies just behind the run's last message.
    """
    end = np.nextafter(max(table.last for table in run.log.tables.values()), np.inf)
    stop = stop_time(run.log)
    if stop is None or stop <= 0 or stop >= end:
        return [("", 0.0, end)]
    return [("before the stop", 0.0, stop), ("after the stop", stop, end)]


def within(messages, first, end):
    """The messages of a phase."""
    time = seconds(messages)
    return messages[(time >= first) & (time < end)]


def sample_period(messages):
    """[s] between two messages: the most common difference."""
    return float(np.median(np.diff(seconds(messages))))


def phase_spectrum(run, signal, first, end):
    """Spectrum of an acceleration in SENSORS during a phase: frequencies [Hz], amplitudes [m/s^2]."""
    sensors = within(run.log.channel("SENSORS"), first, end)
    if len(sensors) < 16 or not measured(run, signal):
        return np.zeros(0), np.zeros(0)
    time = seconds(sensors)
    step = sample_period(sensors)
    even = np.arange(time[0], time[-1] + 0.5 * step, step)  # lost messages leave no gap
    return amplitude_spectrum(np.interp(even, time, sensors[signal]), step)


def phase_peaks(run, signal, first, end):
    """The frequencies found in an acceleration: (frequency [Hz], amplitude [m/s^2]), largest first."""
    frequency, amplitude = phase_spectrum(run, signal, first, end)
    return find_peaks(frequency, amplitude, LOWEST, HIGHEST, SHARE, FLOOR)[:MOST_PEAKS]


def crossings(run):
    """Times [s] at which each gearbox crossed its play: one array per motor group."""
    truth = run.log.channel("TRUTH")
    time = seconds(truth)
    times = []
    for group in range(truth["play_crossings"].shape[1]):
        steps = np.diff(truth["play_crossings"][:, group], prepend=0)
        times.append(np.repeat(time, np.maximum(steps, 0)))
    return times


def numbers(run):
    """The run's numbers: {quantity: {phase: value}}, SI units, angles in rad; None where the log cannot tell."""
    result = {"phases": [name for name, _, _ in phases(run)]}
    for name, first, end in phases(run):
        values = {}
        for place in ("tip", "house"):
            signal = f"{place}_acceleration"
            if measured(run, signal):
                sensors = within(run.log.channel("SENSORS"), first, end)
                values[f"peak_{signal}"] = float(np.max(np.abs(sensors[signal])))
                values[f"{place}_frequencies"] = phase_peaks(run, signal, first, end)
        if run.log.has("TRUTH"):
            truth = within(run.log.channel("TRUTH"), first, end)
            values["largest_sidelead"] = float(np.max(np.abs(truth["rope_angle"])))
            values["play_crossings"] = [
                int(np.sum((times >= first) & (times < end))) for times in crossings(run)
            ]
        if run.log.has("TORQUE"):
            torque = within(run.log.channel("TORQUE"), first, end)
            values["largest_motor_torque"] = float(np.max(np.abs(torque["motor_torque"])))
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
            value = n.get(phase, {}).get(key)
            cells.append("not in the log" if value is None else text(run, value))
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
    before, after = "before the stop", "after the stop"
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
