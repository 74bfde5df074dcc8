import math
import unittest

import unit


class UnitTest(unittest.TestCase):
    def test_factors_lead_to_si_and_the_si_unit_stands_first(self):
        self.assertEqual(unit.SPELLINGS["torque"], {"N m": 1.0, "kN m": 1e3, "MN m": 1e6, "N cm": 1e-2, "mN m": 1e-3})
        self.assertAlmostEqual(unit.factor_to_si("angular speed", "rpm"), 2 * math.pi / 60, places=15)
        for quantity, si in unit.SI.items():
            self.assertEqual(next(iter(unit.SPELLINGS[quantity].items())), (si, 1.0))

    def test_blanks_and_signs_do_not_matter(self):
        self.assertEqual(unit.factor_to_si("torque", "kN·m"), 1e3)
        self.assertEqual(unit.factor_to_si("acceleration", "mm/s²"), 1e-3)
        self.assertIsNone(unit.factor_to_si("torque", "kN"))
