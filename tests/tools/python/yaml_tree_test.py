import tempfile
import unittest
from pathlib import Path

import yaml

from run_log import REPOSITORY
from yaml_tree import file_text, flow, read_yaml


class YamlTreeTest(unittest.TestCase):
    def test_a_file_is_read_as_another_reader_of_yaml_reads_it(self):
        # PyYAML takes 2.52e5 for text (YAML 1.1), so no file with such a number.
        for name in ("scenarios/thesis_slew.yaml", "controllers/thesis.yaml", "axes/example_axis.yaml"):
            path = REPOSITORY / "config" / name
            with self.subTest(name=name):
                self.assertEqual(read_yaml(path), yaml.safe_load(path.read_text()))

    def test_what_is_written_is_read_back_as_it_was_by_both(self):
        moves = [{"time": {"value": 0.01 * number, "unit": "s", "source": "chosen: at the desk"}, "stop": {"value": bool(number), "source": "a \"b\": {c}"}}
                 for number in range(2)]
        keys = {"include": "scenario.yaml", "description": "Über: # alles, [x]", "duration": {"value": 12.5, "unit": "s", "source": "y"}, "operator": moves,
                "faults": None, "play_compensation": {"switches": moves}, "empty": []}
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.yaml"
            (path.with_name("scenario.yaml")).write_text("kind: scenario\n")
            path.write_text(file_text(keys), encoding="utf-8")
            read = read_yaml(path)
            self.assertEqual(yaml.safe_load(path.read_text(encoding="utf-8")), keys)
        self.assertEqual(read, {"kind": "scenario"} | {key: value for key, value in keys.items() if key != "include"})
        self.assertEqual(yaml.safe_load(flow(keys)), keys)
        self.assertNotIn("\n", flow(keys))

    def test_what_is_wrong_is_told_with_its_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.yaml"
            path.write_text("kind: crane\nkind: axis\n")
            with self.assertRaisesRegex(ValueError, "a.yaml:2"):
                read_yaml(path)


if __name__ == "__main__":
    unittest.main()
