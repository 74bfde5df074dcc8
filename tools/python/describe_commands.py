"""Writes what the commands of the Python side take, for manual pages and completion: `describe_commands.py OUT.json`. It is what their
--help says, {command: [[name, description, whether it stands without a name, words that it may be]]}, of the very parser that reads them."""

import importlib
import json
import sys

import arguments
from plc_bridge import PROTOCOLS
from whole_file import growing

# As main.cpp has them.
PROGRAMS = {"report": ["report"], "campaign": ["campaign_command"], "desk": ["desk_command"], "bridge": ["bridge"],
            **{f"bridge {protocol}": ["plc_bridge"] for protocol in PROTOCOLS}, "soft-plc": ["soft_plc"], "export": ["export"], "import": ["import_data"]}


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
        choices = [str(choice) for choice in action.choices or ()]
        yield [name, description + (f" ({values})" if choices and not is_positional else ""), is_positional, choices]


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
    told["bridge"].append(["|".join(PROTOCOLS), "a PLC as the controller, in place of viewers", True, list(PROTOCOLS)])
    with growing(sys.argv[1]) as partial:
        partial.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
