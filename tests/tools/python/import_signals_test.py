"""What columns give from instant to instant: resampled, and derived, against closed forms."""

import unittest

import numpy as np

from import_grid import Grid
from import_signals import DerivedSpeed, Resampled
from shelf_test_case import ShelfTestCase


class ResampledTest(ShelfTestCase):
    def setUp(self):
        super().setUp()
        self.seconds = self.shelf.column()
        self.seconds.append(0.01 * np.arange(101))

    def resampled(self, values, period, how, holds):
        column = self.shelf.column()
        column.append(values)
        grid = Grid(0.0, period, round(1.0 / period) + 1, False)
        return Resampled(column.read, self.seconds, grid, how, holds, self.shelf)(0, len(grid)), period * np.arange(len(grid))

    def test_linear_passes_between_rows_and_holds_commands(self):
        ramp = 3.0 * 0.01 * np.arange(101)
        values, at = self.resampled(ramp, 0.004, "linear", False)
        np.testing.assert_allclose(values, 3.0 * at, atol=1e-12)
        values, at = self.resampled(ramp, 0.004, "linear", True)
        np.testing.assert_allclose(values, 0.03 * np.floor(at / 0.01 + 1e-6), atol=1e-12)

    def test_the_mean_of_a_ramp_is_its_middle(self):
        """Over [t - T/2, t + T/2]; at the ends over the half of it that there is."""
        values, at = self.resampled(3.0 * 0.01 * np.arange(101), 0.04, "mean", False)
        np.testing.assert_allclose(values[1:-1], 3.0 * at[1:-1], atol=1e-12)
        np.testing.assert_allclose(values[[0, -1]], [3.0 * 0.01, 3.0 * 0.99], atol=1e-12)

    def test_the_mean_of_a_command_is_over_the_period_in_which_it_holds(self):
        values, _ = self.resampled(np.where(np.arange(101) < 6, 0.0, 1.0), 0.04, "mean", True)
        np.testing.assert_allclose(values[:4], [0.0, 0.5, 1.0, 1.0], atol=1e-12)


class DerivedSpeedTest(unittest.TestCase):
    def test_each_formula_of_a_parabola(self):
        """Of t^2: 2t at the instant, T/2 earlier, T earlier."""
        period, count = 0.1, 20
        position = (period * np.arange(count)) ** 2
        for how, late in (("central_difference", 0.0), ("backward_difference", period / 2), ("two_sample_mean", period)):
            whole = DerivedSpeed(lambda begin, end: position[begin:end], period, how, count)
            np.testing.assert_allclose(whole(0, count)[2:-1], 2.0 * (period * np.arange(count)[2:-1] - late), atol=1e-12)
            np.testing.assert_array_equal(np.concatenate([whole(0, 7), whole(7, count)]), whole(0, count))


if __name__ == "__main__":
    unittest.main()
