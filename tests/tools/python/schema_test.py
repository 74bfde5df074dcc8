"""`slewlab schema` against the files of config/ and against `slewlab check`."""

import copy
import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import jsonschema
import yaml

from core_module import core
from run_log import REPOSITORY, messages_folder

PROGRAM = messages_folder().parent / "bin" / "slewlab"


class CoreLoader(yaml.SafeLoader):
    """Values as YAML 1.2 has them, as common/yaml_node reads them: 1e-3 is a number, on is a word."""


CoreLoader.yaml_implicit_resolvers = {
    first: [(tag, form) for tag, form in resolvers if tag != "tag:yaml.org,2002:bool"] for first, resolvers in CoreLoader.yaml_implicit_resolvers.items()}
CoreLoader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(true|false)$"), list("tf"))
CoreLoader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"), list("-+.0123456789"))


def load(path):
    return yaml.load(path.read_text(encoding="utf-8"), Loader=CoreLoader)


def schema_of(kind):
    ended = subprocess.run([PROGRAM, "schema", kind], capture_output=True, text=True, check=True)
    return json.loads(ended.stdout)


class SchemaTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.validators = {kind: jsonschema.Draft202012Validator(schema_of(kind))
                          for kind in ("crane", "axis", "controller", "scenario", "acceptance", "acceptance_plan", "campaign", "soak", "plc_map")}

    def complaints(self, tree):
        return [error.json_path + ": " + error.message for error in self.validators[tree["kind"]].iter_errors(tree)]

    def test_every_file_of_slewlab_keeps_to_its_schema(self):
        kinds = set()
        for path in sorted((REPOSITORY / "config").rglob("*.yaml")):
            tree = load(path)
            if "kind" not in tree:  # lies over another file, whose kind it has
                self.assertIn("include", tree)
                tree["kind"] = load(path.parent / tree["include"]).get("kind", path.parent.name.rstrip("s"))
            kinds.add(tree["kind"])
            with self.subTest(file=path.name):
                self.assertEqual(self.complaints(tree), [])
        self.assertEqual(kinds, set(self.validators))

    def test_maps_keep_to_theirs_as_their_reader_has_it(self):
        validator = jsonschema.Draft202012Validator(schema_of("import_map"))
        jsonschema.Draft202012Validator.check_schema(validator.schema)
        blocks = [block for page in ("import.md", "axis.md") for block in
                  re.findall(r"```yaml\n(.*?)```", (REPOSITORY / "docs" / page).read_text(encoding="utf-8"), re.DOTALL)
                  if "kind: import_map" in block]
        self.assertEqual(len(blocks), 2)
        for block in blocks:
            tree = yaml.load(block, Loader=CoreLoader)
            self.assertEqual([error.json_path + ": " + error.message for error in validator.iter_errors(tree)], [])

            def refused(change, tree=tree):
                changed = copy.deepcopy(tree)
                change(changed)
                return " ".join(str(error) for error in validator.iter_errors(changed))

            self.assertIn("'timme' was unexpected", refused(lambda t: t.update(timme=t["time"])))
            self.assertIn("'motor_torque' is a required property", refused(lambda t: t.pop("motor_torque")))
            self.assertIn("'lb' is not one of", refused(lambda t: t["time"].update(unit="lb")))
            torque = tree["motor_torque"][0] if isinstance(tree["motor_torque"], list) else tree["motor_torque"]
            for unit in ("Nm", "N*m", "N m", "kNm"):
                torque["unit"] = unit
                self.assertEqual([error.message for error in validator.iter_errors(tree)], [])
            torque["unit"] = "N-m"
            self.assertFalse(validator.is_valid(tree))

    def test_what_check_refuses_of_form_the_schema_refuses_too(self):
        crane = load(REPOSITORY / "config" / "cranes" / "thesis.yaml")
        self.assertEqual(self.complaints(crane), [])

        def refused(change):
            tree = copy.deepcopy(crane)
            change(tree)
            return "\n".join(self.complaints(tree))

        def rename(tree):
            tree["load"]["mas"] = tree["load"].pop("mass")

        self.assertIn("'mas' was unexpected", refused(rename))
        self.assertIn("'lb' is not one of ['kg', 't']", refused(lambda tree: tree["load"]["mass"].update(unit="lb")))
        self.assertIn("'source' is a required property", refused(lambda tree: tree["load"]["mass"].pop("source")))
        self.assertIn("-3 is less than the minimum of 0", refused(lambda tree: tree["load"]["mass"].update(value=-3)))
        self.assertIn("9 is greater than the maximum of 8", refused(lambda tree: tree["drive"]["groups"].update(value=9)))
        self.assertIn("'drive' is a required property", refused(lambda tree: tree.pop("drive")))
        self.assertNotEqual(refused(lambda tree: tree.update(effects=[{"effect": "dead_tim"}])), "")

    def test_units_are_taken_in_every_way_that_the_reader_takes(self):
        axis = {"kind": "crane", "include": "thesis.yaml"}
        ways = (("house", "inertia", "kg m^2", ("kgm²", "kg*m^2", "kg·m²", "t m^2")), ("boom", "angle", "deg", ("°", "rad")),
                ("drive", "gearbox_stiffness", "kN m/rad", ("kNm/rad", "kN m / rad")), ("load", "mass", "kg", ("t",)),
                ("drive", "rated_torque", "N m", ("Nm", "N·m", "mNm")))
        for section, key, first, others in ways:
            for unit in (first, *others):
                with self.subTest(unit=unit):
                    self.assertEqual(self.complaints(axis | {section: {key: {"value": 1, "unit": unit, "source": "test"}}}), [])
                    self.assertIsNotNone(core.factor(unit, first))
        for section, key, unit in (("drive", "rated_torque", "N-m"), ("house", "inertia", "kg m^3"), ("boom", "angle", "degree")):
            self.assertNotEqual(self.complaints(axis | {section: {key: {"value": 1, "unit": unit, "source": "test"}}}), [])

    def test_a_linear_axis_has_units_of_its_own(self):
        def value(number, unit):
            return {"value": number, "unit": unit, "source": "test"}

        axis = {"kind": "axis", "coordinate": {"value": "linear", "source": "test"}, "mass": value(6, "kg"), "motor_mass": value(1, "kg"),
                "transmission": {"stiffness": value(3, "kN/m"), "damping_ratio": value(5, "%"), "play": value(1, "mm")},
                "load": {"constant": value(3, "N")}, "rated_force": value(100, "N"), "top_speed": value(1, "m/s")}
        self.assertEqual(self.complaints(axis), [])
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "axis.yaml"
            file.write_text(json.dumps(axis))
            checked = subprocess.run([PROGRAM, "check", file], capture_output=True, text=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertNotEqual(self.complaints(axis | {"top_speed": value(1, "m")}), [])

    def test_an_unknown_kind_is_named_with_the_near_one(self):
        ended = subprocess.run([PROGRAM, "schema", "crnae"], capture_output=True, text=True, check=False)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("KIND: found 'crnae', expected 'crane' (or one of crane, axis, ", ended.stderr)


if __name__ == "__main__":
    unittest.main()
