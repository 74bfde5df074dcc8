"""An import's map: its keys, and the factor that leads from a column to its signal of the wire."""

import tempfile
import unittest
import unittest.mock
from pathlib import Path

import import_map
import signals
from import_data_test import MAP
from run_log import REPOSITORY


class ImportMapTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def read(self, text):
        (self.folder / "map.yaml").write_text(text)
        return import_map.read_map(self.folder / "map.yaml")

    def test_factors_are_those_of_unit_ratio_motors_and_sign(self):
        mapping = self.read(MAP)
        self.assertEqual(mapping.lines, [])
        degree = 3.141592653589793 / 180
        self.assertAlmostEqual(mapping.signals["shaft_position"][0].factor, degree * 2735.58, places=12)
        self.assertAlmostEqual(mapping.signals["shaft_position"][1].factor, -degree * 2735.58, places=12)
        self.assertAlmostEqual(mapping.signals["motor_torque"][0].factor, 1e3 / (2735.58 * 3), places=12)
        self.assertEqual((mapping.signals["motor_torque"][1].factor, mapping.signals["motor_torque"][1].offset), (50.0, 2.0))
        self.assertEqual(mapping.signals["shaft_speed"][1].derive, "central_difference")
        self.assertAlmostEqual(mapping.period, 0.01)

    def test_a_sensor_of_the_wire_is_one_of_the_map(self):
        """What SENSORS says is what a map may name: nothing lists the sensors a second time."""
        known = {channel: dict(fields) for channel, fields in signals.table().items()}
        known["SENSORS"] |= {"mast_acceleration": "m/s^2", "mast_angle": "rad"}
        text = MAP + "mast_acceleration: {column: a, unit: mm/s^2}\nmast_angle: {column: b, unit: deg}\n"
        with unittest.mock.patch.object(signals, "table", lambda: known):
            mapping = self.read(text)
        self.assertEqual(mapping.lines, [])
        self.assertEqual([(mapping.signals[name][0].column, mapping.signals[name][0].unit) for name in ("mast_acceleration", "mast_angle")],
                         [("a", "m/s^2"), ("b", "rad")])
        self.assertNotEqual(self.read(text).lines, [])

    def test_control_characters_are_shown_and_not_sent_to_the_terminal(self):
        lines = self.read(MAP + '"gear\\e[31mbox": "\\u009b1m"\n').lines
        self.assertEqual([line for line in lines if "\x1b" in line or "\x9b" in line], [])
        self.assertTrue(any("key 'gear\\x1b[31mbox'" in line for line in lines), lines)

    def test_the_map_printed_in_the_documents_is_one(self):
        printed = (REPOSITORY / "docs" / "import.md").read_text().split("```yaml\n")[1].split("```")[0]
        self.assertEqual(self.read(printed).lines, [])


if __name__ == "__main__":
    unittest.main()
