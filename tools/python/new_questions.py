"""Asks for what `slewlab new` was not told, where it stands at a terminal: the kind of the file, its name, of a crane or an axis the numbers
that tell it from others, of a map the data. Enter alone takes what stands in brackets. An answer is read as `--set` reads it, by what checks
the files; a number without a unit has the one that is shown.

    new_questions.py [KIND [FILE]] [--crane MACHINE.yaml] [--controller CONTROLLER.yaml] [--data FILE.csv]
"""

import re
import subprocess
import sys
from pathlib import Path

from arguments import ArgumentParser, known_names
from core_module import core
from run_log import REPOSITORY, slewlab_program
from whole_file import growing

KINDS = ("crane", "axis", "controller", "scenario", "map")
TEMPLATES = REPOSITORY / "config" / "templates"
ANSWERED = "answered to slewlab new: replace by where the number is from"
# Key of the file, and what to ask for.
NUMBERS = {
    "crane": {"drive.groups": "motor groups", "drive.motors_per_group": "motors in each group", "drive.gearbox_ratio": "ratio of the gearbox",
              "drive.pinion_ratio": "ratio of pinion and slew ring", "drive.rated_torque": "rated torque of a motor",
              "drive.top_speed": "top speed of the slew axis", "house.inertia": "inertia of the house about the slew axis",
              "boom.length": "boom length", "boom.mass": "boom mass", "boom.angle": "boom angle above the horizontal", "load.mass": "load mass",
              "load.rope_length": "rope length"},
    "axis": {"inertia": "inertia of the axis", "motor_inertia": "inertia of the motor", "ratio": "motor turns per turn of the axis",
             "rated_torque": "rated torque of the motor", "top_speed": "top speed of the axis"},
}


class NoAnswer(Exception):
    """The terminal's input has ended."""


def ask(question, default=None):
    try:
        answer = input(f"{question}{f' [{default}]' if default else ''}: ").strip()
    except EOFError:
        raise NoAnswer from None
    return answer or default or ""


def ask_kind():
    while True:
        kind = ask(f"kind of file, one of {', '.join(KINDS)}", "crane")
        if kind in KINDS:
            return kind
        print(f"  found '{kind}', expected {known_names(kind, KINDS)}")


def ask_file(kind):
    while True:
        path = Path(ask("file to write", f"{kind}.yaml"))
        if not path.exists():
            return path
        print(f"  {path}: found a file that is there, expected another name: nothing is overwritten")


def ask_there(question, is_needed):
    """A file that is there; None where it may be left out and is."""
    while True:
        answer = ask(question)
        if not answer and not is_needed:
            return None
        if answer and Path(answer).is_file():
            return Path(answer)
        print(f"  {answer or 'nothing'}: found no file of that name")


def shown(value, unit):
    return value if unit in ("-", "") else f"{value} {unit}"


def ask_numbers(kind):
    """{key: answer}, as `--set` takes them, of those that are not the template's."""
    template, changes = TEMPLATES / f"{kind}.yaml", {}
    known = {key: (value, unit) for key, value, unit, *_ in core.file_values(template, [])}
    for key, question in NUMBERS[kind].items():
        value, unit = known[key]
        while True:
            answer = ask(question, shown(value, unit))
            if answer == shown(value, unit):
                break
            if re.fullmatch(r"[-+.\deE]+", answer):
                answer = shown(answer, unit)
            problems, warnings = core.check(template, list((changes | {key: answer}).items()))
            for line in problems or warnings:
                print(f"  {line.removeprefix('command line: ')}")
            if not problems:
                changes[key] = answer
                break
    return changes


def replaced(text, path, key, value, unit):
    """The text of a file with another value, unit and source of a key: in the line where it stands, or in those below."""
    line = next(line for name, _, _, _, _, line in core.file_values(path, []) if name == key)
    lines = text.splitlines(keepends=True)
    while not lines[line - 1].lstrip().startswith(f"{key.rpartition('.')[2]}:"):
        line -= 1  # from the value, which may stand below
    first = lines[line - 1]
    depth = len(first) - len(first.lstrip())
    last = line
    while "{" not in first and last < len(lines) and len(lines[last]) - len(lines[last].lstrip()) > depth:
        last += 1
    entry = "".join(lines[line - 1:last])
    for name, new in (("value", value), ("unit", f'"{unit}"' if unit == "-" else unit), ("source", f'"{ANSWERED}"')):
        entry, count = re.subn(rf'(?<=[\s{{]){name}: ("[^"]*"|[^,}}\n]*)', lambda found, name=name, new=new: f"{name}: {new}", entry, count=1)
        if count != 1:
            raise ValueError(f"{path}:{line}: no {name} of {key}")
    return "".join(lines[:line - 1]) + entry + "".join(lines[last:])


def machine_text(kind):
    template = TEMPLATES / f"{kind}.yaml"
    changes = ask_numbers(kind)
    text = template.read_text(encoding="utf-8")
    told = {key: (value, unit) for key, value, unit, *_ in core.file_values(template, list(changes.items()))}
    for key in changes:
        text = replaced(text, template, key, *told[key])
    return text


def main(arguments):
    parser = ArgumentParser(prog="slewlab new", description="Asks for what a new file is to be.")
    parser.add_argument("kind", nargs="?")
    parser.add_argument("file", nargs="?", type=Path)
    parser.add_argument("--crane", type=Path)
    parser.add_argument("--controller", type=Path)
    parser.add_argument("--data", type=Path)
    options = parser.parse_args(arguments)
    if options.kind and options.kind not in KINDS:
        print(f"KIND: found '{options.kind}', expected {known_names(options.kind, KINDS)}", file=sys.stderr)
        return 2
    try:
        kind = options.kind or ask_kind()
        path = options.file or ask_file(kind)
        if kind in NUMBERS and not (options.crane or options.controller or options.data):
            text = machine_text(kind)
            path.parent.mkdir(parents=True, exist_ok=True)
            with growing(path) as partial:
                partial.write_text(text, encoding="utf-8")
            print(f"{path}: written; fill it in, then: slewlab check {path}")
            return 0
        words = [str(slewlab_program()), "new", kind, str(path)]
        if kind in ("controller", "scenario"):
            options.crane = options.crane or ask_there("file of its crane or axis (Enter: the one that comes with slewlab)", False)
        if kind == "scenario":
            options.controller = options.controller or ask_there("file of its controller (Enter: the one that comes with slewlab)", False)
        if kind == "map":
            options.data = options.data or ask_there("data that it is for, CSV or Parquet", True)
    except NoAnswer:
        print("\nended before all was answered; nothing was written", file=sys.stderr)
        return 2
    for name in ("crane", "controller", "data"):
        words += [f"--{name}", str(getattr(options, name))] if getattr(options, name) else []
    return subprocess.run(words, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
