"""A YAML file as Python has it: maps, lists, numbers, truth and text. The YAML itself is read by common/yaml_file."""

from core_module import core

TRUTH = {"true": True, "false": False}


def read_yaml(path):
    """The file with what it includes; ValueError with what is wrong in it, a line each."""
    root, problems = core.load_yaml(str(path))
    if problems:
        raise ValueError("\n".join(problems))
    return plain(root)


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
