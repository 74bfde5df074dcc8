"""The figures of the page of an axis (diagnosis_report.py): diagnosis.json and series_N.csv."""

import os

import pandas
import plotly.graph_objects as graph
from plotly.subplots import make_subplots

from diagnosis_colours import AFTER, BEFORE, MEASURED

LEGEND = {"orientation": "h", "y": 1.08, "yanchor": "bottom", "x": 0.0, "xanchor": "left"}


def probability_figure(found):
    causes = [cause for cause in found["causes"] if cause["probability"] > 0.002][:8]
    names = [cause["words"] for cause in causes] + ["outside the catalogue (unknown)"]
    shares = [cause["probability"] for cause in causes] + [found["probability_unknown"]]
    if found["unknown_instead"]:
        names.append(found["unknown_instead"])
        shares.append(found["probability_unknown_instead"])
    figure = graph.Figure(graph.Bar(x=shares[::-1], y=names[::-1], orientation="h", marker_color=AFTER))
    figure.update_layout(title="Probability of each set of laws", xaxis={"range": [0, 1], "tickformat": ".0%"},
                         yaxis={"automargin": True}, height=140 + 34 * len(names))
    return figure


def residual_figure(found, series, log):
    unit = found["unit"]
    figure = make_subplots(rows=1, cols=3, horizontal_spacing=0.05)
    for column, (name, title) in enumerate((("speed", f"speed [{found['speed_unit']}]"),
                                            ("position", f"position [{found['position_unit']}]"), ("time", "time [s]")), start=1):
        for residual, label, colour in (("residual_nominal", "nominal axis", BEFORE), ("residual", "with the laws found", AFTER)):
            figure.add_trace(graph.Scattergl(x=series[name], y=series[residual], mode="markers", name=label, legendgroup=label,
                                             showlegend=column == 1, marker={"size": 3, "color": colour}), row=1, col=column)
        figure.update_xaxes(title_text=title, row=1, col=column)
    figure.update_yaxes(title_text=f"residual of the torque balance [{unit}]", row=1, col=1)
    figure.update_layout(title=f"Residual of the torque balance: {log}", height=420, legend=LEGEND, margin={"t": 110})
    return figure


def effort_figure(found, series, log):
    figure = graph.Figure()
    for values, label, colour in ((series["effort"], "measured", MEASURED),
                                  (series["effort"] - series["residual_nominal"], "nominal axis", BEFORE),
                                  (series["effort"] - series["residual"], "with the laws found", AFTER)):
        figure.add_trace(graph.Scattergl(x=series["time"], y=values, name=label, line={"color": colour, "width": 1}))
    figure.update_layout(title=f"Effort that the motion takes: {log}", xaxis_title="time [s]", yaxis_title=f"effort [{found['unit']}]",
                         height=380, legend=LEGEND, margin={"t": 110})
    return figure


def figures_of(found, directory):
    figures = [] if found["cannot_tell"] else [probability_figure(found)]
    for record in found["series"]:
        series = pandas.read_csv(os.path.join(directory, record["file"]))
        figures += [residual_figure(found, series, record["log"]), effort_figure(found, series, record["log"])]
    return figures
