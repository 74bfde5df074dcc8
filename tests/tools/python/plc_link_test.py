"""Each protocol over loopback: the bridge as the controller of a run, with the soft PLC behind it. In lockstep the log is, byte for byte,
that of the native controller; against the wall clock it runs at all, and says how well (that is measured, not tested: docs/plc.md)."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

from run_log import REPOSITORY
from soft_plc_process import MAPS, PATIENCE, SLEWLAB, soft_plc

SCENARIO = REPOSITORY / "config" / "scenarios" / "thesis_slew.yaml"
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

    def bridged(self, protocol, plc_map, *options):
        report = self.folder / f"{plc_map.stem}.json"
        with soft_plc(plc_map):
            out, ended = self.run_scenario(plc_map.stem, *options, "--controller", f"exec {SLEWLAB} bridge {protocol} --map {plc_map} --report {report}")
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

    def test_a_soft_plc_of_another_period_ends_itself_and_the_run(self):
        plc_map = MAPS / "modbus_ticked.yaml"
        with soft_plc(plc_map) as plc:
            _, ended = self.run_scenario("another_period", "--set", "controller_period=5 ms", "--controller", f"exec {SLEWLAB} bridge modbus --map {plc_map}")
            _, complaints = plc.communicate(timeout=PATIENCE)
        self.assertEqual((ended.returncode, plc.returncode), (1, 1), ended.stderr)
        self.assertIn("expected 10 ms (--period-ms): --period-ms 5 is right for this run", complaints)

    def test_against_the_wall_clock_deadlines_are_published(self):
        """Of a ticked PLC with a time-out that no busy machine reaches: how many cycles were late is this machine's affair."""
        patient = ("--set", "crane.drive_protection.silence_timeout=10 s")  # longer than the map's time-out
        _, report = self.bridged("modbus", MAPS / "modbus_ticked.yaml", "--realtime", *patient)
        self.assertGreater(report["exchanges"], 0)
        for key in ("late_exchanges", "unanswered_cycles", "failed_exchanges", "link_losses", "scheduling", "period_ms"):
            self.assertIn(key, report)
        self.assertEqual(set(report["exchange_ms"]), {"mean", "p50", "p99", "p99_9", "largest"})

    def test_the_stand_in_answers_a_plain_client_of_ads(self):
        """By name and handle, one variable at a time, as people look at a PLC; Beckhoff's own library makes the frames."""
        import pyads
        with soft_plc(MAPS / "ads_ticked.yaml"):
            plc = pyads.Connection("127.0.0.1.1.2", 851, "127.0.0.1")
            plc.open()
            self.addCleanup(plc.close)
            self.assertEqual(plc.read_device_info()[0], "slewlab soft-plc")
            self.assertEqual(plc.read_state()[0], pyads.ADSSTATE_RUN)
            plc.write_by_name("GVL_Slewing.Speed1", 1.5, pyads.PLCTYPE_LREAL)
            self.assertEqual(plc.read_by_name("GVL_Slewing.Speed1", pyads.PLCTYPE_LREAL), 1.5)
            self.assertIs(plc.read_by_name("GVL_Slewing.Brake", pyads.PLCTYPE_BOOL), True)  # until it computes
            plc.write_by_name("GVL_Slewing.AliveCounter", 1, pyads.PLCTYPE_UDINT)
            self.assertEqual(plc.read_by_name("GVL_Slewing.AnsweredCounter", pyads.PLCTYPE_UDINT), 1)
            self.assertIs(plc.read_by_name("GVL_Slewing.Brake", pyads.PLCTYPE_BOOL), False)
            with self.assertRaisesRegex(pyads.ADSError, "1808"):  # symbol not found
                plc.read_by_name("GVL_Slewing.Nothing", pyads.PLCTYPE_LREAL)


if __name__ == "__main__":
    unittest.main()
