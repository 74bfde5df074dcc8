"""Draws what `slewlab diagnose` found: DIR/diagnosis.json, summary.txt and series.csv (of an axis series_N.csv) become
DIR/diagnosis.html.

usage: diagnosis_report.py DIR
"""

import argparse
import html
import json
import math
import os
import sys
import textwrap

import numpy
import pandas
import plotly.graph_objects as graph
from plotly.subplots import make_subplots

import axis_diagnosis_report
import diagnosis_words
from diagnosis_colours import AFTER, BEFORE, CURVES, MEASURED
from diagnosis_words import cause_name
from picture_page import STYLE, pictures
from whole_file import growing

# Below a picture, where no title stands.
LEGEND = {"orientation": "h", "yref": "container", "y": 0.01, "yanchor": "bottom", "x": 0.0, "xanchor": "left"}
BELOW = {"b": 120}  # [px] for an axis' title and the legend of up to two rows
ROW, BETWEEN = 230, 44  # [px] of a signal; between two, for the title of the lower one
BETWEEN_AXES = 90  # [px] between two, for the upper one's axis and title, too
LETTERS, NAME_LINE, BAR = 42, 17, 14  # of a cause's name before it goes on in the next line; [px] of such a line, and of a bar below its name
LEGEND_ROW, NAMES_IN_ROW = 20, 3  # [px] of a row of a legend; names for which it has room at least in a wide window


def folded(name, most):
    return "<br>".join(textwrap.wrap(name, most, break_long_words=False))


def probability_figure(found, is_narrow):
    """Names beside their bars, or above them where there is no room."""
    causes = [c for c in found["causes"] if c["probability"] > 0.002][:8]
    names = ["nothing is missing" if not c["effects"] and not found["gap"] else cause_name(c) for c in causes] + ["outside the catalogue"]
    shares = [c["probability"] for c in causes] + [found["probability_unknown"]]
    if found.get("probability_hidden"):
        names.insert(1, "one too small for these records")
        shares.insert(1, found["probability_hidden"])
    names = [folded(name, LETTERS) for name in names]
    lines = [name.count("<br>") + 1 for name in names]
    figure = graph.Figure(graph.Bar(x=shares[::-1], y=names[::-1], orientation="h", marker_color=AFTER))
    figure.update_layout(title="Probability of each cause", xaxis={"range": [0, 1], "tickformat": ".0%"})
    if is_narrow:
        row = NAME_LINE * max(lines) + BAR + 10
        figure.update_layout(height=90 + row * len(names), margin={"l": 10, "r": 25, "t": 50, "b": 40}, bargap=1 - BAR / row, xaxis_nticks=5,
                             yaxis_showticklabels=False)
        for name in names:
            figure.add_annotation(x=0, y=name, text=name, xanchor="left", yanchor="bottom", yshift=BAR / 2, align="left", showarrow=False)
    else:
        figure.update_layout(height=120 + max(34, NAME_LINE * max(lines) + 4) * len(names), margin={"l": 260, "t": 50, "b": 40},
                             yaxis={"automargin": True, "ticksuffix": "  "})
    return figure


def series_figure(series, after):
    signals = [("torque", "torque of group 1 [Nm per motor]")]
    signals += [(name, f"{name} acceleration [m/s²]") for name in ("house", "pivot", "middle", "tip") if name in series]
    figure = make_subplots(rows=len(signals), cols=1, shared_xaxes=True, vertical_spacing=BETWEEN / (ROW * len(signals)),
                           subplot_titles=[title for _, title in signals])
    for row, (name, _) in enumerate(signals, start=1):
        for column, label, colour in ((name, "measured", MEASURED), (f"{name}_before", "nominal crane", BEFORE),
                                      (f"{name}_after", after, AFTER)):
            figure.add_trace(graph.Scatter(x=series["time_s"], y=series[column], name=label, legendgroup=label,
                                           showlegend=row == 1, line={"color": colour, "width": 1}), row=row, col=1)
    figure.update_xaxes(title_text="time [s]", row=len(signals), col=1)
    figure.update_layout(title="Measured against predicted from the operator's moves", height=ROW * len(signals),
                         legend=LEGEND, margin=BELOW)
    return figure


def after_name(found):
    """What the crane has that is drawn as the one after."""
    if not found["causes"]:
        return "with nothing added"
    first = found["causes"][0]
    if found["probability_unknown"] > first["probability"]:
        return f"with {cause_name(first)}, which is not the answer"
    return "with the effect" if first["effects"] else "with other parameters"


def missing_figure(series, after):
    figure = make_subplots(rows=1, cols=3, subplot_titles=["against speed", "against shaft angle", "against time"])
    step = float(series["time_s"].iloc[1] - series["time_s"].iloc[0])
    angle = numpy.cumsum(series["speed"]) * step
    for column, (x, title) in enumerate(((series["speed"], "shaft speed [rad/s]"), (angle, "shaft angle [rad]"),
                                         (series["time_s"], "time [s]")), start=1):
        for missing, label, colour in (("missing_torque", "nominal crane", BEFORE), ("missing_torque_after", after, AFTER)):
            figure.add_trace(graph.Scatter(x=x, y=series[missing], mode="lines" if column == 3 else "markers", name=label,
                                           legendgroup=label, showlegend=column == 1, marker={"size": 3, "color": colour},
                                           line={"color": colour, "width": 1}), row=1, col=column)
        figure.update_xaxes(title_text=title, row=1, col=column)
    figure.update_yaxes(title_text="missing torque [Nm per motor]", row=1, col=1)
    figure.update_layout(title="What is missing at the motors of group 1", height=440, legend=LEGEND, margin=BELOW)
    return figure


def discrepancy_figure(found, is_narrow):
    """The torque in the answer's residual, as a smooth function of each variable: with two standard deviations either side.
    Variables beside each other, or one below the other where there is no room."""
    variables = [one for one in found["discrepancies"] if one["curves"]]
    titles = [f"{one['follows']}: {100 * one['share']:.0f} %" for one in variables]
    height = ROW * len(variables)
    figure = (make_subplots(rows=len(variables), cols=1, subplot_titles=titles, vertical_spacing=BETWEEN_AXES / height) if is_narrow
              else make_subplots(rows=1, cols=len(variables), shared_yaxes=True, subplot_titles=titles))
    for place, one in enumerate(variables, start=1):
        row, column = (place, 1) if is_narrow else (1, place)
        for number, curve in enumerate(one["curves"]):
            colour = CURVES[number % len(CURVES)]
            at, torque, wide = (numpy.array(curve[name]) for name in ("at", "missing_torque_nm", "deviation_nm"))
            figure.add_trace(graph.Scatter(x=numpy.concatenate([at, at[::-1]]), y=numpy.concatenate([torque - 2 * wide, (torque + 2 * wide)[::-1]]),
                                           fill="toself", fillcolor=colour, opacity=0.15, line={"width": 0}, hoverinfo="skip",
                                           showlegend=False), row=row, col=column)
            figure.add_trace(graph.Scatter(x=at, y=torque, mode="lines", name=f"{one['follows']}, {curve['part']}",
                                           line={"color": colour, "width": 1.5}), row=row, col=column)
        figure.update_xaxes(title_text=f"{one['follows']} [{one['unit']}]", row=row, col=column)
    figure.update_xaxes(tickangle=0, nticks=4)
    rows = math.ceil(sum(len(one["curves"]) for one in variables) / (1 if is_narrow else NAMES_IN_ROW))
    below = BELOW["b"] + LEGEND_ROW * (rows - 1)
    if is_narrow:
        figure.update_yaxes(matches="y", nticks=5)
        title = "What the rest follows: share of what is<br>slower than the structure; missing torque<br>[Nm per motor]"
        figure.update_layout(title={"text": title, "font": {"size": 14}, "yref": "container", "y": 0.985, "yanchor": "top"},
                             height=height + below, legend=LEGEND, margin={"l": 50, "r": 10, "b": below})
    else:
        figure.update_yaxes(title_text="missing torque [Nm per motor]", row=1, col=1)
        figure.update_layout(title="What the rest follows: share of what is slower than the structure",
                             height=320 + below, legend=LEGEND, margin={"b": below})
    return figure


def spectrogram_figure(series, modes, shown):
    if "tip_before" in series:
        signal, unit, title = series["tip"] - series["tip_before"], "m/s²", "Where and when the tip differs from the nominal crane"
    else:
        signal, unit, title = series["missing_torque"], "Nm", "Where and when the motors of group 1 miss torque"
    step = float(series["time_s"].iloc[1] - series["time_s"].iloc[0])
    window = max(2, min(len(signal) // 2, int(round(shown["window_s"] / step))))
    hop = max(1, window // 8)
    shape = numpy.hanning(window)
    columns, times = [], []
    for start in range(0, len(signal) - window, hop):
        columns.append(numpy.abs(numpy.fft.rfft(signal.to_numpy()[start:start + window] * shape)) * 2 / shape.sum())
        times.append(float(series["time_s"].iloc[start + window // 2]))
    frequency = numpy.fft.rfftfreq(window, step)
    keep = frequency <= shown["highest_hz"]
    levels = 20 * numpy.log10(numpy.maximum(1e-6, numpy.array(columns).T[keep]))
    figure = graph.Figure(graph.Heatmap(x=times, y=frequency[keep], z=levels, colorscale="Viridis",
                                        colorbar={"title": f"dB of 1 {unit}"}))
    for place, mode in enumerate(modes):
        figure.add_hline(y=mode["frequency_hz"], line={"color": "white", "width": 1, "dash": "dot"},
                         annotation_text=f"{mode['name']}, {mode['frequency_hz']:.1f} Hz",
                         annotation_font_color="white",
                         annotation_position="top left" if place % 2 == 0 else "top right")  # neighbours stay readable
    figure.update_layout(title=title, height=420,
                         xaxis_title="time [s]", yaxis_title="frequency [Hz]")
    return figure


def figures_of(found, directory):
    series = pandas.read_csv(os.path.join(directory, "series.csv"))
    after = after_name(found)
    figures = [(probability_figure(found, False), probability_figure(found, True))]
    if "torque_before" in series:  # a controller was given, so that there is a closed loop to predict
        figures.append(series_figure(series, after))
    if found.get("discrepancies"):
        figures.append((discrepancy_figure(found, False), discrepancy_figure(found, True)))
    return figures + [spectrogram_figure(series, found["modes"], found["spectrogram"]), missing_figure(series, after)]


def page(directory):
    with open(os.path.join(directory, "diagnosis.json"), encoding="utf-8") as file:
        found = json.load(file)
    with open(os.path.join(directory, "summary.txt"), encoding="utf-8") as file:
        summary = file.read()
    is_axis = found.get("kind") == "axis"
    head = f"<h1>{html.escape(found['verdict'])}</h1>" if is_axis else diagnosis_words.head(found, summary, directory)
    figures = axis_diagnosis_report.figures_of(found, directory) if is_axis else figures_of(found, directory)
    return (f"<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width, initial-scale=1'>"
            f"<title>slewlab diagnosis</title><style>{STYLE}{'' if is_axis else diagnosis_words.STYLE}body{{max-width:1200px}}pre{{white-space:pre-wrap;overflow-wrap:anywhere}}</style>"
            f"{head}<pre>{html.escape(summary)}</pre>{pictures(figures)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    directory = parser.parse_args().directory
    target = os.path.join(directory, "diagnosis.html")
    try:
        text = page(directory)
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"diagnosis_report: {directory}: {problem}")
    try:
        with growing(target) as partial:
            partial.write_text(text, encoding="utf-8")
    except OSError as problem:
        sys.exit(f"diagnosis_report: {problem}; the findings without the page are in {directory}")
    print(target)


if __name__ == "__main__":
    main()
