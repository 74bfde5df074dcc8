"""Draws the scores of a diagnosis on withheld cases: one self-contained HTML page. Standard library only.

    score_report.py DIR/results/score.json [OTHER/score.json ...] [--out FILE] [--markdown]

Without --out the page is written beside the first file. Several files stand side by side in the table of scores (all
sensors, encoders and torques alone); pictures and tables below are the first one's. With --markdown nothing is written
to a file: the tables of docs/diagnosis/scores.md, of the first file, are printed.
"""

import argparse
import html
import json
import math
import sys
from pathlib import Path

from themed_page import page as themed

# Colours of the page's style, light or dark as the reader has it.
BLUE, ORANGE, GREEN, GREY, DARK, GRID = "var(--blue)", "var(--orange)", "var(--green)", "var(--faint)", "var(--text)", "var(--line)"

STYLE = """
:root { --blue: #0072B2; --orange: #D55E00; --green: #009E73; }
@media (prefers-color-scheme: dark) { :root { --blue: #58b0e8; --orange: #ff8f45; --green: #35c99c; } }
.yes { color: var(--good); } .no { color: var(--warn); } .small { color: var(--faint); }
svg { display: block; } li { overflow-wrap: anywhere; }
"""


def number(value, digits=3):
    return "–" if value is None else f"{value:.{digits}f}"


def interval(score):
    return "" if score["value"] is None else f"{score['low']:.3f} … {score['high']:.3f}"


def score_table(files, key):
    rows = []
    first = files[0][1][key]
    heads = "".join(f"<th colspan=2>{html.escape(name)}</th><th>cases</th>" for name, _ in files)
    aim_head = "<th>aim</th>" if key == "scores" else ""
    for k, score in enumerate(first):
        cells = ""
        for _, data in files:
            one = data[key][k]
            mark = ""
            if key == "scores" and one["value"] is not None:
                mark = "yes" if one["reached"] else "no"
            cells += (f"<td class='number {mark}'>{number(one['value'])}</td>"
                      f"<td class=small>{interval(one)}</td><td class=number>{one['cases']}</td>")
        aim = f"<td>{html.escape(score['aim'])}</td>" if key == "scores" else ""
        rows.append(f"<tr><td>{html.escape(score['name'])}</td>{aim}{cells}</tr>")
    return f"<div class=wide><table><tr><th>score</th>{aim_head}{heads}</tr>{''.join(rows)}</table></div>"


def svg(width, height, body):
    return f"<div class=wide><svg viewBox='0 0 {width} {height}' width={width} height={height} font-family=sans-serif font-size=12>{body}</svg></div>"


def line(x1, y1, x2, y2, colour=GREY, dash=""):
    dashes = f" stroke-dasharray='{dash}'" if dash else ""
    return f"<line x1={x1:.1f} y1={y1:.1f} x2={x2:.1f} y2={y2:.1f} style='stroke:{colour}'{dashes} />"


def text(x, y, words, anchor="middle", turn=None):
    turned = f" transform='rotate({turn} {x:.1f} {y:.1f})'" if turn is not None else ""
    return f"<text x={x:.1f} y={y:.1f} text-anchor={anchor} style='fill:{DARK}'{turned}>{html.escape(words)}</text>"


def calibration_picture(bins):
    width, height, left, top, size = 420, 430, 60, 45, 320
    body = line(left, top + size, left + size, top, GREY, "4,3")
    for tick in range(0, 11, 2):
        share = tick / 10
        body += text(left + share * size, top + size + 18, f"{share:.1f}")
        body += text(left - 8, top + size - share * size + 4, f"{share:.1f}", "end")
        body += line(left, top + size - share * size, left + size, top + size - share * size, GRID)
    most = max((one["cases"] for one in bins), default=1) or 1
    for one in bins:
        if one["cases"] == 0:
            continue
        x, y = left + one["stated"] * size, top + size - one["right"] * size
        radius = 4 + 10 * math.sqrt(one["cases"] / most)
        body += f"<circle cx={x:.1f} cy={y:.1f} r={radius:.1f} style='fill:{BLUE}' fill-opacity=0.6 />"
        body += text(x, y - radius - 3, str(one["cases"]))
    body += text(left + size / 2, top + size + 40, "probability stated for the first answer")
    body += text(18, top + size / 2, "share that was right", turn=-90)
    return svg(width, height, body)


BANDS = [0.0, 0.3, 1.0, 3.0, 10.0, 30.0, math.inf]


def detection_picture(sizes):
    """Detected, and named first, against how visible the effect is."""
    width, height, left, top, wide, high = 640, 330, 60, 20, 540, 240
    body = ""
    for tick in range(0, 11, 2):
        y = top + high - tick / 10 * high
        body += line(left, y, left + wide, y, GRID) + text(left - 8, y + 4, f"{tick / 10:.1f}", "end")
    step = wide / (len(BANDS) - 1)
    for k in range(len(BANDS) - 1):
        inside = [one for one in sizes if BANDS[k] <= one["visibility"] < BANDS[k + 1]]
        label = f"{BANDS[k]:g} … {BANDS[k + 1]:g}" if math.isfinite(BANDS[k + 1]) else f"> {BANDS[k]:g}"
        body += text(left + (k + 0.5) * step, top + high + 18, label)
        body += text(left + (k + 0.5) * step, top + high + 34, f"{len(inside)} cases")
        if not inside:
            continue
        for offset, colour, share in ((0.18, BLUE, sum(one["detected"] for one in inside) / len(inside)),
                                      (0.52, GREEN, sum(one["credit"] for one in inside) / len(inside))):
            body += (f"<rect x={left + (k + offset) * step:.1f} y={top + high - share * high:.1f} width={0.3 * step:.1f} "
                     f"height={share * high:.1f} style='fill:{colour}' />")
    at = left + 3 * step
    body += line(at, top, at, top + high, ORANGE, "4,3")
    body += text(left + wide / 2, top + high + 54, "largest change of any signal, in noise floors")
    return svg(width, height, body) + "<p class=small>Blue: detected. Green: first cause right.</p>"


def size_picture(sizes):
    """Every single-effect case on its effect's line, by visibility."""
    effects = sorted({one["effect"] for one in sizes})
    left, top, wide, row = 210, 24, 640, 18
    height = top + row * len(effects) + 50
    low, high = -1.5, 3.0

    def x_of(visibility):
        place = math.log10(max(10**low, min(10**high, visibility or 10**low)))
        return left + (place - low) / (high - low) * wide

    body = ""
    for decade in range(-1, 4):
        body += line(x_of(10**decade), top - 6, x_of(10**decade), top + row * len(effects), GRID)
        body += text(x_of(10**decade), top + row * len(effects) + 16, f"{10.0**decade:g}")
    body += line(x_of(3), top - 6, x_of(3), top + row * len(effects), ORANGE, "4,3")
    for k, effect in enumerate(effects):
        y = top + k * row + 8
        body += text(left - 10, y + 4, effect, "end")
        for one in sizes:
            if one["effect"] != effect:
                continue
            colour = GREEN if one["credit"] >= 0.99 else BLUE if one["detected"] else GREY
            colour = ORANGE if one["detected"] and one["credit"] == 0 else colour
            title = f"{one['law']}, size {one['size']:.4g}, {one['visibility']:.2f} noise floors"
            body += (f"<circle cx={x_of(one['visibility']):.1f} cy={y} r=5 style='fill:{colour}' fill-opacity=0.75>"
                     f"<title>{html.escape(title)}</title></circle>")
    body += text(left + wide / 2, top + row * len(effects) + 38,
                 "noise floors")
    return svg(left + wide + 20, height, body) + ("<p class=small>Green: right. Blue: in a declared group. Orange: detected, other cause. "
                                                  "Grey: not detected.</p>")


def confusion_table(confusion):
    rows = ""
    for truth, answers in sorted(confusion.items()):
        cells = ", ".join(
            f"<span class={'yes' if right(truth, answer) else 'no'}>{html.escape(answer)} × {count}</span>"
            for answer, count in sorted(answers.items(), key=lambda item: -item[1]))
        rows += f"<tr><td>{html.escape(truth)}</td><td>{cells}</td></tr>"
    return f"<div class=wide><table><tr><th>truth</th><th>first answer × cases</th></tr>{rows}</table></div>"


def right(truth, answer):
    outside = truth.endswith("(left out)") or truth.endswith("(no catalogue)")
    return answer == "outside the catalogue" if outside else answer == truth


def markdown(data):
    """The tables that stand in docs/diagnosis/scores.md."""
    lines = ["| score | value | 95 % | cases | aim |", "|---|---|---|---|---|"]
    for one in data["scores"] + data["also"]:
        aim = f"{one['aim']} ({'reached' if one['reached'] else 'not reached'})" if "aim" in one else ""
        spread = "" if one["value"] is None else f"{one['low']:.3f} ... {one['high']:.3f}"
        lines.append(f"| {one['name']} | {number(one['value'])} | {spread} | {one['cases']} | {aim} |")
    lines += ["", "| truth, one effect or none | answered |", "|---|---|"]
    for truth, answers in sorted(data["confusion"].items()):
        if " + " in truth:
            continue
        counted = ", ".join(f"{answer} {count}" for answer, count in sorted(answers.items()))
        lines.append(f"| {truth} | {counted} |")
    return "\n".join(lines)


def page(files):
    data = files[0][1]
    about = data.get("set", {})
    scored, made = data.get("cases", about.get("cases", "?")), about.get("cases", "?")
    begin = data.get("from", 1)
    which = (f"{scored} cases" if scored == made else f"the first {scored} of {made} cases" if begin == 1
             else f"cases {begin} to {begin + scored - 1} of {made}")
    head = f"{which}, seed {about.get('seed', '?')} ({about.get('purpose', '?')})"
    if about.get("laws") == "known":
        head += ", made of the laws that the diagnosis has: what can be reached at best"
    failures = "".join(f"<li>{html.escape(one)}</li>" for one in data["failures"])
    return themed("Scores on withheld cases", f"""<h1>Scores on withheld cases</h1><p>{html.escape(head)}. Green: aim reached. An effect counts as visible above 3 noise
floors; intervals are 95 %.</p>
{score_table(files, "scores")}
<h2>The same on all effects, visible or not, and more</h2>{score_table(files, "also")}
<h2>Detection against visibility (single effects)</h2>{detection_picture(data["sizes"])}
<h2>Every single effect</h2>{size_picture(data["sizes"])}
<h2>Calibration</h2>{calibration_picture(data["calibration"])}
<h2>Confusion: what was answered first</h2>{confusion_table(data["confusion"])}
<h2>Visible cases that were not answered rightly</h2><ul class=small>{failures or "<li>none</li>"}</ul>""", STYLE)


def main(arguments):
    parser = argparse.ArgumentParser(prog="score_report.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path, metavar="score.json")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--markdown", action="store_true")
    options = parser.parse_args(arguments)
    files = []
    for file in options.files:
        try:
            files.append((file.parent.name, json.loads(file.read_text())))
        except (OSError, ValueError) as problem:
            print(f"{file}: cannot be read as scores: {problem}", file=sys.stderr)
            return 1
    if options.markdown:
        print(markdown(files[0][1]))
        return 0
    out = options.out or options.files[0].with_name("score.html")
    partial = out.with_name(out.name + ".partial")
    partial.write_text(page(files))
    partial.replace(out)
    print(f"written: {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
