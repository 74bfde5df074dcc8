"""`slewlab check` of import maps: FILE: OK, or what is wrong, a line each."""

import sys
from pathlib import Path

from import_map import fail_if_wrong, read_map
from input_map import InputProblems


def main(arguments):
    code = 0
    for path in map(Path, arguments):
        try:
            fail_if_wrong(read_map(path))
            print(f"{path}: OK")
        except InputProblems as problems:
            print(problems, file=sys.stderr)
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
