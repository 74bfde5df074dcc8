"""What the rows of a report's picture are made of."""

import numpy as np
import plotly.graph_objects as go

from envelope import broken, thinned

# Colours that stay apart for colour-blind readers (Okabe and Ito's set).
GROUP_COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#8C564B", "#7F7F7F"]
DARK, GREY, GREEN, PURPLE = "#222222", "#999999", "#009E73", "#8E4B9E"


def slim(values):
    """Single precision: more than a screen can show, at half the size. What is beyond it is damage, and drawn as a gap."""
    values = np.asarray(values, float)
    return np.where(np.abs(values) > np.finfo(np.float32).max, np.nan, values).astype(np.float32)


class Panel:
    """One row of the picture: a title for its axis, and what it draws for a run."""

    def __init__(self, title, axis, draw, is_spectrum=False, phase=None):
        self.title, self.axis, self.draw = title, axis, draw
        self.is_spectrum, self.phase = is_spectrum, phase


def line(x, y, name, colour, dash=None, width=1.3, gaps=(), **more):
    x, y = broken(*thinned(x, y), gaps)
    return go.Scatter(x=slim(x), y=slim(y), name=name, mode="lines",
                      line=dict(color=colour, dash=dash, width=width), **more)


def dash_of(group):
    """Later groups are dashed, so that equal torques do not hide each other."""
    return None if group == 0 else "5px,2px"
