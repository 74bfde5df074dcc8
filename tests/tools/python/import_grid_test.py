"""Times of rows, and the even grid that is made of them."""

import unittest
from pathlib import Path

import numpy as np

import import_grid
import import_map
import import_table
from import_data_test import MAP
from shelf_test_case import ShelfTestCase


class ImportGridTest(ShelfTestCase):
    def grid(self, milliseconds, text=MAP):
        """None where there is a complaint, which stands in self.lines then."""
        (self.folder / "map.yaml").write_text(text)
        mapping = import_map.read_map(self.folder / "map.yaml")
        self.assertEqual(mapping.lines, [])
        self.lines = mapping.lines
        table = import_table.Table({"t": import_table.NumberColumn(self.shelf)})
        table.columns["t"].numbers.append(milliseconds)
        row = import_table.Rows(mapping, Path("data.csv"))
        seconds = import_grid.times(mapping, table, row, self.shelf)
        return None if seconds is None else import_grid.even_grid(mapping, seconds, row)

    def test_rows_that_miss_the_grid_by_less_than_a_quarter_lie_on_it(self):
        grid = self.grid(5000.0 + 10.0 * np.arange(100) + np.where(np.arange(100) % 3 == 1, 2.4, 0.0))
        self.assertTrue(grid.is_of_rows)
        np.testing.assert_array_equal(grid[0:3], [0, 10_000_000, 20_000_000])
        self.assertEqual((len(grid), grid[-1]), (100, 990_000_000))

    def test_an_uneven_row_is_named_and_resampled_where_that_is_asked_for(self):
        times = 10.0 * np.delete(np.arange(100), 50)
        self.assertIsNone(self.grid(times))
        self.assertIn("20 ms between data row 50 (line 51) and the next where 10 ms is usual", self.lines[0])
        grid = self.grid(times, MAP + "resample: linear\n")
        self.assertFalse(grid.is_of_rows)
        self.assertEqual((len(grid), grid[-1], grid.absent), (100, 990_000_000, 1))

    def test_rows_that_are_missing_are_counted_and_jitter_is_none(self):
        jittering = 10.0 * np.arange(100) + 4.0 * (np.arange(100) % 2)
        self.assertEqual(self.grid(jittering, MAP + "resample: linear\n").absent, 0)
        self.assertEqual(self.grid(10.0 * np.delete(np.arange(100), [20, 21, 50]), MAP + "resample: linear\n").absent, 3)

    def test_times_that_stand_still_are_told_by_their_row(self):
        self.assertIsNone(self.grid(np.array([0.0, 10.0, 20.0, 20.0, 30.0])))
        self.assertIn("20.0 at data row 4 (line 5) after 20.0 in the row before, 1 such rows in all", self.lines[0])


if __name__ == "__main__":
    unittest.main()
