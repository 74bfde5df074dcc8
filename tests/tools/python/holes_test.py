"""Holes of times that are known, however the times are cut into pieces."""

import unittest

import numpy as np

from holes import Holes


def found(time, piece, **options):
    holes = Holes(**options)
    for first in range(0, len(time), piece):
        holes.add(time[first:first + piece])
    return [(round(before, 6), round(behind, 6)) for before, behind in holes.found]


class HolesTest(unittest.TestCase):
    def test_a_step_of_more_than_five_usual_ones_is_a_hole(self):
        time = np.concatenate((np.arange(0.0, 5.0, 0.01), np.arange(8.0, 20.0, 0.01)))
        time = np.delete(time, [100, 200, 201, 202, 203])  # one message lost, four in a row: neither is a hole
        for piece in (3, 70, 5000):
            with self.subTest(piece=piece):
                self.assertEqual(found(time, piece), [(4.99, 8.0)])
                self.assertEqual(found(np.delete(time, 204 - 5), piece), [(1.99, 2.05), (4.99, 8.0)])  # a fifth one

    def test_times_that_jitter_hold_no_hole_where_four_are_lost(self):
        time = np.arange(2000) * 0.01 + np.random.default_rng(1).uniform(-0.002, 0.002, 2000)
        self.assertEqual(found(np.delete(time, np.r_[500:504, 900:904, 1300:1304]), 100), [])

    def test_however_much_is_missing_what_is_usual_stays(self):
        time = np.concatenate([begin + np.arange(20) * 0.01 for begin in range(0, 50)])  # a fifth of a second of each
        self.assertEqual(found(time, 400), [(round(k + 0.19, 6), k + 1.0) for k in range(49)])

    def test_a_clock_that_is_set_back_makes_no_hole(self):
        self.assertEqual(found(np.concatenate((np.arange(0.0, 5.0, 0.01), np.arange(2.0, 4.0, 0.01))), 70), [])

    def test_what_nobody_sees_and_what_is_old_is_not_kept(self):
        time = np.concatenate([begin + np.arange(20) * 0.01 for begin in (0, 1, 2, 30)])
        self.assertEqual(found(time, 20, least=5.0), [(2.19, 30.0)])
        self.assertEqual(found(time, 20, most=2), [(1.19, 2.0), (2.19, 30.0)])

    def test_of_a_few_times_nobody_knows_what_is_usual(self):
        self.assertEqual(found(np.array([0.0, 0.1, 0.2, 10.0]), 4), [])


if __name__ == "__main__":
    unittest.main()
