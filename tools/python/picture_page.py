"""The pictures of a report as a page holds them: drawn points once, however many ways there are to show them, packed; and the
script that unpacks, chooses by the window's width and by the reader's light or dark, and lets no two labels overlap."""

import base64
import gzip
import html
import json
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

LIBRARY = Path(__file__).resolve().parent / "vendor" / "plotly-basic.min.js"  # scatter plots alone: a third of the whole
NARROW = 700  # [px] of a picture; below it legends stand above the rows
KEPT_BITS = 14  # of a drawn value's fraction: 3e-5 of it; a screen shows a thousandth

# Every colour of a picture that has to change on a dark page.
DARK_PALETTE = {"#222222": "#e0e0e0", "#999999": "#a0a0a0", "#eeeeee": "#30363d", "#888888": "#7d8590", "#666666": "#9aa4af",
                "#aa0000": "#ff7b72", "#C00000": "#ff7b72", "#bbbbbb": "#565d66", "#707070": "#b0b7bf", "#0072B2": "#58b0e8", "#D55E00": "#ff8f45",
                "#009E73": "#35c99c", "#8E4B9E": "#cf9ae0", "#8C564B": "#c99186", "#c44e52": "#f0797d", "#2a7f9e": "#5cb8da", "#7F7F7F": "#a8a8a8"}

STYLE = """
:root { color-scheme: light dark; }
body { font-family: Helvetica, Arial, sans-serif; color: #222; background: #fff; margin: 1.2em auto; padding: 0 .8em; }
h1 { font-size: 1.35em; margin: 0 0 .3em 0; overflow-wrap: anywhere; }
p { margin: .3em 0; color: #444; overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: .8em 0; font-size: .92em; }
th, td { text-align: left; padding: .16em 1.4em .16em 0; border-bottom: 1px solid #e4e4e4; }
th { font-weight: 600; }
.broken { color: #a40000; font-weight: 600; }
.views button { font: inherit; padding: .25em .8em; margin: .2em .4em .2em 0; border: 1px solid #999; border-radius: 4px; background: none; color: inherit; cursor: pointer; }
.views button[aria-pressed=true] { background: #0072B2; border-color: #0072B2; color: #fff; }
@media (prefers-color-scheme: dark) {
  body { color: #e0e0e0; background: #0f1419; }
  p { color: #b8c0c8; }
  th, td { border-color: #30363d; }
  .broken { color: #ff7b72; }
}
@media print { body { color: #222; background: #fff; } }
"""

SCRIPT = """<script type="application/octet-stream" id="library">{library}</script>
{figures}
<script>
(async () => {{
  const unpacked = async (id) => {{
    if (document.getElementById(id).type === "application/json") return document.getElementById(id).textContent;
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  }};
  const places = [...document.querySelectorAll(".picture")];
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const show = (place, buttons, {{series, views, palette, narrow}}) => {{
    let chosen = Object.keys(views)[0], drawn = "";
    // Legends above their rows take more lines the narrower the window: what one of them lacks is added above its row.
    const spread = (layout) => {{
      const {{legend_rooms: rooms}} = layout.meta || {{}};
      if (!rooms) return;
      const margin = {{...layout.margin}}, inner = layout.height - margin.t - margin.b, number = (row) => row ? row + 1 : "";
      const lacks = rooms.map((room, row) => {{
        const legend = place.querySelector("g.legend" + number(row));
        return legend ? Math.max(0, Math.ceil(legend.getBoundingClientRect().height) - room) : 0;
      }});
      margin.t += lacks[0];
      const more = lacks.reduce((sum, lack) => sum + lack, 0) - lacks[0];
      if (more + lacks[0] === 0) return;
      const change = {{height: layout.height + more + lacks[0], margin}};
      let moved = 0;
      for (const row of rooms.keys()) {{
        moved += row ? lacks[row] : 0;
        const domain = layout["yaxis" + number(row)].domain.map((share) => 1 - (inner * (1 - share) + moved) / (inner + more));
        change["yaxis" + number(row) + ".domain"] = domain;
        change["legend" + number(row) + ".y"] = domain[1];
      }}
      place.style.minHeight = change.height + "px";
      return Plotly.relayout(place, change);
    }};
    const draw = () => {{
      const slim = place.clientWidth < narrow;
      const name = slim && views[chosen].instead ? views[chosen].instead : chosen;
      const isDark = dark.matches && !matchMedia("print").matches;
      const what = [name, slim, isDark, place.clientWidth].join();
      if (what === drawn) return;
      drawn = what;
      let text = JSON.stringify({{traces: views[name].traces, layout: views[name][slim ? "narrow" : "wide"]}});
      if (isDark) for (const [light, other] of Object.entries(palette)) text = text.replaceAll(light, other);
      const {{traces, layout}} = JSON.parse(text);
      // Where legends stand above the rows, one run's entries stand for all that have the like.
      if (slim) for (const trace of traces) if (trace.meta && trace.meta.is_told) trace.showlegend = false;
      // Of names of modes whose lines are nearer than a line of text, the first stays; the lines stay.
      const last = {{}};
      layout.annotations = (layout.annotations || []).filter((each) => {{
        if (each.name !== "mode") return true;
        const width = place.clientWidth - layout.margin.l - layout.margin.r;
        const axis = layout["xaxis" + each.xref.slice(1)];
        const at = width * (axis.domain[1] - axis.domain[0]) * (each.x - axis.range[0]) / (axis.range[1] - axis.range[0]);
        const free = !(at - last[each.xref] < 12);
        if (free) last[each.xref] = at;
        return free && at > 12;
      }});
      place.style.minHeight = layout.height + "px";
      for (const button of buttons) {{
        button.setAttribute("aria-pressed", button.value === name);
        button.hidden = slim && !!views[button.value].instead;
      }}
      Plotly.react(place, traces.map((trace) => ({{...series[trace.series], ...trace}})), layout, {{responsive: true, displayModeBar: slim ? false : undefined}})
        .then(() => {{ if (what === drawn) return spread(layout); }})
        .then(() => {{ if (what === drawn) place.dataset.drawn = name; }});
    }};
    for (const button of buttons) button.addEventListener("click", () => {{ chosen = button.value; draw(); }});
    dark.addEventListener("change", draw);
    addEventListener("resize", draw);
    draw();
  }};
  try {{
    const script = document.createElement("script");
    script.textContent = await unpacked("library");
    document.head.appendChild(script);
    const told = JSON.parse(await unpacked("figures"));
    places.forEach((place, k) => show(place, k ? [] : [...document.querySelectorAll(".views button")], told[k]));
  }} catch (error) {{
    for (const place of places) place.textContent = "The picture needs a browser of 2023 or later: " + error;
  }}
}})();
</script>"""


def rounded(values):
    """Single precision with so many bits as a drawn point needs; the rest is zero, and packs to nothing."""
    bits = np.array(values, np.float32).view(np.uint32)
    dropped = 23 - KEPT_BITS
    finite = (bits & 0x7F800000) != 0x7F800000
    bits[finite] = (bits[finite] + (1 << (dropped - 1))) & ~np.uint32((1 << dropped) - 1)
    return bits.view(np.float32)


def encoded(values, dtype):
    return {"dtype": dtype, "bdata": base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()}


def series_of(x, y):
    """What is drawn of a trace; times on an even grid as their beginning and step."""
    x, y = np.asarray(x, float), np.asarray(y)
    drawn = {"y": encoded(rounded(y), "f4")}
    if len(x) > 2:
        step = (x[-1] - x[0]) / (len(x) - 1)
        if step > 0 and np.max(np.abs(x - x[0] - step * np.arange(len(x)))) < 1e-3 * step:
            return drawn | {"x0": round(float(x[0]), 9), "dx": round(float(step), 12)}
    return drawn | {"x": encoded(x.astype(np.float32), "f4")}


def views_of(figures):
    """{name: (wide figure, narrow figure, name of the view in its place where there is no room)} as the script reads it."""
    pool, series, views = {}, [], {}
    for name, (wide, narrow, instead) in figures.items():
        traces = []
        for trace in wide.data:
            style = trace.to_plotly_json()
            if trace.type not in ("scatter", "scattergl"):
                traces.append(json.loads(go.Figure(trace).to_json())["data"][0])
                continue
            x, y = np.asarray(style.pop("x")), np.asarray(style.pop("y"))
            key = (x.tobytes(), y.tobytes())
            if key not in pool:
                pool[key] = len(series)
                series.append(series_of(x, y))
            traces.append(style | {"series": pool[key]})
        views[name] = {"traces": traces, "instead": instead}
        for width, fig in (("wide", wide), ("narrow", narrow)):
            layout = json.loads(fig.to_json())["layout"]
            layout.pop("template", None)
            views[name][width] = layout
    return {"series": series, "views": views, "palette": DARK_PALETTE, "narrow": NARROW}


def packed(text):
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()


def unpacked(page, name="figures"):
    """What a page holds packed, for those who look into one: `figures` or `library`."""
    begin = page.index(f'id="{name}">') + len(f'id="{name}">')
    if page[:begin].endswith('type="application/json" id="figures">'):
        return page[begin:page.index("<", begin)]
    return gzip.decompress(base64.b64decode(page[begin:page.index("<", begin)])).decode()


def drawing(told, is_basic=True, is_packed=True):
    """The script that draws what views_of() told into the page's elements of class `picture`, in their order. Not packed, its
    words are found by whoever searches the file."""
    library = LIBRARY.read_text(encoding="utf-8") if is_basic else get_plotlyjs()
    text = json.dumps(told, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    figures = (f'<script type="application/octet-stream" id="figures">{packed(text)}</script>' if is_packed
               else '<script type="application/json" id="figures">' + text.replace("<", "\\u003c") + "</script>")
    return SCRIPT.format(library=packed(library), figures=figures)


def picture(figures, remark="", is_packed=True):
    """One picture that may be shown in several ways: buttons where there are, and the drawing."""
    buttons = "".join(f'<button type="button" value="{html.escape(name)}">{html.escape(name)}</button>' for name in figures)
    height = next(iter(figures.values()))[0].layout.height
    return ((f'<div class="views">{buttons}{html.escape(remark)}</div>\n' if len(figures) > 1 else "")
            + f'<div class="picture" id="picture" style="min-height: {height}px"></div>\n' + drawing([views_of(figures)], is_packed=is_packed))


def pictures(figures):
    """Figures below each other, in the colours of the page; a pair of figures is one for wide and one for narrow windows. Clouds
    of points and maps of colour take the whole library."""
    pairs = [fig if isinstance(fig, tuple) else (fig, fig) for fig in figures]
    for fig in (fig for pair in pairs for fig in pair):
        # Titles stand on the left, legends on the right.
        fig.update_layout(title={"x": 0.0, "xref": "paper", "xanchor": "left"}, template="plotly_white", paper_bgcolor="rgba(0,0,0,0)",
                          plot_bgcolor="rgba(0,0,0,0)", font={"color": "#222222"},
                          modebar={"bgcolor": "rgba(0,0,0,0)", "color": "#999999", "activecolor": "#0072B2"})
        fig.update_xaxes(gridcolor="#eeeeee", zerolinecolor="#666666")
        fig.update_yaxes(gridcolor="#eeeeee", zerolinecolor="#666666")
    # What is laid out for a page's width alone is scrolled in a narrower window.
    places = "".join(f'<div class="wide"><div class="picture" style="{f"min-width: {NARROW}px; " if wide is narrow else ""}min-height: {wide.layout.height or 450}px"></div></div>\n'
                     for wide, narrow in pairs)
    return places + drawing([views_of({"picture": (wide, narrow, None)}) for wide, narrow in pairs],
                            all(trace.type in ("scatter", "bar") for wide, _ in pairs for trace in wide.data), is_packed=False)
