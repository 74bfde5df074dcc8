"""The command `slewlab`: which program it is, how it is called, and, of a wheel, the command itself."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path


class ProgramFailed(RuntimeError):
    """A program of slewlab ended with another code than 0; the text is what it said, `code` what it ended with."""

    def __init__(self, text: str, code: int | None = None) -> None:
        super().__init__(text)
        self.code = code


def program() -> str:
    """As $SLEWLAB_PROGRAM names it; of a wheel within the package, of a build beside the package's folder; else the one in PATH."""
    package = Path(__file__).resolve().parent
    places = [package / "bin" / "slewlab", package.parents[1] / "bin" / "slewlab"]
    found = os.environ.get("SLEWLAB_PROGRAM") or next((str(each) for each in places if each.is_file()), None) or shutil.which("slewlab")
    if not found:
        raise FileNotFoundError(f"the program slewlab is neither {places[0]} nor {places[1]} nor in PATH: install the wheel or the Debian package "
                                "(docs/install.md), or name it in SLEWLAB_PROGRAM")
    return found


def environment(name: str) -> dict[str, str]:
    """Of the program `name`. A wheel's draws and exports by the interpreter that the wheel is installed for."""
    inside = Path(name).is_relative_to(Path(__file__).resolve().parent)
    return os.environ | ({"SLEWLAB_PYTHON": sys.executable} if inside and "SLEWLAB_PYTHON" not in os.environ else {})


def call(words: Sequence[str]) -> str:
    """What the program said on its standard output."""
    ended = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, env=environment(words[0]))
    if ended.returncode != 0:
        raise ProgramFailed(f"{' '.join(words)}: exit code {ended.returncode}\n{ended.stdout}{ended.stderr}".strip(), ended.returncode)
    return ended.stdout


def main() -> None:
    """The command that a wheel puts into PATH: becomes the program."""
    name = str(Path(__file__).resolve().parent / "bin" / "slewlab")
    os.execve(name, [name, *sys.argv[1:]], environment(name))
