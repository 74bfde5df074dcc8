"""JSON Schema of import maps, `slewlab schema import_map`: made by letting the reader of maps (import_map.read_root) ask for
its keys, of every kind of machine and of every unit, and writing down what it asks for."""

import json
import re
import sys
from pathlib import Path

from import_map import machine_named, read_root
from machine import Axis
from unit import SPELLINGS, spellings_of

TEXT = {"type": "string"}


def spellings(*quantities):
    return [name for quantity in quantities for name in spellings_of(quantity).split(", ")]


def spelling_pattern(spelling):
    """The regular expression of a unit's spelling as unit.factor_to_si takes it; tools/commands/schema.cpp has the same."""
    signs = {"^2": "(\\^2|²)", "^3": "(\\^3|³)", "^4": "\\^4", "deg": "(deg|°)"}
    parts = [part for part in re.split(r"(\^\d|deg|/)|[ ]", spelling) if part]
    return "[ *·]*".join(signs.get(part, part) for part in parts)


def with_every_spelling(schema):
    """The schema in which a unit may be written in every way that the reader takes."""
    if isinstance(schema, list):
        return [with_every_spelling(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    changed = {key: with_every_spelling(each) for key, each in schema.items()}
    unit = changed.get("properties", {}).get("unit")
    if unit and "enum" in unit:
        names = [name for name in unit["enum"] if spelling_pattern(name) != name]
        if names:
            pattern = "|".join(spelling_pattern(name) for name in names)
            changed["properties"]["unit"] = {"anyOf": [unit, {"type": "string", "pattern": f"^({pattern})$"}]}
    return changed


def said(choice):
    """A choice's word as YAML has it."""
    return {"true": [True], "false": [False]}.get(choice) or ([int(choice), choice] if choice.lstrip("+-").isdigit() else [choice])


def quantity_schema(quantity, positive):
    number = {"type": "number", "exclusiveMinimum": 0} if positive else {"type": "number"}
    return object_schema({"value": number, "unit": {"enum": spellings(quantity)}, "source": TEXT}, ["value", "unit", "source"])


def object_schema(properties, required):
    return {"type": "object", "properties": properties, "required": sorted(required), "additionalProperties": False}


class Inquiry:
    """Stands for input_map.MapReader, and remembers what is asked. `unit` is what it answers for a unit, `derives` whether a
    key `derive` is there."""

    def __init__(self, unit, derives):
        self.unit, self.derives = unit, derives
        self.keys, self.optional, self.needed, self.below, self.other = {}, set(), set(), {}, {}

    def _asks(self, key, schema, is_needed):
        self.keys[key] = schema
        if is_needed and key not in self.optional:
            self.needed.add(key)

    def has(self, key):
        if key == "derive" and not self.derives:
            return False
        self.optional.add(key)
        self.keys.setdefault(key, TEXT)
        return True

    def map(self, key, expected):
        self._asks(key, {}, True)
        self.below[key] = (Inquiry(self.unit, self.derives), False)
        return self.below[key][0]

    def maps(self, key, expected):
        self.map(key, expected)
        self.below[key] = (self.below[key][0], True)
        return [self.below[key][0]]

    def text(self, key, expected):
        choices = expected.removeprefix("one of ").split(", ")
        schema = {"const": expected} if key == "kind" else {"enum": choices} if expected.startswith("one of ") else {"enum": []} if key == "unit" else TEXT
        self._asks(key, schema, True)
        return self.unit if key == "unit" else expected

    def choice(self, key, choices, default=None):
        self._asks(key, {"enum": list(dict.fromkeys(word for each in choices for word in said(each)))}, False)
        return default

    def flag(self, key):
        return self.choice(key, ("true", "false"), "false") == "true"

    def integer(self, key, lowest, default):
        self._asks(key, {"type": "integer", "minimum": lowest}, False)
        return default

    def number(self, key, quantity, default, positive=True):
        self._asks(key, quantity_schema(quantity, positive), False)
        return default

    def factor(self, unit, *quantities):
        self.keys["unit"]["enum"] += [name for name in spellings(*quantities) if name not in self.keys["unit"]["enum"]]
        return 1.0

    def says(self, key, text):
        self.other[key] = {"const": text}
        return False

    def report(self, key, found, expected):
        pass

    def finish(self):
        pass

    def schema(self):
        properties = dict(self.keys)
        for key, (below, is_list) in self.below.items():
            one = below.schema()
            properties[key] = {"anyOf": [{"type": "array", "items": one}, one]} if is_list else one
        for key, other in self.other.items():
            properties[key] = {"anyOf": [other, properties[key]]}
        return object_schema(properties, self.needed)


def merged(one, other):
    """What keeps to either of two schemas of the same key."""
    if one == other:
        return one
    if "enum" in one and "enum" in other:
        return {"enum": one["enum"] + [each for each in other["enum"] if each not in one["enum"]]}
    if "properties" in one and "properties" in other:
        names = [*one["properties"], *(name for name in other["properties"] if name not in one["properties"])]
        both = {name: merged(one["properties"].get(name, other["properties"].get(name)), other["properties"].get(name, one["properties"].get(name)))
                for name in names}
        return object_schema(both, set(one["required"]) & set(other["required"]))
    if one.keys() == other.keys() and "anyOf" in one and len(one["anyOf"]) == len(other["anyOf"]):
        return {"anyOf": [merged(a, b) for a, b in zip(one["anyOf"], other["anyOf"], strict=True)]}
    if one.keys() == other.keys() == {"type", "items"}:
        return {"type": one["type"], "items": merged(one["items"], other["items"])}
    return {"anyOf": [one, other]}


def map_schema():
    whole = None
    for machine in (None, Axis(False, False, 1.0, True), Axis(True, True, 1.0, True)):
        for unit in [names[0] for names in map(list, SPELLINGS.values())]:
            for derives in (False, True):
                root = Inquiry(unit, derives)
                machine_named(root)
                read_root(root, [], Path("map.yaml"), machine)
                schema = root.schema()
                whole = schema if whole is None else merged(whole, schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "slewlab import_map"} | with_every_spelling(whole)


def main(arguments):
    text = json.dumps(map_schema(), indent=2, ensure_ascii=False) + "\n"
    if not arguments:
        sys.stdout.write(text)
        return 0
    path = Path(arguments[0])
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    partial.rename(path)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
