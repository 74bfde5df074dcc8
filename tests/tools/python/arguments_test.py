import contextlib
import io
import unittest

from arguments import ArgumentParser, bus, port, shell_command


class ArgumentsTest(unittest.TestCase):
    def setUp(self):
        self.parser = ArgumentParser(prog="slewlab export")
        self.parser.add_argument("log")
        self.parser.add_argument("--format", required=True, choices=("parquet", "csv", "mcap"))

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

    def test_a_choice_that_is_none_is_answered_with_the_near_one(self):
        for typo in ("mcp", "mpac"):
            self.assertEqual(self.refused("run", "--format", typo),
                             f"slewlab export: error: argument --format: found '{typo}', expected 'mcap' (or one of parquet, csv, mcap)")

    def test_a_command_is_not_empty(self):
        self.parser.add_argument("--controller", type=shell_command)
        self.assertEqual(self.parser.parse_args(["run", "--format", "csv", "--controller", "exec ./own"]).controller, "exec ./own")
        self.assertEqual(self.refused("run", "--format", "csv", "--controller", ""),
                         "slewlab export: error: argument --controller: found '', expected a command of the shell")

    def test_a_port_is_a_number_that_a_computer_has(self):
        self.parser.add_argument("--port", type=port)
        self.assertEqual(self.parser.parse_args(["run", "--format", "csv", "--port", "8765"]).port, 8765)
        for wrong in ("-3", "65536", "http"):
            self.assertEqual(self.refused("run", "--format", "csv", f"--port={wrong}"),
                             f"slewlab export: error: argument --port: found '{wrong}', expected a number from 0 to 65535")

    def test_a_bus_is_a_multicast_address(self):
        self.parser.add_argument("--bus", type=bus)
        for right in ("udpm://239.255.76.67:7667?ttl=0", "udpm://239.255.76.67"):
            self.assertEqual(self.parser.parse_args(["run", "--format", "csv", "--bus", right]).bus, right)
        for wrong in ("foo", "udpm://", "udpm://10.0.0.1:7667", "udpm://239.255.76.67:99999", "tcpq://239.255.76.67:7667"):
            self.assertEqual(self.refused("run", "--format", "csv", f"--bus={wrong}"),
                             f"slewlab export: error: argument --bus: found '{wrong}', expected the address of a bus as udpm://239.255.76.67:7667?ttl=0")

    def test_beginnings_of_options_and_what_stands_behind_two_dashes_are_left_alone(self):
        self.assertEqual(self.parser.parse_args(["--form", "csv", "run"]).format, "csv")
        self.assertEqual(self.parser.parse_args(["--format", "csv", "--", "--fromat"]).log, "--fromat")


if __name__ == "__main__":
    unittest.main()
