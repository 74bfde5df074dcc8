"""A YAML file as Python has it: maps, lists, numbers, truth and text. The YAML itself is read by common/yaml_file; what is written
here is the part of it that JSON is, but for bare keys."""

import json

from core_module import core

TRUTH = {"true": True, "false": False}


def read_yaml(path):
    """The file with what it includes; ValueError with what is wrong in it, a line each."""
    root, problems = core.load_yaml(str(path))
    if problems:
        raise ValueError("\n".join(problems))
    return plain(root)


def flow(value):
    """A value on one line, with braces around a map."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(flow, value)) + "]"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def file_text(keys):
    """A file: a line per key, and per entry of a list; a map within a map in lines of its own."""
    return "".join(lines_of(keys, ""))


def lines_of(keys, indent):
    for key, value in keys.items():
        if isinstance(value, (list, tuple)) and value:
            yield f"{indent}{key}:\n"
            yield from (f"{indent}  - {flow(each)}\n" for each in value)
        elif isinstance(value, dict) and any(isinstance(each, (dict, list, tuple)) for each in value.values()):
            yield f"{indent}{key}:\n"
            yield from lines_of(value, indent + "  ")
        else:
            yield f"{indent}{key}: {flow(value)}\n"


def plain(told):
    kind, scalar, items, entries, *_ = told
    if kind == "sequence":
        return [plain(item) for item in items]
    if kind == "map":
        return {key: value[1] if key == "source" else plain(value) for key, _, _, value in entries}
    return None if kind == "null" else TRUTH[scalar] if scalar in TRUTH else number_or_text(scalar)


def number_or_text(scalar):
    for kind in (int, float):
        try:
            return kind(scalar)
        except ValueError:
            pass
    return scalar
