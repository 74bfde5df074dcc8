"""The machine here goes 1 rad/s with a gear of 100 and 10 N m at its motor."""

import unittest
from types import SimpleNamespace

from import_plausibility import fitting, warnings
from machine import Axis

MACHINE = Axis(False, False, 100.0, True, 1.0, 10.0)


def said(field, unit, low, high, machine=MACHINE, column="c"):
    entry = SimpleNamespace(name=f"{field}[1]", column=column, column_unit=unit, unit="SI")
    return warnings(SimpleNamespace(machine=machine, signals={field: [entry]}), {(field, 0): (low, high)}, duration=20.0)


class PlausibilityTest(unittest.TestCase):
    def test_what_the_machine_can_do_is_no_slip(self):
        for field, low, high in (("shaft_speed", -100.0, 90.0), ("shaft_speed", 0.0, 0.2), ("motor_torque", -10.0, 49.0), ("motor_torque", 0.0, 0.0),
                                 ("shaft_position", 5000.0, 5600.0), ("slew_angle", 3.0, 3.01), ("speed_request", 0.0, 1e9)):
            with self.subTest(field, high=high):
                self.assertEqual(said(field, "rad", low, high), {})

    def test_without_a_machine_or_its_numbers_nothing_is_said(self):
        self.assertEqual(said("shaft_speed", "rad/s", 0.0, 1e9, machine=None), {})
        self.assertEqual(said("shaft_speed", "rad/s", 0.0, 1e9, machine=Axis(False, False, 100.0, True)), {})
        self.assertEqual(said("shaft_speed", "", 0.0, 1e9, column=None), {})

    def test_too_much_and_too_little_are_said_with_column_and_unit(self):
        self.assertIn("column 'c' in kN m: 5e+03 SI, 500 times the machine's largest torque (10 SI); N m would fit",
                      said("motor_torque", "kN m", -5000.0, 10.0)["motor_torque[1]"])
        self.assertIn("only 0.0005 of the machine's largest torque (10 SI); kN m would fit", said("motor_torque", "N m", 0.0, 0.005)["motor_torque[1]"])
        self.assertIn("no other unit of it would fit", said("motor_torque", "N m", 0.0, 1e30)["motor_torque[1]"])

    def test_units_that_fit_are_those_in_which_the_numbers_are_the_machines(self):
        self.assertEqual(fitting("m", 125.0), ["mm"])
        self.assertEqual(fitting("rad/s", 57.0), ["mrad/s", "deg/s"])


if __name__ == "__main__":
    unittest.main()
