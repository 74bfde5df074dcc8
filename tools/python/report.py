"""Draws a run: one self-contained HTML page beside its log, with the numbers on top. Needs no browser to make.

    slewlab report RUN_DIR                   writes RUN_DIR/report.html and prints the table
    slewlab report SITE.lcmlog               the same for a log that came alone: SITE.html beside it
    slewlab report RUN OTHER_RUN --out FILE  draws the runs side by side on the same scales, over each other, and their difference
"""

import html
import signal
import sys
from pathlib import Path

import numpy as np
import plotly.graph_objects as go

import axis_report
import run_log  # noqa: F401  for the package slewlab, which draws with these (slewlab/figures.py)
import run_numbers  # noqa: F401
from arguments import ArgumentParser, output_file
from comparison import Difference
from not_finite import places
from panel import DARK, GREEN, GREY, GROUP_COLOURS, PURPLE, Panel, dash_of, line, slim
from picture_page import STYLE, picture
from run_log import LogProblem, beside_its_run
from run_numbers import early_end, read_run, shown_path, table, table_text
from run_overview import phase_of
from whole_file import growing, is_free

ROW_HEIGHT = 205  # [px] at least
GAP = 34          # [px] between rows
NARROW_GAP = 74   # [px] where legends stand above their rows
TIME_AXIS = 26    # [px] of the time axis' title above the spectra
LEGEND_ENTRY, LEGEND_FRAME = 19, 10  # [px] of a legend in Plotly: an entry's height, and what is above the first and below the last
MOST_GAPS = 3     # that a page names by their times
DASHES = (("solid", "drawn through"), ("dot", "dotted"), ("dash", "dashed"), ("dashdot", "dash-dotted"))  # of runs over each other


def draw_speeds(run):
    """On the slew axis; the motors' own speeds where the log came without the ratio between the two."""
    log, overview, ratio = run.log, run.overview, run.facts.get("total_ratio")
    traces = []
    if log.has("OPERATOR") and run.facts.get("top_speed"):
        time, share = overview.drawn("OPERATOR", "request")
        request = np.append(share, share[-1]) * run.facts["top_speed"]
        traces.append(line(np.append(time, overview.phases[-1][2]), request, "request", GREY, "dot", line_shape="hv"))
    if log.has("ENCODER"):
        for group in range(overview.entries("ENCODER", "shaft_speed")):
            time, speed = overview.drawn("ENCODER", "shaft_speed", group)
            traces.append(line(time, speed / (ratio or 1.0), f"motors {group + 1}", GROUP_COLOURS[group], gaps=overview.gaps["ENCODER"]))
    if log.has("TRUTH") and ratio:
        traces.append(line(*overview.drawn("TRUTH", "house_speed"), "house", GREEN, gaps=overview.gaps["TRUTH"]))
    if log.has("CONTROLLER_STATE") and ratio:
        traces.append(line(*overview.drawn("CONTROLLER_STATE", "ramped_speed"), "ramp", DARK, "dash", gaps=overview.gaps["CONTROLLER_STATE"]))
    return traces


def draw_motor_torques(run):
    if not run.log.has("TORQUE"):
        return []
    rated, traces = run.facts.get("rated_torque"), []
    for group in range(run.overview.entries("TORQUE", "motor_torque")):
        time, torque = run.overview.drawn("TORQUE", "motor_torque", group)
        traces.append(line(time, torque * (100 / rated if rated else 1), f"group {group + 1}", GROUP_COLOURS[group],
                           dash_of(group), gaps=run.overview.gaps["TORQUE"], line_shape="hv"))
    return traces


def draw_gearbox_torques(run):
    if not run.log.has("TRUTH"):
        return []
    traces = []
    for group in range(run.overview.entries("TRUTH", "gearbox_torque")):
        time, torque = run.overview.drawn("TRUTH", "gearbox_torque", group)
        traces.append(line(time, torque * 1e-6, f"gearbox {group + 1}", GROUP_COLOURS[group], dash_of(group), gaps=run.overview.gaps["TRUTH"]))
    for group, times in enumerate(run.overview.crossing_times):
        if len(times) == 0:
            times = np.array([np.nan])  # keeps the legend the same for every run
        traces.append(
            go.Scatter(x=slim(times), y=np.zeros(len(times), np.float32), mode="markers",
                       name=f"{group + 1} crosses its play",
                       marker=dict(symbol="circle-open" if group % 2 else "x-thin", size=9, color=GROUP_COLOURS[group],
                                   line=dict(width=1.6, color=GROUP_COLOURS[group]))))
    return traces


def draw_acceleration(signal, name, colour):
    def draw(run):
        if not run.overview.measured(signal):
            return []
        return [line(*run.overview.drawn("SENSORS", signal), name, colour, width=1.0, gaps=run.overview.gaps["SENSORS"])]

    return draw


def draw_load_angles(run):
    if not run.log.has("TRUTH"):
        return []
    traces = []
    for field, name, colour, width in (("rope_angle", "rope: sidelead", PURPLE, 1.8), ("rod_angle", "load (rod)", DARK, 0.7)):
        time, angle = run.overview.drawn("TRUTH", field)
        traces.append(line(time, np.degrees(angle), name, colour, width=width, gaps=run.overview.gaps["TRUTH"]))
    return traces


def draw_spectra(phase):
    def draw(run):
        traces = []
        number = phase_of([name for name, _, _ in run.overview.phases], phase)
        for measured, label, colour in (("house_acceleration", "house", GROUP_COLOURS[5]), ("tip_acceleration", "tip", GREEN)):
            if number is None or not run.overview.measured(measured):
                continue
            frequency, amplitude = run.overview.spectra[number][measured]
            shown = (frequency >= 0.8 * run.band.lowest) & (frequency <= 1.33 * run.band.highest)
            traces.append(line(frequency[shown], amplitude[shown], label, colour))
        return traces

    return draw


def panels(runs):
    if all(axis_report.is_axis(run) for run in runs):
        return axis_report.panels(runs)
    rated = all(run.facts.get("rated_torque") for run in runs)
    rows = [
        Panel("slewing speed", "rad/s", draw_speeds) if all(run.facts.get("total_ratio") for run in runs)
        else Panel("motor speed", "rad/s", draw_speeds),
        Panel("motor torque", "% of T100" if rated else "Nm per motor", draw_motor_torques),
        Panel("gearbox torque", "MNm, slew axis", draw_gearbox_torques),
        Panel("tip acceleration", "m/s²", draw_acceleration("tip_acceleration", "tip", GREEN)),
        Panel("house acceleration", "m/s²", draw_acceleration("house_acceleration", "house", GROUP_COLOURS[5])),
        Panel("load angles", "°", draw_load_angles),
    ]
    names = max(([name for name, _, _ in run.overview.phases] for run in runs), key=len)
    for name in names:
        rows.append(Panel(f"spectrum {name}".strip(), "m/s²", draw_spectra(name), is_spectrum=True, phase=name))
    return [panel for panel in rows if any(panel.draw(run) for run in runs)]


def headings(runs):
    """What to call each run: by its play compensation where that tells them apart, else by its folder. One motor group alone has
    nothing to be held against."""
    motors = [[effort for effort in axis_report.machine_of(run).get("efforts", []) if effort["name"].startswith("motor")] for run in runs]
    if any(axis_report.is_axis(run) for run in runs) or any(len(each) == 1 for each in motors):
        return [run.name for run in runs]
    texts = [f"play compensation {'on' if run.facts.get('play_compensation') else 'off'}" for run in runs]
    ours = all("play_compensation" in run.facts
               and run.facts.get("controller_command", "slewlab-controller") == "slewlab-controller" for run in runs)
    return texts if ours and len(set(texts)) == len(runs) else [run.name for run in runs]


def letter(number):
    return chr(ord("A") + number % 26)


def figure(runs, rows, narrow=False):
    """A column per run, a row per panel (times above spectra), the same scale along each row."""
    return composed([[run] for run in runs], rows, headings(runs) if len(runs) > 1 else [], narrow)


def overlay(runs, rows, narrow=False):
    return composed([runs], rows, [], narrow)


def difference(runs, rows, narrow=False):
    """The first less the second over time; their spectra over each other."""
    return composed([[Difference(*runs)]], rows, [], narrow, spectra=[runs])


def axis_difference(runs, rows, narrow=False):
    """The same of a plain axis, which has no spectra."""
    apart = Difference(*runs, whole=True)
    return composed([[apart]], [panel for panel in rows if panel.draw(apart)], [], narrow)


def views(runs, rows=None):
    """{name: (figure, figure for a narrow window, what stands in its place there)}. `rows`: the panels, where not all are wanted."""
    rows = panels(runs) if rows is None else rows

    def both(make):
        return make(runs, rows), make(runs, rows, narrow=True)

    if len(runs) == 1:
        return {"picture": (*both(figure), None)}
    found = {"side by side": (*both(figure), "over each other"), "over each other": (*both(overlay), None)}
    of_axes = [axis_report.is_axis(run) for run in runs]
    if len(runs) == 2 and not any(of_axes):
        found["difference, A minus B"] = (*both(difference), None)
    if len(runs) == 2 and all(of_axes) and axis_report.is_same_scale(*runs):
        found["difference, A minus B"] = (*both(axis_difference), None)
    return found


def composed(columns, rows, titles, narrow=False, spectra=None):
    """The picture of columns of runs; the runs of one column are drawn over each other. `spectra`: the columns of the spectra's
    rows, where they are others."""
    time_rows = [r for r in range(len(rows)) if not rows[r].is_spectrum]
    traces, entries = drawn(columns, rows, spectra)
    gap = NARROW_GAP if narrow else GAP
    # A legend beside its row ends above the next one's. One that stands above its row is given its room by the page, which knows its width.
    heights = [ROW_HEIGHT if narrow else max(ROW_HEIGHT, LEGEND_ENTRY * count + LEGEND_FRAME - gap) for count in entries]
    top, bottom = (66 if narrow else 46), 50
    height = top + bottom + sum(heights) + (len(rows) - 1) * gap + TIME_AXIS
    inner = height - top - bottom

    def domain(row):
        extra = TIME_AXIS if rows[row].is_spectrum else 0
        upper = inner - sum(heights[:row]) - row * gap - extra
        return [max(0.0, (upper - heights[row]) / inner), upper / inner]

    count = len(columns)
    column_gap = 0.035
    width = (1 - column_gap * (count - 1)) / count

    fig = go.Figure(traces)
    layout = {}
    end = max(run.overview.phases[-1][2] for of_times in columns for run in of_times)
    for column, of_times in enumerate(columns):
        left = column * (width + column_gap)
        stops = sorted({run.overview.stop for run in of_times} - {None})
        for r, panel in enumerate(rows):
            number = r * count + column + 1
            suffix = "" if number == 1 else str(number)
            x_axis, y_axis = f"x{suffix}", f"y{suffix}"
            members = spectra[column] if panel.is_spectrum and spectra else of_times
            x = dict(anchor=y_axis, domain=[left, left + width], showgrid=True, gridcolor="#eeeeee", ticks="outside",
                     zeroline=False, linecolor="#888888", mirror=True)
            y = dict(anchor=x_axis, domain=domain(r), showgrid=True, gridcolor="#eeeeee", ticks="outside",
                     zeroline=not panel.is_spectrum, zerolinecolor="#666666", zerolinewidth=1, linecolor="#888888",
                     mirror=True)
            if column == 0:
                y["title"] = dict(text=f"{panel.title}<br>[{panel.axis}]", standoff=6)
            else:
                y.update(matches=f"y{r * count + 1 if r else ''}", showticklabels=False)
            if panel.is_spectrum:
                lowest, highest = shown_frequencies(members)
                x.update(type="log", range=[np.log10(lowest), np.log10(highest)], tickvals=ticks(lowest, highest)[1 if column else 0:])
                y.update(type="log", exponentformat="power", dtick=1)
                if r == len(rows) - 1:
                    x["title"] = dict(text="frequency [Hz]", standoff=4)
            else:
                x.update(range=[0, end])
                if r != 0 or column != 0:
                    x["matches"] = "x"
                if r == time_rows[-1]:
                    x["title"] = dict(text="simulated time [s]", standoff=4)
                else:
                    x["showticklabels"] = False
                for stop in stops:
                    fig.add_shape(type="line", xref=x_axis, yref=f"{y_axis} domain", x0=stop, x1=stop, y0=0, y1=1,
                                  line=dict(color="#aa0000", width=1, dash="dot"))
            layout[f"xaxis{suffix}"] = x
            layout[f"yaxis{suffix}"] = y

            if panel.is_spectrum:
                mark_modes(fig, members[0], x_axis, y_axis)
            if r == 0 and stops:
                fig.add_annotation(xref=x_axis, yref=f"{y_axis} domain", x=stops[0], y=0.98, text="emergency stop",
                                   showarrow=False, xanchor="left" if stops[0] < 0.6 * end else "right", yanchor="top",
                                   xshift=4 if stops[0] < 0.6 * end else -4, font=dict(size=11, color="#aa0000"))
        if titles:
            fig.add_annotation(xref="paper", yref="paper", x=left + width / 2, y=1, xanchor="center", yshift=24, showarrow=False,
                               text=f"<b>{letter(column)} {html.escape(shortened(titles[column]))}</b>", font=dict(size=14))
    for r in range(len(rows)):
        place = (dict(x=0, xanchor="left", y=domain(r)[1], yanchor="bottom", orientation="h") if narrow
                 else dict(x=1.008, xanchor="left", y=domain(r)[1], yanchor="top"))
        layout["legend" if r == 0 else f"legend{r + 1}"] = dict(font=dict(size=11), tracegroupgap=0, bgcolor="rgba(255,255,255,0)", **place)
    set_scales(fig, layout, rows, count)
    if narrow:  # the room above each row: below the row before it stand its numbers, below the last one over time also their title
        layout["meta"] = {"legend_rooms": [top if r == 0 else gap - 20 if panel.is_spectrum else gap for r, panel in enumerate(rows)]}
    # Left of a row: a title of two lines beside numbers like -0.0005.
    margin = dict(l=98, r=14, t=top, b=bottom) if narrow else dict(l=98, r=150, t=top, b=bottom)
    fig.update_layout(height=height, margin=margin, template="plotly_white", paper_bgcolor="rgba(0,0,0,0)", plot_bgcolor="rgba(0,0,0,0)",
                      modebar=dict(bgcolor="rgba(0,0,0,0)", color="#999999", activecolor="#0072B2"),
                      font=dict(family="Helvetica, Arial, sans-serif", size=12, color="#222222"), hovermode="x", **layout)
    return fig


def drawn(columns, rows, spectra):
    """All traces, a column after the other, and of each row how many entries its legend has. A name stands in it once, whichever column
    has it first."""
    traces, named = [], [set() for _ in rows]
    for column, of_times in enumerate(columns):
        for r, panel in enumerate(rows):
            number = r * len(columns) + column + 1
            suffix = "" if number == 1 else str(number)
            members, told = spectra[column] if panel.is_spectrum and spectra else of_times, set()
            for k, run in enumerate(members):
                for trace in panel.draw(run):
                    if len(members) > 1:
                        # Where there is no room for all, what an earlier run's entry says by its colour is left out.
                        trace.meta = {"is_told": trace.name in told}
                        told.add(trace.name)
                        trace.name = f"{letter(k)} {trace.name}"
                        if trace.mode == "lines" and k:  # the first keeps what tells its groups apart
                            trace.line.dash = DASHES[k % len(DASHES)][0]
                    trace.update(xaxis=f"x{suffix}", yaxis=f"y{suffix}", legend=f"legend{r + 1}" if r else "legend",
                                 legendgroup=f"{r}{trace.name}", showlegend=trace.name not in named[r])
                    named[r].add(trace.name)
                    traces.append(trace)
    return traces, [len(names) for names in named]


def shown_frequencies(runs):
    """[Hz] of all runs' machines; up to what was recorded where a machine's fifth bending mode is not known."""
    highest = 1.1 * max(run.band.highest for run in runs)
    if highest == np.inf:
        recorded = [frequency[-1] for run in runs for signals in run.overview.spectra for frequency, _ in signals.values() if len(frequency)]
        highest = max(recorded, default=100.0 * min(run.band.lowest for run in runs))
    return min(run.band.lowest for run in runs), highest


def ticks(lowest, highest):
    """1, 2 and 5 in each decade, as far as they are shown."""
    decades = 10.0 ** np.arange(np.floor(np.log10(lowest)), np.ceil(np.log10(highest)) + 1)
    return [float(f"{value:.3g}") for value in np.outer(decades, [1, 2, 5]).ravel() if lowest <= 1.01 * value and value <= 1.01 * highest]


def shortened(title):
    """So that two stand beside each other."""
    return title if len(title) <= 26 else title[:12] + " … " + title[-11:]


def mark_modes(fig, run, x_axis, y_axis):
    """The crane's own frequencies, as dashed lines with their names."""
    for mode in run.facts.get("modes", []):
        if not run.band.lowest <= mode["frequency"] <= run.band.highest:
            continue
        fig.add_shape(type="line", xref=x_axis, yref=f"{y_axis} domain", x0=mode["frequency"], x1=mode["frequency"],
                      y0=0, y1=1, line=dict(color="#bbbbbb", width=1, dash="dash"), layer="below")
        fig.add_annotation(xref=x_axis, yref=f"{y_axis} domain", x=np.log10(mode["frequency"]), y=0.98, textangle=-90,
                           name="mode", text=f"{mode['name']} · {mode['frequency']:.3g} Hz", showarrow=False, xanchor="right",
                           yanchor="top", xshift=1, font=dict(size=9, color="#707070"))


def set_scales(fig, layout, rows, columns):
    """One scale per row, the same for every run; one for all spectra, with room for the modes' names above."""
    lowest, highest = [np.inf] * len(rows), [-np.inf] * len(rows)
    for trace in fig.data:
        row = (int(trace.xaxis[1:] or 1) - 1) // columns
        finite = np.asarray(trace.y, float)
        finite = finite[np.isfinite(finite)]
        if len(finite):
            lowest[row] = min(lowest[row], float(finite.min()))
            highest[row] = max(highest[row], float(finite.max()))
    peak = max([highest[r] for r, panel in enumerate(rows) if panel.is_spectrum], default=-np.inf)
    for r, panel in enumerate(rows):
        if panel.is_spectrum:
            scale = [np.log10(peak) - 3.2, np.log10(peak) + 1.5] if 0 < peak < np.inf else [-3, 1]
        elif highest[r] > lowest[r]:
            margin = 0.07 * (highest[r] - lowest[r])
            scale = [lowest[r] - margin, highest[r] + margin]
        else:
            scale = [-1, 1]
        for column in range(columns):
            number = r * columns + column + 1
            layout[f"yaxis{number if number > 1 else ''}"]["range"] = scale


TITLE = "slewlab: "
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title>
<style>{style}body {{ max-width: {width}px; }}</style>
</head><body>
<h1>{title}</h1>
{broken}{remarks}
<div class="wide"><table><tr><th></th>{heads}</tr>
{rows}
</table></div>
{picture}
</body></html>
"""


BEGINNING = PAGE[:PAGE.index("{title}")] + TITLE  # of every page


def said_first(runs):
    """What to say before anything else: of runs that did not come to their end, and of logs that cannot show what a page is to show."""
    lines = [f"{early}. What follows is of the part that was logged." for early in map(early_end, runs) if early]
    for run in runs:
        if max(table.rows for table in run.log.tables.values()) < 2:
            lines.append(f"{run.name}: no channel of this log has more than one message: there is nothing to draw.")
        for channel, field, count, rows, first in places(run.log):
            lines.append(f"{run.name}: {field} of {channel} is no finite number in {count} of {rows} messages, the first at {first:.3f} s. "
                         "What follows of it cannot be relied on.")
    return lines


def where_missing(run):
    """Where the channels that are drawn have no messages: a line for those that are silent at the same time."""
    channels_of = {}
    for channel, gaps in run.overview.gaps.items():
        longest = sorted(sorted(gaps, key=lambda gap: gap[0] - gap[1])[:MOST_GAPS])
        said = [f"between {before:.7g} s and {after:.7g} s" for before, after in longest]
        if len(gaps) > MOST_GAPS:
            said.append(f"and in {counted(len(gaps) - MOST_GAPS, 'shorter gap')}")
        if said:
            channels_of.setdefault(", ".join(said), []).append(channel)
    return [f"{', '.join(channels)}: no message {said}" for said, channels in channels_of.items()]


def counted(count, what):
    return f"{count} {what}" + ("" if count == 1 else "s")


def remarks_of(run):
    return run.log.remarks + where_missing(run)


def page(runs, rows, first_lines=None):
    """The whole page as text; `first_lines` are those of said_first(), where they are known already."""
    first_lines = said_first(runs) if first_lines is None else first_lines
    title = TITLE + " against ".join(run.name for run in runs)
    remarks = "".join(
        f"<p>{html.escape(text)}</p>"
        for run in runs for text in [shown_path(run.log.path)] + [f"{run.name}: {remark}" for remark in remarks_of(run)])
    return PAGE.format(
        title=html.escape(title),
        width=1120 if len(runs) == 1 else 1500,
        style=STYLE,
        broken="".join(f'<p class="broken">{html.escape(line)}</p>\n' for line in first_lines),
        remarks=remarks,
        heads="".join(f"<th>{html.escape(text)}</th>" for text in lettered(headings(runs))),
        rows="\n".join(
            f"<tr><td>{html.escape(label)}</td>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"
            for label, cells in rows),
        picture=picture(views(runs), "over each other: " + ", ".join(f"{letter(k)} {DASHES[k % len(DASHES)][1]}" for k in range(len(runs)))),
    )


def lettered(texts):
    """As the picture names runs that are compared."""
    return [f"{letter(k)} {text}" for k, text in enumerate(texts)] if len(texts) > 1 else texts


def place_of(log):
    """Where the page of a log, or of a run's folder, goes that is given no other place."""
    of_a_run = log.parent if log.name in ("run.lcmlog", "run.lcmlog.partial") else log
    return of_a_run / "report.html" if of_a_run.is_dir() else log.with_suffix(".html")


def write_whole(path, text):
    """A file of this name is complete."""
    with growing(path) as partial:
        partial.write_text(text, encoding="utf-8")


def main(arguments=None):
    parser = ArgumentParser(prog="slewlab report", description="Draws runs of slewlab from their logs.")
    parser.add_argument("run", nargs="+", help="folder that holds run.lcmlog, or a log file")
    parser.add_argument("--out", type=output_file, help="the HTML file (default: beside the first log)")
    parser.add_argument("--quiet", action="store_true", help="do not print the table")
    options = parser.parse_args(arguments)
    with np.errstate(over="ignore", invalid="ignore"):  # one turned bit makes 1e200 of a sensor's value, whose square is no number
        return draw(options)


def draw(options):
    try:
        out = options.out and beside_its_run(options.out)
        runs = [read_run(folder) for folder in options.run]
        axis_report.share_machine(runs)
        first = Path(options.run[0])
        out = out or place_of(first)
        if not is_free(out, BEGINNING.encode()):
            raise LogProblem(f"{out}: is there already and is no earlier page; name another with --out")
        of_axes = all(axis_report.is_axis(run) for run in runs)
        rows = axis_report.table(runs) if of_axes else table(runs)
        first_lines = said_first(runs)
        write_whole(out, page(runs, rows, first_lines))
    except LogProblem as problem:
        print(f"slewlab report: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"slewlab report: {problem}", file=sys.stderr)
        return 1
    if not options.quiet:
        for line in first_lines:
            print(line)
        for run in runs:
            for remark in remarks_of(run):
                print(f"{run.name}: {remark}")
        print(table_text(headings(runs), rows))
        for run in runs:
            print(f"log: {shown_path(run.log.path)}")
        print(f"picture: {shown_path(out)}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
