"""Writes an import map to begin with (docs/import.md) out of the header of the data: `slewlab new map MAP.yaml --data FILE.csv`.

What a column is, its unit and its sign are guessed, and every guess is marked as one. The map is one that `slewlab check`
takes; a signal for which no column was found has a name to be replaced.
"""

import csv
import re
import signal
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from arguments import ArgumentParser
from import_map import FLAGS, MOST_GROUPS
from unit import factor_to_si, quantity_of

ROWS_LOOKED_AT = 20_000
OF_ROUNDING = 1e-9  # of the largest value: less than that a difference of decimal numbers does not tell
OF_RATED_TORQUE = 'scale: {value: 1, unit: "-", source: "REPLACE: N m per motor that 1 % is, a hundredth of the torque that the drive calls rated"}'
GRAVITY = 'scale: {value: 9.80665, unit: "-", source: "the column is in g; standard gravity"}'

# Signal: quantities of its unit, words of its name; of the first that fits, the column with most words in its name.
SIGNALS = {
    "time": (("time",), ("time", "zeit", "timestamp", "stamp", "date")),
    "shaft_position": (("angle", "length"), ("position", "pos", "encoder", "enc", "angle", "winkel", "weg")),
    "shaft_speed": (("angular speed", "speed"), ("speed", "velocity", "vel", "drehzahl", "rpm")),
    "motor_torque": (("torque", "force", "number"), ("torque", "moment", "drehmoment", "force", "kraft")),
    "tip_acceleration": (("acceleration",), ("tip", "spitze")),
    "middle_acceleration": (("acceleration",), ("middle", "mid", "mitte")),
    "pivot_acceleration": (("acceleration",), ("pivot", "foot")),
    "house_acceleration": (("acceleration",), ("house", "cabin", "cab")),
    "slew_angle": (("angle",), ("slew", "gyro", "yaw", "heading")),
    "speed_request": (("number",), ("request", "joystick", "lever", "setpoint", "reference", "ref", "soll", "sollwert", "hebel")),
    "emergency_stop": ((), ("emergency", "estop", "stop", "not", "aus", "halt", "notaus", "nothalt")),
    "enable": ((), ("enable", "enabled", "freigabe", "freigegeben")),
    "brake": ((), ("brake", "brakes", "bremse", "bremsen")),
}
OF_AN_OPEN_BRAKE = {"open", "opened", "release", "released", "lift", "lifted", "offen", "auf", "frei", "gelüftet", "lüften"}
OF_EVERY_GROUP = ("shaft_position", "shaft_speed", "motor_torque")  # a column for each motor group
NEEDED = {"time": "s", "shaft_position": "rad", "shaft_speed": "rad/s", "motor_torque": "N m"}
OTHER_SPELLINGS = {"nm": "N m", "knm": "kN m", "degree": "deg", "degrees": "deg", "sec": "s", "seconds": "s", "1/min": "rpm", "u/min": "rpm",
                   "percent": "%", "g": None}


def words_of(name):
    """Its words and its numbers, what stands in brackets left out."""
    bare = re.sub(r"[\[(].*?[\])]", " ", name)
    bare = re.sub(r"([a-z])([A-Z])", r"\1 \2", bare)
    return re.findall(r"[^\W\d_]+|\d+", bare.lower())


def unit_in(name):
    """The unit that a column's name says, in brackets or behind the last underscore."""
    found = said_in_brackets(name)
    said = found or re.split(r"[_ ]", name)[-1]
    with_powers = re.sub(r"(?<=[A-Za-z])([234])\b", r"^\1", said)  # m/s2
    for spelling in (said, with_powers, OTHER_SPELLINGS.get(said.replace(" ", "").lower())):
        if spelling and quantity_of(spelling) and (found or spelling != "-"):
            return spelling
    return None


def said_in_brackets(name):
    found = re.search(r"[\[(]([^\])]+)[\])]", name)
    return found.group(1).strip() if found else ""


def words_fit(wanted, name):
    """How many words of the column's name are the signal's."""
    hits = sum(word in SIGNALS[wanted][1] for word in words_of(name))
    return hits + 1 if wanted == "time" and name.strip().lower() == "t" else hits


def score(wanted, name, unit):
    """How well a column fits a signal: 0 not at all."""
    quantities = SIGNALS[wanted][0]
    quantity = quantity_of(unit) if unit else None
    if quantity and quantity not in (quantities or ("number",)):
        return 0
    hits = words_fit(wanted, name)
    if wanted == "motor_torque" and quantity == "number":  # in per cent of the rated torque, where its name says that it is one
        return 2 * hits if unit == "%" else 0
    known = 1 if quantity and quantity in quantities and wanted in ("time", "shaft_position", "shaft_speed", "motor_torque") else 0
    return 2 * hits + known if hits else known


def groups_of(name, columns):
    """{number: column} of the columns that are called as this one but for a number: one for each motor group. None in place of the number
    where there is no other."""
    pattern, numbers = [], {}
    for column in columns:
        words = words_of(column)
        masked = ["#" if word.isdigit() else word for word in words]
        if column == name:
            pattern = masked
        numbers[column] = (masked, [int(word) for word in words if word.isdigit()])
    alike = {column: found for column, (masked, found) in numbers.items() if masked == pattern}
    for place in reversed(range(pattern.count("#"))):
        found = {numbers[place]: column for column, numbers in alike.items()}
        if 1 < len(found) == len(alike) <= MOST_GROUPS:
            return dict(sorted(found.items()))
    return {None: name}


def guess(names):
    """{signal: {group's number, or None: (column, unit or None)}}; every column once, the best fit first."""
    units = {name: unit_in(name) for name in names}
    fits = sorted(((score(wanted, name, units[name]), -place, wanted, name) for wanted in SIGNALS for place, name in enumerate(names)),
                  reverse=True)
    found, used = {}, set()
    for how_well, _, wanted, name in fits:
        if how_well == 0 or wanted in found or name in used:
            continue
        free = [other for other in names if other not in used and score(wanted, other, units[other]) > 0]
        columns = groups_of(name, free) if wanted in OF_EVERY_GROUP else {None: name}
        found[wanted] = {group: (column, units[column]) for group, column in columns.items()}
        used |= set(columns.values())
    return found


def in_groups(found):
    """[{signal: (column, unit)}], one per motor group, of what was guessed. A column without a number is the first group's."""
    of_groups = {name: found.get(name, {}) for name in OF_EVERY_GROUP}
    numbers = sorted({number for columns in of_groups.values() for number in columns if number is not None}) or [None]
    first = numbers[0]
    return [{name: columns.get(number, columns.get(None) if number == first else None) for name, columns in of_groups.items()} for number in numbers]


def layout(path):
    """Separator, decimal comma and lines above the header of a CSV."""
    with open(path, encoding="utf-8-sig", newline="") as stream:
        lines = [stream.readline() for _ in range(20)]
    separator = max(";\t,", key=lambda each: max((line.count(each) for line in lines), default=0))
    widest = max(line.count(separator) for line in lines)
    skip = next(i for i, line in enumerate(lines) if line.count(separator) == widest)
    numbers = lines[skip + 1] if skip + 1 < len(lines) else ""
    return separator, "," if separator != "," and re.search(r"\d,\d", numbers) else ".", skip


def read_beginning(path):
    if path.suffix == ".parquet":
        return pd.read_parquet(path).head(ROWS_LOOKED_AT), ""
    separator, decimal, skip = layout(path)
    table = pd.read_csv(path, sep=separator, decimal=decimal, skiprows=skip, nrows=ROWS_LOOKED_AT, skipinitialspace=True, encoding="utf-8-sig")
    table.columns = [str(name).strip() for name in table.columns]
    said = {"\t": "tab"}.get(separator, separator)
    if (separator, decimal, skip) == (",", ".", 0):
        return table, ""
    return table, f'csv: {{separator: "{said}", decimal: "{decimal}", skip_lines: {skip}}}\n'


def signs_agree(table, position, speed):
    """Whether the speed is the position's, and not its negative; None where the data do not show it."""
    try:
        places, speeds = table[position].to_numpy(float), table[speed].to_numpy(float)
    except (ValueError, TypeError):
        return None
    moved, fast = np.diff(places), speeds[1:]
    both = np.isfinite(moved) & np.isfinite(fast)
    if both.sum() < 3:
        return None
    moved, fast = moved[both], fast[both]
    if fast.min() < 0.0 < fast.max():  # an offset of either says nothing of the sign where the motion goes both ways
        moved, fast = moved - moved.mean(), fast - fast.mean()
    if np.abs(moved).max() <= OF_ROUNDING * np.nanmax(np.abs(places)) or np.abs(fast).max() <= OF_ROUNDING * np.nanmax(np.abs(speeds)):
        return None
    correlation = np.sum(moved * fast) / np.sqrt(np.sum(moved**2) * np.sum(fast**2))
    return None if abs(correlation) < 0.3 else bool(correlation > 0.0)


def flag_values(column):
    """What a column of 0 and 1 alone holds; nothing of any other."""
    try:
        values = column.dropna().to_numpy(float)
    except (ValueError, TypeError):
        return []
    return values if set(values) <= {0.0, 1.0} else []


def why_inverted(name, column, values):
    """Why a flag stands for what it says where the column is 0; empty where it is so at 1."""
    if name == "emergency_stop" and len(values) and values[0] == 1.0:  # as the contacts of an emergency stop do
        return "pressed where it is 0, since it begins at 1"
    if name == "brake" and OF_AN_OPEN_BRAKE.intersection(words_of(column)):
        return "on where it is 0, since its name says that it is open at 1"
    return ""


def quoted(name):
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'


def map_text(path):
    table, csv_line = read_beginning(path)
    names = [str(name) for name in table.columns]
    guessed = {name: columns for name, columns in guess(names).items()
               if name not in ("enable", "brake") or len(flag_values(table[columns[None][0]]))}
    groups = in_groups(guessed)
    found = {name: columns[None] for name, columns in guessed.items() if name not in OF_EVERY_GROUP}
    lines = [f"# An import map for {path.name} (docs/import.md). What is marked as a guess is one: look at each.",
             "#", f"#   slewlab import --map THIS_FILE {path.name}", "kind: import_map", f"description: replace by what {path.name} records", ""]
    if csv_line:
        lines.append(csv_line + "")

    def entry(name, guessed_column, more=(), missing=None):
        column, unit = guessed_column or (missing or f"REPLACE_{name}", None)
        remarks = []
        if not guessed_column:
            remarks.append("no column was found")
        else:
            by = ["name"] * (words_fit(name, column) > 0) + ["unit"] * bool(unit)
            remarks.append("guess: column, by its " + " and ".join(by))
        parts = [f"column: {quoted(column)}"]
        if name in FLAGS:
            why = why_inverted(name, column, flag_values(table[column]))
            if why:
                parts.append("inverted: true")
                remarks.append(f"guess: {why}")
        else:
            if not unit:
                unit = NEEDED.get(name, {"tip": "m/s^2", "mid": "m/s^2", "piv": "m/s^2", "hou": "m/s^2", "sle": "rad"}.get(name[:3], "-"))
                said = said_in_brackets(column)
                remarks.append(f"guess: unit, the usual one: '{said}' is none that is known here" if said else "guess: unit, the usual one")
                if said == "g" and name.endswith("_acceleration"):
                    more = (*more, GRAVITY)
                    remarks[-1] = "guess: in g, the acceleration of gravity"
            if name == "motor_torque" and unit == "%":
                unit, more = "N m", (*more, OF_RATED_TORQUE)
                remarks.append("guess: in per cent of the rated torque")
            parts.append(f"unit: {quoted(unit)}")
        return parts + list(more), "; ".join(remarks)

    parts, remark = entry("time", found.get("time"))
    if "time" in found and not pd.api.types.is_numeric_dtype(table[found["time"][0]]):
        parts[1], remark = "unit: datetime", remark + "; guess: dates"
    lines += [f"# {remark}", f"time: {{{', '.join(parts)}}}", ""]
    lines.append("# One entry per motor group. ratio: motor turns per turn of the axis on which the column stands, where that is not the motor.")
    for name in OF_EVERY_GROUP:
        lines.append(f"{name}:")
        for number, group in enumerate(groups, 1):
            if name == "shaft_speed" and not group[name]:
                lines.append("  - {derive: central_difference}   # no column was found: from the position")
                continue
            more, sign = [], "guess: sign 1"
            if name == "shaft_speed" and group["shaft_position"]:
                agree = signs_agree(table, group["shaft_position"][0], group["shaft_speed"][0])
                if agree is not None:
                    sign = "guess: sign, " + ("the position's" if agree else "against the position")
                    more = [] if agree else ["sign: -1"]
            column, unit = group[name] or ("", None)
            if "slew" in words_of(column):
                more.append('ratio: {value: 1, unit: "-", source: "REPLACE: motor turns per turn of the slew axis"}')
            if unit and any(factor_to_si(quantity, unit) is not None for quantity in ("length", "speed", "force")):
                more.append('metres_per_radian: {value: 1, unit: m, source: "REPLACE: travel per radian of the motor shaft"}')
            parts, remark = entry(name, group[name], more, f"REPLACE_{name}" + (f"_{number}" if len(groups) > 1 else ""))
            lines += [f"  # {remark}; {sign}", f"  - {{{', '.join(parts)}}}"]
    lines.append("")
    for name in list(SIGNALS)[4:]:
        if name in found:
            parts, remark = entry(name, found[name])
            lines += [f"# {remark}", f"{name}: {{{', '.join(parts)}}}"]
    used = {column for columns in guessed.values() for column, _ in columns.values()}
    unused = [name for name in names if name not in used]
    if unused:
        lines += ["", "# Columns that are not used: " + ", ".join(unused)]
    return "\n".join(lines) + "\n"


def main(arguments=None):
    parser = ArgumentParser(prog="slewlab new map", description="An import map to begin with, from the header of the data.")
    parser.add_argument("map", type=Path, help="the map to write; never over one that is there")
    parser.add_argument("--data", type=Path, required=True, help="CSV with a line of column names, or Parquet")
    options = parser.parse_args(arguments)
    if options.map.exists():
        print(f"slewlab new map: {options.map}: found a file that is there, expected another name: nothing is overwritten", file=sys.stderr)
        return 2
    try:
        text = map_text(options.data)
    except (OSError, ValueError, StopIteration, csv.Error) as problem:
        print(f"slewlab new map: {options.data}: not readable as a table: {problem}", file=sys.stderr)
        return 2
    options.map.write_text(text, encoding="utf-8")
    print(f"{options.map}: written; look at the guesses, then: slewlab check {options.map}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
