"""Draws what `slewlab diagnose` found: DIR/diagnosis.json and DIR/series.csv become DIR/diagnosis.html.

usage: diagnosis_report.py DIR
"""

import argparse
import html
import json
import os
import sys

import numpy
import pandas
import plotly.graph_objects as graph
from plotly.subplots import make_subplots

MEASURED = "#222222"
BEFORE = "#c44e52"
AFTER = "#2a7f9e"


def cause_name(cause):
    return " with ".join(cause["effects"]) if cause["effects"] else "only parameters are off"


def probability_figure(found):
    causes = [c for c in found["causes"] if c["probability"] > 0.002][:8]
    names = [cause_name(c) for c in causes] + ["not in the catalogue"]
    shares = [c["probability"] for c in causes] + [found["probability_not_in_the_catalogue"]]
    figure = graph.Figure(graph.Bar(x=shares[::-1], y=names[::-1], orientation="h", marker_color=AFTER))
    figure.update_layout(title="Probability of each cause", xaxis={"range": [0, 1], "tickformat": ".0%"},
                         height=120 + 34 * len(names), margin={"l": 260, "t": 50, "b": 40})
    return figure


def series_figure(series):
    signals = [("torque", "torque of group 1 [Nm per motor]")]
    signals += [(name, f"{name} acceleration [m/s²]") for name in ("house", "pivot", "middle", "tip") if name in series]
    figure = make_subplots(rows=len(signals), cols=1, shared_xaxes=True, vertical_spacing=0.03,
                           subplot_titles=[title for _, title in signals])
    for row, (name, _) in enumerate(signals, start=1):
        for column, label, colour in ((name, "measured", MEASURED), (f"{name}_before", "nominal crane", BEFORE),
                                      (f"{name}_after", "with the effect", AFTER)):
            figure.add_trace(graph.Scatter(x=series["time_s"], y=series[column], name=label, legendgroup=label,
                                           showlegend=row == 1, line={"color": colour, "width": 1}), row=row, col=1)
    figure.update_xaxes(title_text="time [s]", row=len(signals), col=1)
    figure.update_layout(title="Measured against predicted from the operator's moves", height=230 * len(signals),
                         legend={"orientation": "h", "y": 1.06, "x": 0.5, "xanchor": "center"})
    return figure


def missing_figure(series):
    figure = make_subplots(rows=1, cols=3, subplot_titles=["against speed", "against shaft angle", "against time"])
    step = float(series["time_s"].iloc[1] - series["time_s"].iloc[0])
    angle = numpy.cumsum(series["speed"]) * step
    for column, (x, title) in enumerate(((series["speed"], "shaft speed [rad/s]"), (angle, "shaft angle [rad]"),
                                         (series["time_s"], "time [s]")), start=1):
        mode = "lines" if column == 3 else "markers"
        figure.add_trace(graph.Scatter(x=x, y=series["missing_torque"], mode=mode, showlegend=False,
                                       marker={"size": 3, "color": AFTER}, line={"color": AFTER, "width": 1}),
                         row=1, col=column)
        figure.update_xaxes(title_text=title, row=1, col=column)
    figure.update_yaxes(title_text="missing torque [Nm per motor]", row=1, col=1)
    figure.update_layout(title="What the nominal crane misses at the motors of group 1", height=380)
    return figure


def spectrogram_figure(series):
    signal = series["tip"] - series["tip_before"] if "tip" in series else series["missing_torque"]
    step = float(series["time_s"].iloc[1] - series["time_s"].iloc[0])
    window = int(round(2.0 / step))
    hop = max(1, window // 8)
    shape = numpy.hanning(window)
    columns, times = [], []
    for start in range(0, len(signal) - window, hop):
        columns.append(numpy.abs(numpy.fft.rfft(signal.to_numpy()[start:start + window] * shape)) * 2 / shape.sum())
        times.append(float(series["time_s"].iloc[start + window // 2]))
    frequency = numpy.fft.rfftfreq(window, step)
    keep = frequency <= 20
    levels = 20 * numpy.log10(numpy.maximum(1e-6, numpy.array(columns).T[keep]))
    figure = graph.Figure(graph.Heatmap(x=times, y=frequency[keep], z=levels, colorscale="Viridis",
                                        colorbar={"title": "dB of 1 m/s²"}))
    for mode, label in ((1.3, "1st bending"), (5.2, "2nd bending"), (10.4, "1st torsion"), (13.2, "3rd bending")):
        figure.add_hline(y=mode, line={"color": "white", "width": 1, "dash": "dot"}, annotation_text=label,
                         annotation_font_color="white", annotation_position="top left")
    figure.update_layout(title="Where and when the tip differs from the nominal crane", height=420,
                         xaxis_title="time [s]", yaxis_title="frequency [Hz]")
    return figure


def table(found):
    rows = "".join(
        f"<tr><td>{html.escape(g['signal'])}</td><td>{g['before']:.4g}</td><td>{g['after']:.4g}</td>"
        f"<td>{html.escape(g['unit'])}</td></tr>" for g in found.get("gaps", []))
    if not rows:
        return ""
    return (f"<h3>Gap in closed loop, on {html.escape(found.get('gaps_on', 'the last log'))}</h3>"
            f"<table><tr><th>signal</th><th>gap before</th><th>after</th><th>unit</th></tr>{rows}</table>")


def group(found):
    """What the records cannot tell from the first cause, and what would."""
    if not found["causes"] or not found["causes"][0].get("cannot_be_told_from"):
        return ""
    advice = {one["from"]: one["advice"] for one in found.get("told_apart_by", [])}
    items = "".join(f"<li>{html.escape(name)}{': ' + html.escape(advice[name]) if name in advice else ''}</li>"
                    for name in found["causes"][0]["cannot_be_told_from"])
    return f"<p>These records cannot tell the first cause from:</p><ul>{items}</ul>"


def page(directory):
    with open(os.path.join(directory, "diagnosis.json"), encoding="utf-8") as file:
        found = json.load(file)
    figures = [probability_figure(found)]
    series_path = os.path.join(directory, "series.csv")
    if os.path.exists(series_path):
        series = pandas.read_csv(series_path)
        figures += [series_figure(series), spectrogram_figure(series), missing_figure(series)]
    sizes = "".join(
        f"<li>{html.escape(s['parameter'])} = {s['value']:.4g} {html.escape(s['unit'])} "
        f"(90 %: {s['low_90']:.4g} to {s['high_90']:.4g})</li>" for s in found["causes"][0].get("sizes", [])
    ) if found["causes"] else ""
    body = "".join(figure.to_html(full_html=False, include_plotlyjs=index == 0)
                   for index, figure in enumerate(figures))
    return (f"<!doctype html><meta charset='utf-8'><title>slewlab diagnosis</title>"
            f"<style>body{{font-family:sans-serif;max-width:1200px;margin:2em auto}}td,th{{padding:2px 12px;"
            f"text-align:left}}</style><h1>{html.escape(found['verdict'])}</h1><ul>{sizes}</ul>{group(found)}{table(found)}{body}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    directory = parser.parse_args().directory
    target = os.path.join(directory, "diagnosis.html")
    try:
        text = page(directory)
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"diagnosis_report: {directory}: {problem}")
    with open(target + ".partial", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(target + ".partial", target)
    print(target)


if __name__ == "__main__":
    main()
