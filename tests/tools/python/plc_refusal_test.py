"""What `slewlab bridge` and `slewlab check` say of a map that is wrong, or that the PLC does not have the variables of."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from soft_plc_process import CONTROLLER, MAPS, PATIENCE, SLEWLAB, soft_plc


class RefusalTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def refusal(self, protocol, plc_map, code, **environment):
        """What the bridge says that ends by itself, before it has heard anything of a plant."""
        ended = subprocess.run([SLEWLAB, "bridge", protocol, "--map", plc_map, "--period-ms", "10", "--bus", "udpm://239.255.76.67:7667?ttl=0"],
                               env=os.environ | environment, capture_output=True, text=True, timeout=PATIENCE, check=False)
        self.assertEqual(ended.returncode, code, ended.stderr)
        return ended.stderr

    def test_a_wrong_map_is_explained_before_anything_moves(self):
        self.assertIn("a map for modbus; slewlab bridge modbus takes it, slewlab bridge ads does not",
                      self.refusal("ads", MAPS / "modbus_ticked.yaml", 2))
        self.assertIn("this PLC keeps a time of its own (ticked: false); run it with --realtime", self.refusal("modbus", MAPS / "modbus.yaml", 2))
        self.assertIn("2 times real time; run it without --speed", self.refusal("modbus", MAPS / "modbus.yaml", 2, SLEWLAB_REALTIME_SPEED="2"))
        wrong = self.folder / "wrong.yaml"
        wrong.write_text((MAPS / "modbus.yaml").read_text(encoding="utf-8").replace("at: input 3,", "at: input 2,"), encoding="utf-8")
        explained = "wrong.yaml:32:23: key 'from_plc.alive_counter.at': found 'input 2', where enable lies, expected a place of its own"
        self.assertIn(explained, self.refusal("modbus", wrong, 2))
        checked = subprocess.run([SLEWLAB, "check", wrong, MAPS / "opcua.yaml"], capture_output=True, text=True, timeout=PATIENCE, check=False)
        self.assertEqual(checked.returncode, 1)
        self.assertIn(explained, checked.stderr)
        self.assertIn("opcua.yaml: OK", checked.stdout)

    def test_a_link_that_counts_as_lost_after_the_drive_trips_is_refused(self):
        plc_map, machine = self.folder / "slow.yaml", self.folder / "crane.yaml"
        before = "timeout: {value: 50, unit: ms"
        text = (MAPS / "modbus.yaml").read_text(encoding="utf-8")
        self.assertIn(before, text)
        machine.write_text(f"include: {CONTROLLER.parents[1] / 'cranes' / 'thesis.yaml'}\n", encoding="utf-8")
        for timeout, unit in ((300, "ms"), (0.1, "s")):
            plc_map.write_text(text.replace(before, f"timeout: {{value: {timeout}, unit: {unit}"), encoding="utf-8")
            said = self.refusal("modbus", plc_map, 2, SLEWLAB_REALTIME_SPEED="1", SLEWLAB_CONTROLLER_CONFIG=str(self.folder / "controller.yaml"))
            found = f"{timeout if unit == 'ms' else 1e3 * timeout:g} ms"
            self.assertIn(f"slow.yaml:10: key 'timeout': found {found}, expected less than 100 ms, which is drive_protection.silence_timeout of this "
                          "run's machine", said)
            self.assertIn("thesis.yaml:85", said)

    def test_a_controller_of_other_groups_than_the_maps_is_refused_at_the_start(self):
        one, plc_map = self.folder / "one.yaml", MAPS / "modbus.yaml"
        one.write_text(f"include: {CONTROLLER}\ngroups: {{value: 1, unit: '-', source: test}}\n", encoding="utf-8")
        ended = subprocess.run([SLEWLAB, "soft-plc", "--map", plc_map, "--controller", one], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                               timeout=PATIENCE, check=False)
        self.assertEqual((ended.returncode, ended.stderr),
                         (2, f"{one}: found a controller of 1 motor group(s), expected one of 2, as {plc_map} has\n"))

    def check_plc_refuses(self, protocol, *changes):
        """The PLC has the map's variables, the bridge asks for others."""
        plc_map = MAPS / f"{protocol}_ticked.yaml"
        text = plc_map.read_text(encoding="utf-8")
        other = self.folder / f"other_{protocol}.yaml"
        with soft_plc(plc_map):
            for before, after, expected in changes:
                self.assertIn(before, text)
                other.write_text(text.replace(before, after), encoding="utf-8")
                self.assertIn(expected, self.refusal(protocol, other, 1))

    def test_a_node_that_the_plc_does_not_have_is_named(self):
        self.check_plc_refuses("opcua", ("Slewing.Torque1", "Slewing.Torq1", "does not know the node ns=2;s=Slewing.Torq1 of motor_torque"),
                               ('Mode", type: int16', 'Mode", type: int32', "of mode is a int16, the map says int32"))

    def test_a_symbol_that_the_plc_does_not_have_is_named(self):
        self.check_plc_refuses("ads", ("GVL_Slewing.Torque1", "GVL_Slewing.Torq1", "has no symbol GVL_Slewing.Torq1, where the map has motor_torque"),
                               ("Mode, type: int16", "Mode, type: int32", "of mode is a INT, the map says int32 (DINT)"))

    def test_a_register_that_the_plc_does_not_have_is_named(self):
        self.check_plc_refuses("modbus", ("at: input 40", "at: input 4000", "refused input 4000 to 4003 of unit 1: it has no such address"))


if __name__ == "__main__":
    unittest.main()
