"""docs/seeded_bugs.md: each bug is caught by the run and the checks that the page names, and the controller without it passes."""

import unittest

import seeded_bugs
from run_log import REPOSITORY


def told():
    """The page's rows."""
    rows = {}
    for line in (REPOSITORY / "docs" / "seeded_bugs.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| ") and len(cells) == 5 and cells[0] != "bug":
            rows[cells[0]] = cells
    return rows


class SeededBugsTest(unittest.TestCase):
    def test_the_page_has_every_bug_and_all_but_one_in_twenty_are_caught(self):
        rows = told()
        self.assertEqual(list(rows), [bug.name for bug in seeded_bugs.BUGS])
        self.assertEqual([cells[1] for cells in rows.values()], [bug.what for bug in seeded_bugs.BUGS])
        missed = [name for name, cells in rows.items() if cells[2] == "nothing"]
        self.assertGreaterEqual(len(rows), 20)
        self.assertLessEqual(len(missed), len(rows) / 20, missed)

    def test_each_is_caught_where_the_page_says(self):
        tests, rows = seeded_bugs.plan_tests(), told()
        for bug in seeded_bugs.BUGS:
            _, _, test, checks, _ = rows[bug.name]
            if test == "nothing":
                continue
            with self.subTest(bug=bug.name, test=test):
                self.assertEqual(", ".join(seeded_bugs.failed_checks(bug.changes, tests[test])), checks)

    def test_without_a_bug_nothing_fails_where_bugs_are_caught(self):
        tests = seeded_bugs.plan_tests()
        for test in sorted({cells[2] for cells in told().values()} - {"nothing"}):
            with self.subTest(test=test):
                self.assertEqual(seeded_bugs.failed_checks((), tests[test]), [])


if __name__ == "__main__":
    unittest.main()
