"""Runs and logs as plotly figures, to be shown, changed, or written by figure.write_html()."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from .installed import installed_module
from .scenario import Run
from .tables import Channels, Log, row_type

if TYPE_CHECKING:
    import plotly.graph_objects as go

# Title, channel, fields, factor, and the unit on the axis: of a factor other than 1 the one that it leads to, of which {} is the machine's own.
PANELS = (
    ("shaft speed", "ENCODER", ("shaft_speed",), 1.0, "{}"),
    ("motor torque", "TORQUE", ("motor_torque",), 1.0, "{}"),
    ("gearbox torque", "TRUTH", ("gearbox_torque",), 1e-6, "M{}"),
    ("tip acceleration", "SENSORS", ("tip_acceleration",), 1.0, "{}"),
    ("load angles", "TRUTH", ("rope_angle", "rod_angle"), 180.0 / np.pi, "deg"),
)
COLOURS = ("#1f5fa8", "#d2691e", "#2e8b57", "#8a2be2", "#708090", "#b22222", "#008b8b", "#c71585")


def overview(*runs: Channels, names: list[str] | None = None, most_points: int = 4000) -> "go.Figure":
    """Speeds, torques, acceleration and load angles over time, a column per run; panels of channels that no run has are left
    out. Needs plotly. Of longer series each stretch keeps its lowest and highest sample, so that no peak is lost."""
    _refuse_no_runs(runs, names)
    from plotly.subplots import make_subplots

    panels = [panel for panel in PANELS if any(panel[1] in run for run in runs)]
    if not panels:
        raise ValueError(f"found nothing to draw, expected one of the channels {', '.join(dict.fromkeys(panel[1] for panel in PANELS))} in a run")
    names = names or [f"run {number + 1}" for number in range(len(runs))]
    figure = make_subplots(rows=len(panels), cols=len(runs), shared_xaxes=True, shared_yaxes="rows", vertical_spacing=0.03,
                           column_titles=names if len(runs) > 1 else None)
    for row, (title, channel, fields, factor, spelled) in enumerate(panels, 1):
        units = set()
        for column, run in enumerate(runs, 1):
            if channel not in run:
                continue
            table = run[channel]
            series = [name for field in fields for name in table.columns if name == field or name.startswith(field + "_")]
            units |= {spelled.format(table.attrs["units"][name]) for name in series}
            for number, name in enumerate(series):
                time, values = thinned(table.index.to_numpy(), table[name].to_numpy() * factor, most_points)
                figure.add_scatter(x=time, y=values, name=name, line={"color": COLOURS[number % len(COLOURS)], "width": 1},
                                   legendgroup=name, showlegend=column == 1, row=row, col=column)
        figure.update_yaxes(title_text=f"{title} [{' or '.join(sorted(units)).replace('^2', '²')}]", row=row, col=1)
    figure.update_xaxes(title_text="time [s]", row=len(panels))
    figure.update_layout(height=220 * len(panels), margin={"l": 70, "r": 20, "t": 40, "b": 50}, template="plotly_white")
    return figure


def thinned(time: np.ndarray, values: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """At most about `most` samples: the lowest and the highest of each stretch, in their order."""
    if len(values) <= most:
        return time, values
    bounds = np.linspace(0, len(values), most // 2 + 1).astype(int)
    kept = set()
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        kept |= {begin + int(np.argmin(values[begin:end])), begin + int(np.argmax(values[begin:end]))}
    index = np.array(sorted(kept))
    return time[index], values[index]


class _LogOf:
    """A run or a log as the report's panels go through it (tools/python/run_log.py)."""

    def __init__(self, channels: Channels, table: type) -> None:
        self._channels, self.remarks = channels, getattr(channels, "remarks", [])
        self.path = getattr(channels, "path", Path("run"))
        self.tables = {}
        for name in channels.channels:
            if isinstance(channels, Log):
                dtype, (rows, first, last) = row_type(channels._tables.layout(name)), channels._tables.extent(name)
            else:
                messages = channels.messages(name)
                dtype, rows = messages.dtype, len(messages)
                first, last = (messages["simulated_time"].min(), messages["simulated_time"].max()) if rows else (0, 0)
            self.tables[name] = table(dtype, rows, first / 1e9, last / 1e9)

    def has(self, name: str) -> bool:
        return name in self.tables

    def channel(self, name: str) -> np.ndarray:
        return self._channels.messages(name)

    def stretches(self, *names: str) -> Iterator[dict[str, np.ndarray]]:
        wanted = [name for name in names or self.tables if name in self.tables]
        if isinstance(self._channels, Log):
            yield from self._channels.stretches(*wanted)
        else:
            yield {name: self._channels.messages(name) for name in wanted}


def _facts(run: Channels) -> dict[str, Any]:
    """What run.json would say of a run in this process, as far as pictures ask for it."""
    if not isinstance(run, Run):
        return {}
    machine = run.scenario.machine
    modes = [{"name": f"{mode.kind} {mode.count}", "frequency": mode.frequency} for mode in machine.modes() if mode.kind != "rigid"]
    return {"machine": machine.facts(), "rated_torque": machine.rated_torque, "total_ratio": machine.total_ratio, "top_speed": machine.top_speed,
            "modes": [] if machine.kind == "axis" else modes}


def report_figures(*runs: Channels, names: list[str] | None = None, panels: Sequence[str] | None = None) -> "dict[str, go.Figure]":
    """The figures of `slewlab report`'s page, by the code that draws it: of one run "picture"; of more "side by side" and "over each
    other", and of two "difference, A minus B". Speeds, torques, accelerations and load angles over time, spectra with the machine's modes.

    `panels`: only those whose titles begin so: ["spectrum"]. A log is drawn with what run.json beside it says of the machine, a run in
    this process with its scenario's. Needs plotly.
    """
    _refuse_no_runs(runs, names)
    report = installed_module("report")
    told = []
    for number, run in enumerate(runs):
        log = _LogOf(run, report.run_log.Table)
        one = report.run_numbers.beside(log) if isinstance(run, Log) else report.run_numbers.Run(f"run {number + 1}", log, _facts(run))
        if names:
            one.name = names[number]
            one.facts = {key: value for key, value in one.facts.items() if key != "play_compensation"}  # by which the page would call it
        told.append(one)
    rows = report.panels(told)
    if panels is not None:
        wanted = [panels] if isinstance(panels, str) else list(panels)
        titles = [row.title for row in rows]
        for title in wanted:
            if not any(each.startswith(title) for each in titles):
                raise ValueError(f"no panel {title!r} here, expected {_core.known_names_text(title, titles)}")
        rows = [row for row in rows if any(row.title.startswith(title) for title in wanted)]
    if not rows:
        raise ValueError("found nothing to draw, expected a run with one of the channels ENCODER, TORQUE, SENSORS, TRUTH")
    return {name: wide for name, (wide, _, _) in report.views(told, rows).items()}


def _refuse_no_runs(runs: Sequence[Any], names: list[str] | None) -> None:
    if not runs:
        raise TypeError("found no run, expected at least one, as of Scenario.run() or open_log()")
    for run in runs:
        if not isinstance(run, Channels):
            raise TypeError(f"found {run!r}, expected a run or a log; open_log() opens a path")
    if names is not None and len(names) != len(runs):
        raise ValueError(f"found {len(names)} names for {len(runs)} runs, expected one for each")
