"""The page of a campaign: which values break which acceptance check."""

import math
from pathlib import Path

import numpy as np

from themed_page import escaped, page, printed, table
from whole_file import growing

WIDTH, HEIGHT = 320, 200  # of a picture, in its own units
LEFT, RIGHT, TOP, BOTTOM = 52, 8, 10, 22
MOST_POINTS = 1500  # of a picture; of more runs every failed one and a share of the others is drawn
MOST_ROWS = 200  # of the table of broken runs

STYLE = """
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 290px), 1fr)); gap: .6em; }
figure { margin: 0; background: var(--panel); border: 1px solid var(--line); border-radius: 4px; padding: .4em; min-width: 0; }
figcaption { font-size: .88em; color: var(--faint); overflow-wrap: anywhere; }
svg { width: 100%; height: auto; display: block; } svg text { fill: var(--text); font-size: 11px; }
.grid { stroke: var(--grid); } .axis { stroke: var(--line); } .limit { stroke: var(--bad); stroke-dasharray: 5 3; }
.pass { fill: var(--accent); fill-opacity: .55; } .fail { fill: var(--bad); }
.key { display: inline-block; width: .7em; height: .7em; border-radius: 50%; margin: 0 .3em 0 .8em; }
"""


def three(value):
    return f"{value:.3g}"


def with_unit(text, unit):
    return text if unit in ("", "-", None) else f"{text} {printed(unit)}"


def separation(values, broken):
    """How well a key tells the broken runs from the others: the probability that a broken run has the larger value than one that
    is not (area under the receiver operating characteristic). 1 or 0: entirely; 0.5: not at all. None of words."""
    values, broken = np.asarray(values), np.asarray(broken, bool)
    if values.dtype.kind not in "fi" or broken.all() or not broken.any():
        return None
    order = values.argsort(kind="stable")
    ranks = np.empty(len(values))
    ranks[order] = np.arange(1, len(values) + 1)
    for each in np.unique(values):  # equal values share their mean rank
        same = values == each
        ranks[same] = ranks[same].mean()
    count = int(broken.sum())
    return float((ranks[broken].sum() - count * (count + 1) / 2) / (count * (len(values) - count)))


def checks_of(frame):
    """{check: (which runs broke it, column of what was measured or None, its limit)}; the most broken first."""
    found = {}
    for column in frame.columns:
        if not column.startswith("verdict."):
            continue
        name = column.partition(".")[2]
        measured = f"measured.{name}" if f"measured.{name}" in frame else None
        limits = frame[f"limit.{name}"].dropna() if f"limit.{name}" in frame else []
        found[name] = ((frame[column] == "fail").to_numpy(), measured, float(limits.iloc[0]) if len(limits) else None)
    return dict(sorted(found.items(), key=lambda item: -item[1][0].sum()))


def stretch(values):
    """Lowest and highest with a margin."""
    finite = [value for value in values if value is not None and math.isfinite(value)]
    if not finite:
        return None
    low, high = min(finite), max(finite)
    margin = 0.06 * (high - low) or 0.5 * abs(high) or 1.0
    return low - margin, high + margin


def marks(low, high, most=5):
    step = 10.0 ** math.floor(math.log10((high - low) / most))
    step *= next(each for each in (1, 2, 5, 10) if (high - low) / (each * step) <= most)
    first = math.ceil(low / step)
    return [number * step for number in range(first, math.floor(high / step) + 1)]


def picture(x, y, broken, runs, names, limit, x_name, y_name):
    """What was measured over one key. `names`: words in place of numbers along the key; else None."""
    x_range, y_range = (-0.5, len(names) - 0.5) if names else stretch(x), stretch([*y, limit])
    if x_range is None or y_range is None:
        return ""

    def across(value):
        return LEFT + (value - x_range[0]) / (x_range[1] - x_range[0]) * (WIDTH - LEFT - RIGHT)

    def up(value):
        return HEIGHT - BOTTOM - (value - y_range[0]) / (y_range[1] - y_range[0]) * (HEIGHT - TOP - BOTTOM)

    parts = []
    for mark in marks(*y_range):
        parts.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{up(mark):.1f}" y2="{up(mark):.1f}"/>'
                     f'<text x="{LEFT - 5}" y="{up(mark) + 4:.1f}" text-anchor="end">{mark:.4g}</text>')
    for mark, word in enumerate(names) if names else ((each, f"{each:.4g}") for each in marks(*x_range)):
        parts.append(f'<text x="{across(mark):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle">{escaped(word)}</text>')
    parts.append(f'<line class="axis" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{HEIGHT - BOTTOM}" y2="{HEIGHT - BOTTOM}"/>')
    if limit is not None:
        parts.append(f'<line class="limit" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{up(limit):.1f}" y2="{up(limit):.1f}"/>')
    every = max(1, -(-len(x) // MOST_POINTS))
    for index in [i for i in range(len(x)) if not broken[i] and i % every == 0] + [i for i in range(len(x)) if broken[i]]:
        if not math.isfinite(y[index]):
            continue
        word = names[int(x[index])] if names else three(x[index])
        parts.append(f'<circle class="{"fail" if broken[index] else "pass"}" cx="{across(x[index]):.1f}" cy="{up(y[index]):.1f}" r="3.2">'
                     f'<title>run {runs[index]}: {escaped(word)}, {three(y[index])}</title></circle>')
    return (f'<figure><svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escaped(y_name)} over {escaped(x_name)}">{"".join(parts)}</svg>'
            f"<figcaption>{escaped(y_name)} over {escaped(x_name)}</figcaption></figure>")


def keys_of(frame):
    """What varied: its values as numbers, and its words where it has no numbers."""
    keys = {}
    scenarios = frame["scenario"].unique()
    for key in [*(["scenario"] if len(scenarios) > 1 else []), *frame.attrs["varied"]]:
        column = frame[key]
        if column.dtype.kind in "fi":
            keys[key] = (column.to_numpy(float), None)
        else:
            words = list(dict.fromkeys(column))
            shown = [Path(word).stem for word in words] if key == "scenario" else words
            keys[key] = (np.array([words.index(word) for word in column], float), shown)
    return keys


def most_telling(frame, keys, broken):
    """A sentence per key, the most telling first."""
    rows = []
    for key, (values, words) in keys.items():
        unit = frame.attrs["units"].get(key, "")
        if words:
            shares = [(word, broken[values == number].mean()) for number, word in enumerate(words)]
            spread = max(share for _, share in shares) - min(share for _, share in shares)
            said = ", ".join(f"{word} {100 * share:.0f} %" for word, share in shares)
            rows.append((spread, f"<b>{escaped(key)}</b>: broken by {escaped(said)} of the runs"))
            continue
        area = separation(values, broken)
        if area is None:
            continue
        low, high = values[broken].min(), values[broken].max()
        direction = "larger" if area >= 0.5 else "smaller"
        rows.append((abs(2 * area - 1), f"<b>{escaped(key)}</b>: broken {'at ' if low == high else f'from {three(low)} to '}{with_unit(three(high), unit)}; "
                                        f"a broken run has the {direction} value with probability {max(area, 1 - area):.2f}"))
    return [text for weight, text in sorted(rows, key=lambda row: -row[0])]


def section(frame, keys, name, broken, measured, limit):
    unit = frame.attrs["units"].get(measured, "") if measured else ""
    said = f"{int(broken.sum())} of {len(frame)} runs broke it" + ("" if limit is None else f"; limit {with_unit(three(limit), unit)}")
    texts = "".join(f"<li>{each}</li>" for each in most_telling(frame, keys, broken))
    pictures = ""
    if measured:
        y = frame[measured].to_numpy(float)
        shown = with_unit(name.replace("_", " "), f"[{unit}]" if unit else "")
        pictures = "".join(picture(values, y, broken, frame.index, words, limit, with_unit(key, f"[{frame.attrs['units'][key]}]" if
                                   frame.attrs["units"].get(key, "-") != "-" else ""), shown) for key, (values, words) in keys.items())
    return f"<h2>{escaped(name.replace('_', ' '))}</h2><p>{said}</p><ul>{texts}</ul><div class=pictures>{pictures}</div>"


def draw(frame):
    counts = frame["outcome"].value_counts()
    order = [each for each in ("accepted", "complete", "not accepted", "no verdict", "refused", "failed") if each in counts]
    classes = {"accepted": "good", "complete": "good"}
    said = ", ".join(f'<span class="{classes.get(each, "bad")}">{counts[each]} {each}</span>' for each in order)
    keys, checks = keys_of(frame), checks_of(frame)
    body = [f"<h1>Campaign {escaped(frame.attrs['study'])}</h1><p>{len(frame)} runs: {said}.</p>"]
    broken_checks = {name: found for name, found in checks.items() if found[0].any()}
    if checks:
        rows = []
        for name, (broken, measured, limit) in checks.items():
            unit = frame.attrs["units"].get(measured, "") if measured else ""
            values = frame[measured].dropna() if measured else []
            rows.append([escaped(name.replace("_", " ")), f'<td class="number {"bad" if broken.any() else "good"}">{int(broken.sum())}</td>',
                         f'<td class=number>{three(values.min()) if len(values) else ""}</td>',
                         f'<td class=number>{three(values.max()) if len(values) else ""}</td>',
                         f'<td class=number>{"" if limit is None else three(limit)}</td>', escaped(printed(unit))])
        body.append("<h2>Checks</h2>" + table(["check", "broken by runs", "lowest", "highest", "limit", "unit"], rows))
        body.append('<p class=small><span class=key style="background:var(--accent)"></span>passed'
                    '<span class=key style="background:var(--bad)"></span>broken; the dashed line is the limit.</p>')
    body += [section(frame, keys, name, *found) for name, found in broken_checks.items()]
    if checks and not broken_checks:
        body.append("<p class=good>No run broke a check.</p>")
    first = next(iter(checks.items()), None)
    if first and not broken_checks:  # something to look at, though all is well
        body += [section(frame, keys, name, *found) for name, found in checks.items() if found[1]]
    bad = frame[~frame["outcome"].isin(["accepted", "complete"])]
    if len(bad):
        rows = [[f"<td class=number>{run}</td>", escaped(row["outcome"]), escaped(row["reason"]), f"<code>{escaped(row['command'])}</code>"]
                for run, row in bad.head(MOST_ROWS).iterrows()]
        more = f"<p>and {len(bad) - MOST_ROWS} more in campaign.parquet</p>" if len(bad) > MOST_ROWS else ""
        body.append(f"<h2>Runs that were not accepted</h2><details><summary>{len(bad)} runs, and the command that repeats each</summary>"
                    + table(["run", "outcome", "why", "again"], rows) + more + "</details>")
    return page(f"slewlab campaign: {frame.attrs['study']}", "".join(body), STYLE)


def write_page(frame, path):
    with growing(path) as partial:
        partial.write_text(draw(frame), encoding="utf-8")
