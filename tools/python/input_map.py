"""An import map, key by key: every problem is collected with file, line, key, what was found and what would be right. The
YAML itself is read by common/yaml_file."""

import difflib
import re
from dataclasses import dataclass

from core_module import core
from unit import factor_to_si, quantity_of, spellings_of


class InputProblems(Exception):
    """All that is wrong in a file; the text has one line per problem."""

    def __init__(self, lines):
        super().__init__("\n".join(lines))


def nearest(name, known):
    """The known names that differ least, in words."""
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    names = ", ".join(f"'{k}'" for k in close)
    return f"{names} (or one of {', '.join(known)})" if close else f"one of {', '.join(known)}"


@dataclass(frozen=True)
class Node:
    """A piece of YAML, and where it stands."""

    kind: str     # null, scalar, sequence or map
    scalar: str
    items: list   # of a sequence
    entries: list  # of a map: (key, line, column, value)
    file: str
    line: int
    column: int


def node_of(told):
    kind, scalar, items, entries, *place = told
    return Node(kind, scalar, [node_of(item) for item in items],
                [(key, line, column, node_of(value)) for key, line, column, value in entries], *place)


def is_scalar(node):
    return node.kind in ("scalar", "null")


def shown(node):
    if is_scalar(node):
        return node.scalar or "nothing"
    return "a list" if node.kind == "sequence" else "a map"


def without_control(text):
    """The text with control characters as common/utf8_text.h shows them: a terminal obeys some of them."""
    return re.sub("[\x00-\x1f\x7f]", lambda found: f"\\x{ord(found[0]):02x}", re.sub("[\x80-\x9f]", lambda found: f"\\u{ord(found[0]):04x}", text))


class MapReader:
    """A map of the file. Wrong keys are reported and answered with None, so that one pass finds all problems."""

    def __init__(self, node, path, file, lines):
        self.node, self.path, self.file, self.lines = node, path, file, lines
        self.entries, self.asked = {}, []
        if node.kind != "map":
            self.complain(node, "", shown(node), "a map of keys")
            return
        for key, line, column, value in node.entries:
            self.entries[key] = (Node("scalar", key, [], [], node.file, line, column), value)

    def complain(self, node, key, found, expected):
        path = ".".join(part for part in (self.path, key) if part)
        where = f"key '{path}': " if path else ""
        self.lines.append(without_control(f"{node.file or self.file}:{node.line}:{node.column}: {where}found {found}, expected {expected}"))

    def report(self, key, found, expected):
        entry = self.entries.get(key)
        self.complain(entry[1] if entry else self.node, key, found, expected)

    def has(self, key):
        self.asked.append(key)
        return key in self.entries

    def raw(self, key, expected):
        """The node below a key that must be there."""
        if not self.has(key):
            self.report(key, "nothing", expected)
            return None
        return self.entries[key][1]

    def map(self, key, expected):
        node = self.raw(key, expected)
        return None if node is None else MapReader(node, f"{self.path}.{key}".lstrip("."), self.file, self.lines)

    def maps(self, key, expected):
        """A list of maps; one map alone counts as a list of one."""
        node = self.raw(key, expected)
        if node is None:
            return []
        items = node.items if node.kind == "sequence" else [node]
        return [MapReader(item, f"{self.path}.{key}[{i + 1}]".lstrip("."), self.file, self.lines)
                for i, item in enumerate(items)]

    def text(self, key, expected):
        node = self.raw(key, expected)
        if node is None:
            return None
        if not is_scalar(node) or not node.scalar:
            self.report(key, shown(node), expected)
            return None
        return node.scalar

    def choice(self, key, choices, default=None):
        if not self.has(key):
            return default
        text = self.text(key, f"one of {', '.join(choices)}")
        if text is not None and text not in choices:
            self.report(key, text, core.known_names_text(text, list(choices)))
            return default
        return text

    def says(self, key, text):
        """Whether the key is there and holds just this text."""
        return key in self.entries and shown(self.entries[key][1]) == text

    def flag(self, key):
        return self.choice(key, ("true", "false"), "false") == "true"

    def integer(self, key, lowest, default):
        if not self.has(key):
            return default
        text = self.text(key, f"a whole number from {lowest} on")
        try:
            number = int(text)
        except (TypeError, ValueError):
            number = lowest - 1
        if number < lowest:
            self.report(key, text, f"a whole number from {lowest} on")
            return default
        return number

    def number(self, key, quantity, default, positive=True):
        """{value, unit, source} in SI."""
        form = f"{{value: NUMBER, unit: one of {spellings_of(quantity)}, source: where it is from}}"
        if not self.has(key):
            return default
        entry = self.map(key, form)
        value, unit, _ = entry.text("value", "a number"), entry.text("unit", f"one of {spellings_of(quantity)}"), \
            entry.text("source", "where the number is from")
        entry.finish()
        factor = entry.factor(unit, quantity)
        if value is None or factor is None:
            return default
        try:
            number = float(value) * factor
        except ValueError:
            entry.report("value", value, "a number")
            return default
        if number != number or abs(number) == float("inf") or (positive and number <= 0.0):
            entry.report("value", value, "a number above 0" if positive else "a finite number")
            return default
        return number

    def factor(self, unit, *quantities):
        """Factor to SI of a unit's spelling that must be of one of the quantities."""
        if unit is None:
            return None
        for quantity in quantities:
            factor = factor_to_si(quantity, unit)
            if factor is not None:
                return factor
        other = quantity_of(unit)
        found = f"{unit}, a unit of {other}" if other else f"{unit}, a unit that is not known here"
        self.report("unit", found, " or ".join(f"a unit of {q}: {spellings_of(q)}" for q in quantities))
        return None

    def finish(self):
        for key, (node, _) in self.entries.items():
            if key not in self.asked:
                self.complain(node, key, "a key that is not known here", core.known_names_text(key, sorted(set(self.asked))))


def load(path):
    """The root of a YAML file, and the list into which its problems go. InputProblems where the YAML itself is wrong."""
    told, problems = core.load_yaml(path)
    if problems:
        raise InputProblems(problems)
    root, lines = node_of(told), []
    if root.kind == "null":
        raise InputProblems([f"{path}: found an empty file, expected kind: import_map"])
    return MapReader(root, "", path, lines), lines
