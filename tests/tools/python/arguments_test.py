import contextlib
import io
import unittest

from arguments import ArgumentParser


class ArgumentsTest(unittest.TestCase):
    def setUp(self):
        self.parser = ArgumentParser(prog="slewlab export")
        self.parser.add_argument("log")
        self.parser.add_argument("--format", required=True)

    def refused(self, *words):
        said = io.StringIO()
        with contextlib.redirect_stderr(said), self.assertRaises(SystemExit) as end:
            self.parser.parse_args(words)
        self.assertEqual(end.exception.code, 2)
        return said.getvalue().splitlines()[-1]

    def test_an_unknown_option_is_answered_with_the_near_one(self):
        expected = "slewlab export: error: '--fromat' is no option of it, expected '--format' (or one of --help, --format)"
        self.assertEqual(self.refused("run", "--fromat", "csv"), expected)
        self.assertEqual(self.refused("run", "--fromat=csv"), expected)

    def test_where_none_is_near_all_are_named(self):
        self.assertEqual(self.refused("run", "--colour", "red"),
                         "slewlab export: error: '--colour' is no option of it, expected one of --help, --format")

    def test_beginnings_of_options_and_what_stands_behind_two_dashes_are_left_alone(self):
        self.assertEqual(self.parser.parse_args(["--form", "csv", "run"]).format, "csv")
        self.assertEqual(self.parser.parse_args(["--format", "csv", "--", "--fromat"]).log, "--fromat")


if __name__ == "__main__":
    unittest.main()
