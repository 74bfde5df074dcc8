"""The columns that a map names, as numbers on disk."""

import unittest

import numpy as np

import import_map
import import_table
from input_map import InputProblems
from import_data_test import MAP
from shelf_test_case import ShelfTestCase


class ImportTableTest(ShelfTestCase):
    def read(self, csv, more=""):
        (self.folder / "data.csv").write_text(csv)
        (self.folder / "map.yaml").write_text(MAP + more)
        self.mapping = import_map.read_map(self.folder / "map.yaml")
        self.assertEqual(self.mapping.lines, [])
        return import_table.read_table(self.mapping, self.folder / "data.csv", self.shelf)

    HEAD = "other,t,angle_1,angle_2,speed_1,torque_1,torque_2,tip,slew,wish,stop\n"

    def rows(self, *times):
        return self.HEAD + "".join(f"x,{t},1,2,3,4,5,6,7,8,9\n" for t in times)

    def test_holds_the_columns_of_the_map_and_no_other(self):
        table = self.read(self.rows(10, 20, 30))
        self.assertEqual(sorted(table.columns), sorted(self.HEAD.strip().split(",")[1:]))
        np.testing.assert_array_equal(table.columns["t"].numbers.read(), [10, 20, 30])
        np.testing.assert_array_equal(table.columns["stop"].numbers.read(), [9, 9, 9])

    def test_rows_are_cut_as_the_map_says(self):
        table = self.read(self.rows(10, 20, 30, 40, 50), "rows: {first: 2, last: 4}\n")
        np.testing.assert_array_equal(table.columns["t"].numbers.read(), [20, 30, 40])

    def test_the_first_cell_without_a_number_is_kept_with_how_many_there_are(self):
        table = self.read(self.rows(10, "soon", 30, "later"))
        wrong = table.columns["t"].wrong
        self.assertEqual((wrong.row, wrong.found, wrong.count), (1, "soon", 2))
        row = import_table.Rows(self.mapping, self.folder / "data.csv")
        self.assertEqual(row(wrong.row), "data row 2 (line 3)")

    def test_a_missing_column_is_told_at_its_line_of_the_map(self):
        with self.assertRaisesRegex(InputProblems, "which data.csv does not have"):
            self.read(self.rows(10, 20, 30).replace("wish", "wash"))


if __name__ == "__main__":
    unittest.main()
