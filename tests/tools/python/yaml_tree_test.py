import tempfile
import unittest
from pathlib import Path

import yaml

from run_log import REPOSITORY
from yaml_tree import read_yaml


class YamlTreeTest(unittest.TestCase):
    def test_a_file_is_read_as_another_reader_of_yaml_reads_it(self):
        # PyYAML takes 2.52e5 for text (YAML 1.1), so no file with such a number.
        for name in ("scenarios/thesis_slew.yaml", "controllers/thesis.yaml", "axes/example_axis.yaml"):
            path = REPOSITORY / "config" / name
            with self.subTest(name=name):
                self.assertEqual(read_yaml(path), yaml.safe_load(path.read_text()))

    def test_what_is_wrong_is_told_with_its_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.yaml"
            path.write_text("kind: crane\nkind: axis\n")
            with self.assertRaisesRegex(ValueError, "a.yaml:2"):
                read_yaml(path)


if __name__ == "__main__":
    unittest.main()
