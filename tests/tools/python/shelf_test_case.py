"""A test with a folder and a shelf of columns in it, both gone behind it."""

import tempfile
import unittest
from pathlib import Path

from column_shelf import Shelf


class ShelfTestCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.shelf = Shelf(self.folder)
        self.addCleanup(self.shelf.close)
