"""What tools/demo shows in the end: a page per run, one for both, the table side by side and the finding.

    demo_report.py RUN_WITH_PLAY_COMPENSATION RUN_WITHOUT
"""

import sys
from pathlib import Path

import report
from run_log import LogProblem
from run_numbers import finding, read_run, shown_path, table, table_text


def main(arguments):
    try:
        runs = [read_run(folder) for folder in arguments]
        pictures = [Path(folder) / "report.html" for folder in arguments]
        both = Path(arguments[0]).parent / "play_compensation.html"
        for run, picture in zip(runs, pictures):
            report.write_whole(picture, report.page([run], table([run])))
        rows = table(runs)
        report.write_whole(both, report.page(runs, rows))
    except (LogProblem, OSError) as problem:
        print(f"demo: {problem}", file=sys.stderr)
        return 1
    print()
    print(table_text(report.headings(runs), rows))
    print()
    print(finding(*runs))
    print()
    for run, picture in zip(runs, pictures):
        print(f"log: {shown_path(run.log.path)}   picture: {shown_path(picture)}")
    print(f"both in one picture: {shown_path(both)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
