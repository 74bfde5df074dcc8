"""Draws what `slewlab accept` judged: acceptance.html beside the log, each check with its reason, failures marked.

    acceptance_plot.py RUN_DIR      (acceptance.json and the log lie there)
"""

import html
import json
import sys
from pathlib import Path

import numpy as np
from plotly.subplots import make_subplots

from panel import DARK, GREEN, GREY, GROUP_COLOURS, PURPLE, line
from picture_page import STYLE, picture
from report import draw_motor_torques, write_whole
from run_log import LogProblem, seconds
from run_numbers import read_run, shown_path

RED = "#C00000"
# Which row of the picture shows what a check is about; None: the whole picture.
ROW_OF_CHECK = {"direction": 1, "overshoot": 1, "settling": 1, "stop time": 1, "stop overshoot": 1, "stop distance": 1,
                "reaction": 1, "trips": 1, "torque share": 2, "play offset": 2, "play crossings": 3, "sidelead": 4,
                "tip acceleration": 5}
TITLES = ["slewing speed [% of top speed]", "motor torque [% of T100]", "play passed [times, all gearboxes]",
          "sidelead [°]", "tip acceleration [m/s²]"]


def speed_rows(run, result, ratio):
    log = run.log
    encoder = log.channel("ENCODER")
    time = seconds(encoder)
    speed = encoder["shaft_speed"].mean(axis=1) / ratio / result["top_speed"] * 100
    rows = []
    if log.has("OPERATOR"):
        moves = log.channel("OPERATOR")
        begin = np.append(seconds(moves), time[-1])
        stopped = np.maximum.accumulate(moves["emergency_stop"].astype(bool))
        asked = np.where(stopped, 0.0, moves["speed_request"]) * 100
        asked = np.append(asked, asked[-1])
        band = result["settled_within"] * 100
        rows += [line(begin, asked + band, "band", GREY, "dot", 0.8, line_shape="hv"),
                 line(begin, asked - band, "band", GREY, "dot", 0.8, line_shape="hv", showlegend=False),
                 line(begin, asked, "asked", DARK, "dash", line_shape="hv")]
    return rows + [line(time, speed, "speed", GREEN)]


def figure(run, result):
    log = run.log
    ratio = run.facts.get("total_ratio") or result["total_ratio"]
    run.facts.setdefault("rated_torque", result["rated_torque"])
    fig = make_subplots(rows=len(TITLES), cols=1, shared_xaxes=True, vertical_spacing=0.035, subplot_titles=TITLES)
    fig.add_traces(speed_rows(run, result, ratio), rows=1, cols=1)
    fig.add_traces(draw_motor_torques(run), rows=2, cols=1)
    if log.has("TRUTH"):
        truth = log.channel("TRUTH")
        fig.add_trace(line(seconds(truth), truth["play_crossings"].sum(axis=1), "play passed", GROUP_COLOURS[5],
                           line_shape="hv"), row=3, col=1)
        fig.add_trace(line(seconds(truth), np.degrees(truth["rope_angle"]), "sidelead", PURPLE), row=4, col=1)
    if log.has("SENSORS"):
        sensors = log.channel("SENSORS")
        fig.add_trace(line(seconds(sensors), sensors["tip_acceleration"], "tip", GREEN, width=1.0), row=5, col=1)
    if log.has("OPERATOR"):
        moves = log.channel("OPERATOR")
        pressed = seconds(moves[moves["emergency_stop"]])
        if len(pressed):
            fig.add_vline(x=float(pressed[0]), line=dict(color=RED, width=1, dash="dot"))
    for check in result["checks"]:
        row = ROW_OF_CHECK.get(check["name"])
        if check["verdict"] == "fail" and row and check["time"] >= 0:
            fig.add_vline(x=check["time"], row=row, col=1, line=dict(color=RED, width=2), annotation_text=check["name"],
                          annotation_font_color=RED, annotation_position="top right")
    fig.update_xaxes(title_text="simulated time [s]", row=len(TITLES), col=1)
    fig.update_layout(height=1050, template="plotly_white", margin=dict(l=60, r=20, t=30, b=110), hovermode="x", font=dict(color="#222222"),
                      paper_bgcolor="rgba(0,0,0,0)", plot_bgcolor="rgba(0,0,0,0)",
                      legend=dict(orientation="h", y=-0.07, yanchor="top", bgcolor="rgba(255,255,255,0)"))
    fig.update_xaxes(gridcolor="#eeeeee", zerolinecolor="#666666")
    fig.update_yaxes(gridcolor="#eeeeee", zerolinecolor="#666666")
    return fig


def page(run, result):
    rows = "".join(
        f'<tr><td class="{html.escape(c["verdict"])}">{html.escape(c["verdict"])}</td>'
        f'<td>{html.escape(c["name"])}</td><td>{html.escape(c["reason"])}</td></tr>' for c in result["checks"])
    verdict = "accepted" if result["accepted"] else "NOT accepted"
    drawn = figure(run, result)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>slewlab accept: {html.escape(run.name)}: {verdict}</title>
<style>{STYLE}body {{ max-width: 1120px; }}
.fail {{ color: #C00000; }}
@media (prefers-color-scheme: dark) {{ .fail {{ color: #ff7b72; }} }}
</style></head><body>
<h1>{html.escape(run.name)}: {verdict}</h1>
<div class="wide"><table>{rows}</table></div>
{picture({"picture": (drawn, drawn, None)}, is_packed=False)}
</body></html>
"""


def main():
    folder = Path(sys.argv[1])
    try:
        run = read_run(folder)
        result = json.loads((folder / "acceptance.json").read_text())
        if not run.log.has("ENCODER"):
            raise LogProblem("no ENCODER in the log: nothing to draw")
        write_whole(folder / "acceptance.html", page(run, result))
    except (LogProblem, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"plot: {shown_path(folder / 'acceptance.html')}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
