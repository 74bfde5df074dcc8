"""Turns what tools/benchmark measured into the tables of docs/benchmarks.md and a drawing.

Usage: report.py FOLDER
Reads FOLDER/elements.json and plant.json (Google Benchmark), the turns turn*_plant.json with turn*_mujoco.json, lockstep.txt,
realtime.txt, batch.md and diagnosis.json, the last five where present; writes FOLDER/table.md and FOLDER/cost_over_elements.svg. Costs
are CPU time, medians over the repetitions; ratios to MuJoCo are medians over the turns, in which the two follow each other.
"""

import glob
import json
import math
import os
import statistics
import sys

LIMIT_NS = 150  # a plant step of 6 elements, project requirement
LIMIT_MUJOCO = 35  # times MuJoCo's step, project requirement
DIAGNOSIS_LIMITS = {"1 kHz": 15.0, "100 Hz": 5.0}  # [s] of two logs of 30 s on two cores, project requirement
FORECAST_LIMIT = 1.5  # factor by which the forecast of a diagnosis's end may be off, project requirement


def read_plant(path):
    """{name: {field: median over repetitions}}; times in ns."""
    measured = read_json(path)
    unit = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
    rows = {}
    for entry in measured["benchmarks"]:
        if entry.get("run_type") != "iteration":
            continue
        fields = {key: value for key, value in entry.items() if isinstance(value, float)}
        fields["cpu_time"] = entry["cpu_time"] * unit[entry["time_unit"]]
        rows.setdefault(entry["run_name"], []).append(fields)
    medians = {name: {key: statistics.median(run[key] for run in runs) for key in runs[0]}
               for name, runs in rows.items()}
    return measured["context"], medians


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def cost_at_error(points, error):
    """CPU time at which the curve through (error, time) reaches `error`, straight in logarithms."""
    points = sorted(points, reverse=True)
    for (e1, t1), (e2, t2) in zip(points, points[1:]):
        if e1 >= error >= e2:
            share = math.log(e1 / error) / math.log(e1 / e2)
            return math.exp((1 - share) * math.log(t1) + share * math.log(t2))
    return None


def line_fit(points):
    """a, b of cost = a + b n with the least relative error, and the largest relative miss."""
    sw = swx = swy = swxx = swxy = 0.0
    for x, y in points:
        w = 1 / y**2
        sw, swx, swy, swxx, swxy = sw + w, swx + w * x, swy + w * y, swxx + w * x * x, swxy + w * x * y
    b = (sw * swxy - swx * swy) / (sw * swxx - swx**2)
    a = (swy - b * swx) / sw
    return a, b, max(abs(a + b * x - y) / y for x, y in points)


def exponent(points):
    """Slope of log cost over log elements, least squares."""
    xs = [math.log(x) for x, _ in points]
    ys = [math.log(y) for _, y in points]
    mx, my = statistics.mean(xs), statistics.mean(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


def drawing(points, a, b, mujoco_ns):
    """SVG: cost of a step over elements, both linear, with the fitted line and MuJoCo's step."""
    width, height, left, bottom, top, right = 760, 440, 80, 60, 40, 30
    most_x, most_y = 68, 1.1 * max(max(y for _, y in points), a + b * 64)

    def at(x, y):
        return (left + x / most_x * (width - left - right),
                height - bottom - y / most_y * (height - bottom - top))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
           f'font-size="13"><rect width="{width}" height="{height}" fill="white"/>'
           f'<text x="{left}" y="24" font-size="15">Cost of one plant step over boom elements '
           f'(2 groups, load, play being crossed)</text>']
    x0, y0 = at(0, 0)
    x1, y1 = at(most_x, most_y)
    out.append(f'<path d="M{x0} {y1} V{y0} H{x1}" fill="none" stroke="black"/>')
    spacing = 10 ** math.floor(math.log10(most_y / 2))
    spacing *= 2 if most_y / spacing > 10 else 1
    value = 0
    while value <= most_y:
        x, y = at(0, value)
        out.append(f'<path d="M{x} {y} H{x1}" stroke="#dddddd"/>'
                   f'<text x="{x - 8}" y="{y + 4}" text-anchor="end">{value / 1000:g}</text>')
        value += spacing
    for n in (0, 8, 16, 24, 32, 40, 48, 56, 64):
        x, y = at(n, 0)
        out.append(f'<text x="{x}" y="{y + 18}" text-anchor="middle">{n}</text>')
    out.append(f'<text x="{(x0 + x1) / 2}" y="{height - 14}" text-anchor="middle">boom elements</text>'
               f'<text x="20" y="{(y0 + y1) / 2}" transform="rotate(-90 20 {(y0 + y1) / 2})" '
               f'text-anchor="middle">µs per step of 1 ms</text>')
    (lx0, ly0), (lx1, ly1) = at(0, a), at(64, a + b * 64)
    out.append(f'<path d="M{lx0} {ly0} L{lx1} {ly1}" stroke="#1f77b4" fill="none"/>'
               f'<text x="{lx1 - 8}" y="{(ly1 + y0) / 2}" text-anchor="end" fill="#1f77b4">'
               f'{a:.0f} ns + {b:.1f} ns per element</text>')
    for x, y in points:
        px, py = at(x, y)
        out.append(f'<circle cx="{px}" cy="{py}" r="4" fill="#1f77b4"/>')
    if mujoco_ns:
        out.append(f'<text x="{left + 12}" y="{top + 20}" fill="#d62728">MuJoCo, 6 elements: '
                   f'{mujoco_ns / 1000:.1f} µs' + (", off the chart" if mujoco_ns > most_y else "") + "</text>")
        if mujoco_ns <= most_y:
            px, py = at(6, mujoco_ns)
            out.append(f'<circle cx="{px}" cy="{py}" r="4" fill="#d62728"/>')
    return "".join(out) + "</svg>\n"


def diagnosis_lines(rows, verdict):
    """Of two logs of 30 s each, the whole catalogue and pairs, two threads."""
    lines = ["| two logs of 30 s, whole catalogue and pairs, two threads | wall | asked | processor | simulations | simulated s per s of "
             "wall | processor time of a simulated s, of the bare machine's | forecast of the end within a factor of (asked: "
             f"{FORECAST_LIMIT:g}) |", "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        limit = next(limit for rate, limit in DIAGNOSIS_LIMITS.items() if rate in row["case"])
        lines.append(f"| {row['case']} | {row['wall_s']:.1f} s | ≤ {limit:g} s: {verdict(row['wall_s'] <= limit)} | {row['processor_s']:.1f} s "
                     f"| {row['simulations']} | {row['simulated_s_per_s']:.0f} | {row['of_bare_machine']:.2f} "
                     f"| {row['worst_forecast']:.2f}: {verdict(row['worst_forecast'] <= FORECAST_LIMIT)} |")
    return lines


def main(folder):
    context, plant = read_plant(os.path.join(folder, "plant.json"))
    elements = read_plant(os.path.join(folder, "elements.json"))[1]
    turns = []  # (plant's rows, MuJoCo's result)
    for path in sorted(glob.glob(os.path.join(folder, "turn*_plant.json"))):
        partner = path.replace("_plant.json", "_mujoco.json")
        turns.append((read_plant(path)[1], read_json(partner) if os.path.exists(partner) else None))
    points = sorted((int(name.split(":")[1].split("/")[0]), row["cpu_time"])
                    for name, row in elements.items())
    a, b, miss = line_fit(points)

    def over_turns(name, field):
        return statistics.median(next(row for key, row in rows.items() if key.startswith(name))[field]
                                 for rows, _ in turns)

    six = over_turns("plant_step/elements:6", "cpu_time")
    spread = {field: over_turns("plant_step_distribution", field)
              for field in ("median_ns", "p99_ns", "median_with_change_ns", "share_with_change")}
    mujoco = turns[0][1]
    mujoco_ns = statistics.median(other["step_ns"] for _, other in turns) if mujoco else None
    demo = plant["demo_plant"]
    curve = {kind: [(row["error"], row["cpu_time"]) for name, row in plant.items()
                    if name.startswith(f"demo_{kind}/")] for kind in ("cvode", "arkode")}

    def verdict(met):
        return "met" if met else "missed"

    lines = [f"Measured on {context['num_cpus']} cores, load average "
             f"{context['load_avg'][0]:.1f} at the start.", "",
             "| what | figure | aim |", "|---|---|---|",
             f"| plant step, 6 elements, play being crossed: median of single steps | "
             f"{spread['median_ns']:.0f} ns | ≤ {LIMIT_NS} ns: {verdict(spread['median_ns'] <= LIMIT_NS)} |",
             f"| the same, mean over all steps, contact changes included | {six:.0f} ns | |",
             f"| the same, 99 % of steps below | {spread['p99_ns']:.0f} ns | |",
             f"| a step in which a contact changes ({100 * spread['share_with_change']:.1f} % of them), median | "
             f"{spread['median_with_change_ns'] / 1000:.1f} µs | |",
             f"| cost over 2…64 elements | {a:.0f} ns + {b:.1f} ns per element (within {100 * miss:.0f} %), "
             f"grows with the power {exponent(points):.2f} | ≤ 1: {verdict(exponent(points) <= 1.0)} |"]
    for kind, title in (("cvode", "SUNDIALS CVODE"), ("arkode", "SUNDIALS ARKODE")):
        cost = cost_at_error(curve[kind], demo["error"])
        if cost is None:
            best = min(curve[kind])
            lines.append(f"| {title}, 60 s demo: no tolerance tried reaches the plant's error; at {best[0]:.1e} | "
                         f"{best[1] / demo['cpu_time']:.0f} times the plant's time | |")
        else:
            lines.append(f"| {title} at equal accuracy (tip acceleration {demo['error']:.1e} RMS, 60 s demo) | "
                         f"{cost / 1e6:.0f} ms against {demo['cpu_time'] / 1e6:.1f} ms: "
                         f"{cost / demo['cpu_time']:.0f} times slower | |")
    if mujoco:
        ratios = [other["step_ns"] / rows["plant_step/elements:6"]["cpu_time"] for rows, other in turns]
        ratio = statistics.median(ratios)
        lines.append(f"| MuJoCo {mujoco['version']}, same crane, {mujoco['degrees_of_freedom']} degrees of freedom, "
                     f"mean step | {mujoco_ns / 1000:.1f} µs: {ratio:.0f} times slower than the plant's mean step "
                     f"({min(ratios):.0f}…{max(ratios):.0f} over {len(ratios)} turns) | ≥ {LIMIT_MUJOCO}: "
                     f"{verdict(ratio >= LIMIT_MUJOCO)} |")
    else:
        lines.append(f"| MuJoCo | not at hand (`pip install mujoco` failed) | ≥ {LIMIT_MUJOCO} |")
    for name, title in (("reference_16_elements/dirk:0", "CVODE"), ("reference_16_elements/dirk:1", "ARKODE")):
        lines.append(f"| reference by {title}, 16 elements, 60 s read every ms, tolerance 1e-8 | "
                     f"{plant[name]['cpu_time'] / 1e9:.2f} s | ≤ 2 s: "
                     f"{verdict(plant[name]['cpu_time'] <= 2e9)} |")
    lines += ["", "| elements | " + " | ".join(str(n) for n, _ in points) + " |",
              "|---|" + "---|" * len(points),
              "| ns per step | " + " | ".join(f"{cost:.0f}" for _, cost in points) + " |",
              "", "| integrator of the demo | error | CPU time |", "|---|---|---|",
              f"| plant, 1 ms | {demo['error']:.1e} | {demo['cpu_time'] / 1e6:.1f} ms |"]
    for kind in ("cvode", "arkode"):
        for error, cost in sorted(curve[kind], reverse=True):
            lines.append(f"| {kind.upper()} | {error:.1e} | {cost / 1e6:.0f} ms |")
    if mujoco:
        listed = ", ".join(f"{f:g}" for f in mujoco["frequencies_hz"][1:8])
        lines += ["", f"The MuJoCo crane's frequencies with the gears closed: {listed} Hz."]
    diagnosis = os.path.join(folder, "diagnosis.json")
    if os.path.exists(diagnosis):
        lines += [""] + diagnosis_lines(read_json(diagnosis), verdict)
    for name in ("lockstep.txt", "realtime.txt"):
        if os.path.exists(os.path.join(folder, name)):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                lines += ["", "```", file.read().rstrip(), "```"]
    batch = os.path.join(folder, "batch.md")
    if os.path.exists(batch):
        with open(batch, encoding="utf-8") as file:
            lines += ["", "### Machines side by side", "", file.read().rstrip()]
    text = "\n".join(lines) + "\n"
    with open(os.path.join(folder, "table.md"), "w", encoding="utf-8") as file:
        file.write(text)
    with open(os.path.join(folder, "cost_over_elements.svg"), "w", encoding="utf-8") as file:
        file.write(drawing(points, a, b, mujoco_ns))
    print(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
