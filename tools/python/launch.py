"""Begins a Python program of slewlab: `launch.py PROGRAM.py ARGUMENTS`. Ctrl-C at any moment, while it still imports what it needs too, ends
it by one line and exit code 130; a library that is not installed, by what installs it."""

import runpy
import signal
import sys
from pathlib import Path

INTERRUPTED = 130  # as a shell has it: 128 + SIGINT
HERE = Path(__file__).resolve().parent
# The command that a user typed, where the program is not called like it.
COMMANDS = {"acceptance_plot": "accept", "acceptance_record": "accept", "campaign_command": "campaign", "check_map": "check", "desk_command": "desk",
            "diagnosis_report": "diagnose", "import_data": "import", "map_schema": "schema", "new_map": "new map", "new_questions": "new", "plc_bridge": "bridge",
            "soft_plc": "soft-plc"}


def command_of(program):
    return f"slewlab {COMMANDS.get(Path(program).stem, Path(program).stem)}"


def what_installs(here=HERE):
    """What installs a library, of the installation that these programs stand in."""
    requirements = here / "requirements.txt"
    home = here.parents[1]
    if (home.parents[1] / "__init__.py").is_file():  # a wheel's package, with share/slewlab in it
        return "The wheel has it as an extra: pip install 'WHEEL[commands,plc]'"
    if (home / "CMakeLists.txt").is_file():
        return "tools/setup installs it"
    return f"As root: python3 -m venv {home}/.venv && {home}/.venv/bin/pip install -r {requirements}; or name an interpreter that has it in SLEWLAB_PYTHON"


def main():
    program = str(Path(__file__).parent / sys.argv[1])
    sys.argv = [program, *sys.argv[2:]]
    try:
        runpy.run_path(program, run_name="__main__")
    except ModuleNotFoundError as missing:
        library = (missing.name or "").partition(".")[0]
        if not library or (Path(__file__).parent / f"{library}.py").exists():
            raise
        print(f"{command_of(program)}: the Python library {library} is not installed for {sys.executable}. {what_installs()}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second one ends whatever still holds it up
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
