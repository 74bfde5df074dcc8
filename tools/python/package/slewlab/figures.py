"""Runs and logs as plotly figures, to be shown, changed, or written by figure.write_html()."""

from typing import TYPE_CHECKING

import numpy as np

from .tables import Channels

if TYPE_CHECKING:
    import plotly.graph_objects as go

# Title, unit on the axis, channel, fields, factor to that unit.
PANELS = (
    ("shaft speed", "rad/s", "ENCODER", ("shaft_speed",), 1.0),
    ("motor torque", "N m", "TORQUE", ("motor_torque",), 1.0),
    ("gearbox torque", "MN m", "TRUTH", ("gearbox_torque",), 1e-6),
    ("tip acceleration", "m/s^2", "SENSORS", ("tip_acceleration",), 1.0),
    ("load angles", "deg", "TRUTH", ("rope_angle", "rod_angle"), 180.0 / np.pi),
)
COLOURS = ("#1f5fa8", "#d2691e", "#2e8b57", "#8a2be2", "#708090", "#b22222", "#008b8b", "#c71585")


def overview(*runs: Channels, names: list[str] | None = None, most_points: int = 4000) -> "go.Figure":
    """Speeds, torques, acceleration and load angles over time, a column per run; panels of channels that no run has are left
    out. Needs plotly. Of longer series each stretch keeps its lowest and highest sample, so that no peak is lost."""
    from plotly.subplots import make_subplots

    panels = [panel for panel in PANELS if any(panel[2] in run for run in runs)]
    names = names or [f"run {number + 1}" for number in range(len(runs))]
    figure = make_subplots(rows=len(panels), cols=len(runs), shared_xaxes=True, shared_yaxes="rows", vertical_spacing=0.03,
                           column_titles=names if len(runs) > 1 else None)
    for row, (title, unit, channel, fields, factor) in enumerate(panels, 1):
        figure.update_yaxes(title_text=f"{title} [{unit.replace('^2', '²')}]", row=row, col=1)
        for column, run in enumerate(runs, 1):
            if channel not in run:
                continue
            table = run[channel]
            series = [name for field in fields for name in table.columns if name == field or name.startswith(field + "_")]
            for number, name in enumerate(series):
                time, values = thinned(table.index.to_numpy(), table[name].to_numpy() * factor, most_points)
                figure.add_scatter(x=time, y=values, name=name, line={"color": COLOURS[number % len(COLOURS)], "width": 1},
                                   legendgroup=name, showlegend=column == 1, row=row, col=column)
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
