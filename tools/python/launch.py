"""Begins a Python program of slewlab: `launch.py PROGRAM.py ARGUMENTS`. Ctrl-C at any moment, while it still imports what it needs too, ends
it by one line and exit code 130; a library that is not installed, by what installs it."""

import runpy
import signal
import sys
from pathlib import Path

INTERRUPTED = 130  # as a shell has it: 128 + SIGINT


def main():
    program = str(Path(__file__).parent / sys.argv[1])
    sys.argv = [program, *sys.argv[2:]]
    try:
        runpy.run_path(program, run_name="__main__")
    except ModuleNotFoundError as missing:
        library = (missing.name or "").partition(".")[0]
        if not library or (Path(__file__).parent / f"{library}.py").exists():
            raise
        print(f"{Path(program).stem}: the Python library {library} is not installed for {sys.executable}. A wheel has it as an extra: pip install "
              "'WHEEL[commands,plc]'; else it is in tools/python/requirements.txt (docs/install.md)", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second one ends whatever still holds it up
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
