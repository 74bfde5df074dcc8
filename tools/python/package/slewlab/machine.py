from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core
from .control import StateSpace
from .files import Changes, check, pairs, path_of, text_of, values

if TYPE_CHECKING:  # imported where a table is made: a campaign's workers make none, and it takes longer than all else
    import pandas as pd


class Machine:
    """A crane or an axis as its file describes it. `changes` are laid over the file: {"load.mass": "60 t"}; a bare number is
    in SI, and only where the file's own unit is."""

    def __init__(self, path: str | Path, changes: Changes | None = None) -> None:
        self.path, self.changes = path_of(path, "a crane's or an axis's file"), dict(changes or {})
        self._core = _core.Machine(self.path, pairs(changes))

    def changed(self, changes: Changes) -> "Machine":
        """The same machine with more changes."""
        return Machine(self.path, self.changes | dict(changes))

    def check(self) -> list[str]:
        """What is possible and yet unlikely of it, one line each. InputError where a run would refuse it."""
        return check(self.path, self.changes)

    @property
    def values(self) -> pd.DataFrame:
        """Every value of its file with unit and source."""
        return values(self.path, self.changes)

    def facts(self) -> dict[str, Any]:
        """Its kind, units of its axis, efforts and sensors, as run.json has them under `machine`."""
        return json.loads(self._core.facts)

    def write(self, path: str | Path) -> Path:
        """Writes a file of this machine: its own one included, its changes over it. ValueError where they cannot be said so."""
        path = Path(path)
        table = self.values
        tree: dict[str, Any] = {}
        for key, value in self.changes.items():
            *above, last = key.split(".")
            place = tree
            for name in above:
                place = place.setdefault(name, {})
            if key in table.index:
                row = table.loc[key]
                unit = f", unit: {json.dumps(row['unit'])}" if row["unit"] else ""
                place[last] = f"{{value: {row['value']}{unit}, source: changed in Python}}"
            else:
                place[last] = text_of(value)

        def lines(tree: dict, depth: int) -> list[str]:
            found = []
            for name, below in tree.items():
                found += [f"{'  ' * depth}{name}: {below}"] if isinstance(below, str) else [f"{'  ' * depth}{name}:", *lines(below, depth + 1)]
            return found

        path.write_text("\n".join([f"include: {json.dumps(str(self.path.absolute()))}", *lines(tree, 0)]) + "\n", encoding="utf-8")
        try:
            same = values(path)[["value", "unit"]].to_dict("index") == table[["value", "unit"]].to_dict("index")
        except _core.InputError:
            same = False
        if not same:
            path.unlink()
            raise ValueError(f"{self!r}: its changes cannot be written over its file, expected changes of single values; write a file by hand")
        return path

    @property
    def kind(self) -> str:
        """crane or axis"""
        return self._core.kind

    @property
    def group_count(self) -> int:
        """motor groups"""
        return self._core.group_count

    @property
    def motors_per_group(self) -> int:
        return self._core.motors_per_group

    @property
    def total_ratio(self) -> float:
        """turns of the motor per turn of the axis"""
        return self._core.total_ratio

    @property
    def rated_torque(self) -> float:
        """[N m] of one motor, T100"""
        return self._core.rated_torque

    @property
    def top_speed(self) -> float:
        """[rad/s] of the axis"""
        return self._core.top_speed

    def modes(self, *, gears_closed: bool = True, elements: int | None = None) -> list[_core.Mode]:
        """Modes of the linear machine, rising frequencies; its effects are left out. `elements`: of the boom, in place of the file's own, 200 at
        most: rounding spoils the slow modes of finer meshes."""
        return self._core.modes(gears_closed, elements)

    def state_space(self, *, gears_closed: bool = True, elements: int | None = None) -> StateSpace:
        """The linear machine: torque per motor of each group to what sensors show. The machine's effects are left out."""
        made = self._core.state_space(gears_closed, elements)
        return StateSpace(made.a, made.b, made.c, made.d, dict(made.states), dict(made.inputs), dict(made.outputs))

    def __repr__(self) -> str:
        return f"<Machine {self.path}{' with ' + str(self.changes) if self.changes else ''}>"
