import math
import re
import unittest

import unit
from run_log import REPOSITORY

NAMES = {"number": "none", "time": "second", "frequency": "hertz", "length": "metre", "speed": "metre_per_second",
         "acceleration": "metre_per_second_squared", "angle": "radian", "angular speed": "radian_per_second",
         "force": "newton", "torque": "newton_metre"}


class UnitTest(unittest.TestCase):
    def test_the_spellings_are_those_of_the_crane_files(self):
        source = (REPOSITORY / "common" / "unit.cpp").read_text()
        numbers = {"kDegree": math.pi / 180, "kTurnPerMinute": 2 * math.pi / 60, "1.0 / 3.6": 1 / 3.6}
        table = {}
        for name, text, factor in re.findall(r'\{Unit::(\w+), "([^"]*)", ([^}]*)\}', source):
            table.setdefault(name, {})[text] = numbers[factor] if factor in numbers else float(factor)
        for quantity, spellings in unit.SPELLINGS.items():
            self.assertEqual(spellings, table[NAMES[quantity]], quantity)

    def test_blanks_and_signs_do_not_matter(self):
        self.assertEqual(unit.factor_to_si("torque", "kN·m"), 1e3)
        self.assertEqual(unit.factor_to_si("acceleration", "mm/s²"), 1e-3)
        self.assertIsNone(unit.factor_to_si("torque", "kN"))
