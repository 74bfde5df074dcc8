"""Each protocol over loopback: the bridge as the controller of a run, with the soft PLC behind it. In lockstep the log is, byte for byte,
that of the native controller; against the wall clock it runs at all, and says how well (that is measured, not tested: docs/plc.md)."""

import contextlib
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

from run_log import REPOSITORY, messages_folder

SLEWLAB = messages_folder().parent / "bin" / "slewlab"
MAPS = REPOSITORY / "config" / "plc"
SCENARIO = REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml"
CONTROLLER = REPOSITORY / "config" / "controllers" / "thesis.yaml"
PATIENCE = 100.0  # [s]
SHORT = ("--set", "duration=2 s", "--set", "operator.0.time=0.5 s", "--set", "operator.1.time=1.5 s")  # starts, and stops in emergency


class LinkTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.native, ended = cls.run_scenario("native")
        assert ended.returncode == 0, ended.stderr

    @classmethod
    def run_scenario(cls, name, *options):
        out = cls.folder / name
        ended = subprocess.run([SLEWLAB, "run", SCENARIO, "--out", out, "--progress", "none", *SHORT, *options], capture_output=True, text=True,
                               timeout=PATIENCE, check=False)
        return out, ended

    @contextlib.contextmanager
    def soft_plc(self, plc_map, *options):
        process = subprocess.Popen([SLEWLAB, "soft-plc", "--map", plc_map, "--controller", CONTROLLER, *options], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, text=True)
        try:
            self.assertIn("soft-plc: ", process.stdout.readline())  # it is there
            yield
        finally:
            process.terminate()
            process.communicate(timeout=PATIENCE)

    def bridged(self, protocol, plc_map, *options):
        report = self.folder / f"{plc_map.stem}.json"
        with self.soft_plc(plc_map):
            out, ended = self.run_scenario(plc_map.stem, *options, "--controller", f"{SLEWLAB} bridge {protocol} --map {plc_map} --report {report}")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return out, json.loads(report.read_text(encoding="utf-8"))

    def check_lockstep(self, protocol):
        out, report = self.bridged(protocol, MAPS / f"{protocol}_ticked.yaml")
        self.assertEqual((out / "run.lcmlog").read_bytes(), (self.native / "run.lcmlog").read_bytes())
        self.assertEqual((report["protocol"], report["exchanges"], report["link_losses"]), (protocol, 200, 0))

    def test_modbus_in_lockstep_to_the_bit(self):
        self.check_lockstep("modbus")

    def test_opcua_in_lockstep_to_the_bit(self):
        self.check_lockstep("opcua")

    def test_ads_in_lockstep_to_the_bit(self):
        self.check_lockstep("ads")

    def test_against_the_wall_clock_deadlines_are_published(self):
        """Of a ticked PLC with a time-out that no busy machine reaches: how many cycles were late is this machine's affair."""
        _, report = self.bridged("modbus", MAPS / "modbus_ticked.yaml", "--realtime")
        self.assertGreater(report["exchanges"], 0)
        for key in ("late_exchanges", "unanswered_cycles", "failed_exchanges", "link_losses", "scheduling", "period_ms"):
            self.assertIn(key, report)
        self.assertEqual(set(report["exchange_ms"]), {"mean", "p50", "p99", "p99_9", "largest"})

    def refusal(self, protocol, plc_map, *options):
        _, ended = self.run_scenario("refused", *options, "--controller", f"{SLEWLAB} bridge {protocol} --map {plc_map}")
        self.assertEqual(ended.returncode, 1)
        return ended.stderr

    def test_a_wrong_map_is_explained_before_anything_moves(self):
        self.assertIn("a map for modbus; slewlab bridge modbus takes it, slewlab bridge ads does not", self.refusal("ads", MAPS / "modbus_ticked.yaml"))
        self.assertIn("this PLC keeps a time of its own (ticked: false); run it with --realtime", self.refusal("modbus", MAPS / "modbus.yaml"))
        self.assertIn("2 times real time; run it without --speed", self.refusal("modbus", MAPS / "modbus.yaml", "--realtime", "--speed", "2"))
        wrong = self.folder / "wrong.yaml"
        wrong.write_text((MAPS / "modbus.yaml").read_text(encoding="utf-8").replace("at: input 3,", "at: input 2,"), encoding="utf-8")
        self.assertIn("wrong.yaml:31:23: key 'from_plc.alive_counter.at': found 'input 2', where enable lies", self.refusal("modbus", wrong))
        checked = subprocess.run([SLEWLAB, "check", wrong, MAPS / "opcua.yaml"], capture_output=True, text=True, timeout=PATIENCE, check=False)
        self.assertEqual(checked.returncode, 1)
        self.assertIn("found 'input 2', where enable lies, expected a place of its own", checked.stderr)
        self.assertIn("opcua.yaml: OK", checked.stdout)

    def check_plc_refuses(self, protocol, before, after, expected):
        """The PLC has the map's variables, the bridge asks for others."""
        plc_map = MAPS / f"{protocol}_ticked.yaml"
        other = self.folder / f"other_{protocol}.yaml"
        text = plc_map.read_text(encoding="utf-8")
        self.assertIn(before, text)
        other.write_text(text.replace(before, after), encoding="utf-8")
        with self.soft_plc(plc_map):
            self.assertIn(expected, self.refusal(protocol, other))

    def test_what_the_plc_does_not_have_is_named(self):
        self.check_plc_refuses("modbus", "at: input 40", "at: input 4000", "refused input 4000 to 4003 of unit 1: it has no such address")
        self.check_plc_refuses("opcua", "Slewing.Torque1", "Slewing.Torq1", "does not know the node ns=2;s=Slewing.Torq1 of motor_torque")
        self.check_plc_refuses("opcua", "Mode\", type: int16", "Mode\", type: int32", "of mode is a int16, the map says int32")
        self.check_plc_refuses("ads", "GVL_Slewing.Torque1", "GVL_Slewing.Torq1", "has no symbol GVL_Slewing.Torq1, where the map has motor_torque")
        self.check_plc_refuses("ads", "Mode, type: int16", "Mode, type: int32", "of mode is a INT, the map says int32 (DINT)")


if __name__ == "__main__":
    unittest.main()
