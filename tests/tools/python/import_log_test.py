"""The identity of an import's log, and the ranges that are told of it."""

import tempfile
import unittest
from pathlib import Path

import numpy as np

from import_log import Ranges, configuration_hash, identity_of


class ImportLogTest(unittest.TestCase):
    def test_configuration_hash_is_fnv_1a(self):
        """Test vectors of its authors (Fowler, Noll, Vo): of nothing, "a" and "foobar"; as signed numbers."""
        for text, value in (("", 0xCBF29CE484222325), ("a", 0xAF63DC4C8601EC8C), ("foobar", 0x85944171F73967E8)):
            self.assertEqual(configuration_hash(text) % (1 << 64), value)
            self.assertLess(abs(configuration_hash(text)), 1 << 63)

    def test_identity_is_of_what_the_file_holds_and_never_nobodys(self):
        with tempfile.TemporaryDirectory() as folder:
            one, same, other = (Path(folder) / name for name in ("one", "same", "other"))
            one.write_text("a,b")
            same.write_text("a,b")
            other.write_text("a,c")
            self.assertEqual(identity_of(one), identity_of(same))
            self.assertNotEqual(identity_of(one), identity_of(other))
            self.assertNotEqual(identity_of(one), 0)

    def test_ranges_go_on_from_stretch_to_stretch(self):
        ranges = Ranges()
        ranges.add(0, {"shaft_speed": [np.array([1.0, 3.0])], "speed_request": [np.array([0.0, -0.5])]})
        ranges.add(2, {"shaft_speed": [np.array([-2.0, 2.0])], "speed_request": [np.array([0.4, 0.3])]})
        self.assertEqual(ranges.of["shaft_speed", 0], (-2.0, 3.0))
        self.assertEqual((ranges.largest_request, ranges.at), (0.5, 1))


if __name__ == "__main__":
    unittest.main()
