"""`slewlab check` of import maps: FILE: OK, or what is wrong, a line each."""

import sys
from pathlib import Path

from import_map import fail_if_wrong, read_map
from input_map import InputProblems


PLACEHOLDER = "REPLACE"  # begins what `slewlab new map` leaves to its user
EXPECTED = {"column": "the name of a column of the data", "source": "a value of your own, and where it is from"}


def placeholders(node, path=""):
    """What of the map still has to be replaced, a line each."""
    for key, _, _, value in node.entries:
        where = f"{path}.{key}".lstrip(".")
        if key in EXPECTED and value.scalar.startswith(PLACEHOLDER):
            yield f"{value.file}:{value.line}:{value.column}: key '{where}': found {value.scalar}, expected {EXPECTED[key]}"
        yield from placeholders(value, where)
    for i, item in enumerate(node.items):
        yield from placeholders(item, f"{path}[{i + 1}]")


def main(arguments):
    code = 0
    for path in map(Path, arguments):
        try:
            mapping = read_map(path)
            mapping.lines.extend(placeholders(mapping.reader.node))
            fail_if_wrong(mapping)
            print(f"{path}: OK")
        except InputProblems as problems:
            print(problems, file=sys.stderr)
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
