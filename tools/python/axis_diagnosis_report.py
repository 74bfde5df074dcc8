"""Draws what `slewlab diagnose` found of an axis: DIR/diagnosis.json, summary.txt and series_N.csv become DIR/diagnosis.html.

usage: axis_diagnosis_report.py DIR
"""

import argparse
import html
import json
import os
import sys

import pandas
import plotly.graph_objects as graph
from plotly.subplots import make_subplots

from whole_file import growing

MEASURED = "#222222"
BEFORE = "#c44e52"
AFTER = "#2a7f9e"
LEGEND = {"orientation": "h", "y": 1.08, "yanchor": "bottom", "x": 0.0, "xanchor": "left"}


def probability_figure(found):
    causes = [cause for cause in found["causes"] if cause["probability"] > 0.002][:8]
    names = [cause["words"] for cause in causes] + ["outside the catalogue (unknown)"]
    shares = [cause["probability"] for cause in causes] + [found["probability_unknown"]]
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
    figure.update_layout(title=f"What the balance leaves: {log}", height=420, legend=LEGEND, margin={"t": 110})
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


def page(directory):
    with open(os.path.join(directory, "diagnosis.json"), encoding="utf-8") as file:
        found = json.load(file)
    with open(os.path.join(directory, "summary.txt"), encoding="utf-8") as file:
        summary = file.read()
    figures = [probability_figure(found)]
    for record in found["series"]:
        series = pandas.read_csv(os.path.join(directory, record["file"]))
        figures += [residual_figure(found, series, record["log"]), effort_figure(found, series, record["log"])]
    body = "".join(figure.to_html(full_html=False, include_plotlyjs=index == 0, config={"responsive": True})
                   for index, figure in enumerate(figures))
    return (f"<!doctype html><meta charset='utf-8'><meta name='viewport' content='width=device-width'>"
            f"<title>slewlab diagnosis of an axis</title>"
            f"<style>body{{font-family:sans-serif;max-width:1200px;margin:2em auto;padding:0 1em}}"
            f"pre{{white-space:pre-wrap}}</style>"
            f"<h1>{html.escape(found['verdict'])}</h1><pre>{html.escape(summary)}</pre>{body}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    directory = parser.parse_args().directory
    target = os.path.join(directory, "diagnosis.html")
    try:
        text = page(directory)
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"axis_diagnosis_report: {directory}: {problem}")
    try:
        with growing(target) as partial:
            partial.write_text(text, encoding="utf-8")
    except OSError as problem:
        sys.exit(f"axis_diagnosis_report: {problem}; the findings without the page are in {directory}")
    print(target)


if __name__ == "__main__":
    main()
