"""Writes what the commands of the Python side take, for manual pages and completion: `describe_commands.py OUT.json`. It is what their
--help says, {command: [[name, description, whether it stands without a name]]}, of the very parser that reads them."""

import importlib
import json
import sys

import arguments
from whole_file import growing

# As main.cpp has them.
PROGRAMS = {"report": ["report"], "campaign": ["campaign_command"], "desk": ["desk_command"], "bridge": ["bridge", "plc_bridge"],
            "soft-plc": ["soft_plc"], "export": ["export"], "import": ["import_data"]}


class Described(Exception):
    """In place of the command's work."""


def describe(parser, *_):
    raise Described(parser)


def options_of(parser):
    for action in parser._actions:  # argparse has no other list of them
        is_positional = not action.option_strings
        values = action.metavar or ("|".join(map(str, action.choices)) if action.choices else action.dest.upper())
        name = values if is_positional else ",".join(action.option_strings)
        description = (action.help or "").replace("%(default)s", str(action.default)).replace("%%", "%")
        yield [name, description + (f" ({values})" if action.choices and not is_positional else ""), is_positional]


def described(modules):
    found = {}
    for module in modules:
        try:
            importlib.import_module(module).main([])
        except Described as command:
            for option in options_of(command.args[0]):
                found.setdefault(option[0], option)
    return list(found.values())


def main():
    arguments.ArgumentParser.parse_args = describe
    told = {command: described(modules) for command, modules in PROGRAMS.items()}
    with growing(sys.argv[1]) as partial:
        partial.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
