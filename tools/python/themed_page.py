"""The frame of a page that stands alone: light or dark as the reader has it, readable on a telephone and on paper."""

import html

STYLE = """
:root {
  color-scheme: light dark;
  --ground: #ffffff; --panel: #f4f5f7; --text: #1d2126; --faint: #5d6670; --line: #d3d7dc; --grid: #e6e8eb;
  --good: #1c7c3c; --warn: #9a5b00; --bad: #b3141d; --accent: #1557a8;
}
@media (prefers-color-scheme: dark) { :root {
  --ground: #14171a; --panel: #1e2226; --text: #e6e9ec; --faint: #a3acb5; --line: #3a4047; --grid: #2a2f35;
  --good: #57c27a; --warn: #e6a94a; --bad: #ff7b7b; --accent: #6cb0ff;
} }
@media print { :root {
  --ground: #ffffff; --panel: #ffffff; --text: #000000; --faint: #444444; --line: #999999; --grid: #dddddd;
  --good: #1c7c3c; --warn: #9a5b00; --bad: #b3141d; --accent: #1557a8;
} }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1em; max-width: 1240px; background: var(--ground); color: var(--text);
  font: 15px/1.45 system-ui, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.4em; margin: .2em 0 .4em; overflow-wrap: anywhere; } h2 { font-size: 1.1em; margin: 1.8em 0 .5em; }
h3 { font-size: 1em; margin: 1.2em 0 .3em; }
p { margin: .4em 0; max-width: 80ch; } .faint { color: var(--faint); } .small { font-size: .88em; }
.good { color: var(--good); } .bad { color: var(--bad); } .warn { color: var(--warn); }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: .93em; }
th, td { padding: .25em .8em .25em 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { font-weight: 600; } td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
code { font-size: .9em; overflow-wrap: anywhere; }
a { color: var(--accent); }
"""


def escaped(words):
    return html.escape(str(words))


def printed(unit):
    """A unit as people read it: m/s² of m/s^2, which files and tables have."""
    return unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


def table(heads, rows):
    """`rows`: lists of cells in HTML; one that begins with <td stands as it is."""
    head = "".join(f"<th scope=col>{each}</th>" for each in heads)
    body = "".join("<tr>" + "".join(cell if cell.startswith("<td") else f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<div class=wide><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"


def page(title, body, style=""):
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escaped(title)}</title><style>{STYLE}{style}</style></head><body>
{body}
</body></html>
"""
