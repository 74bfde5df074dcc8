"""Cranes of another simulator as a PLC's recorder would give them (100 Hz, some begun with the drives on, some without accelerometers),
diagnosed against the thesis's crane without their controller. What is expected is the truth that their README tells."""

import unittest

from run_log import REPOSITORY
from shared_data import SharedDataTest

MAPS = REPOSITORY / "tests" / "diagnosis" / "other_simulator"
NOMINAL = REPOSITORY / "config" / "cranes" / "thesis.yaml"
SURE = 0.9


class OtherSimulatorTest(SharedDataTest):
    def answer(self, crane, map_name):
        self.need_data()
        logs = [self.imported(MAPS / map_name, f"other_simulator/{crane}", record) for record in ("fit_1", "fit_2")]
        unseen = self.imported(MAPS / map_name, f"other_simulator/{crane}", "unseen")
        return self.diagnosed("--crane", NOMINAL, logs, self.folder / crane, "--unseen", unseen)

    def check_on_unseen(self, found):
        """What is stated holds on the record that had no part in it: the first cause, or parameters within their spread, has a smaller residual
        than the nominal machine, as a right answer has on any manoeuvre."""
        unseen = found["unseen"][0]
        left = unseen["validation"]["cause"]["residual_variance_ratio"]
        self.assertLess(left, unseen["validation"]["nominal"]["residual_variance_ratio"])
        torque = unseen["missing_torque_rms_nm"]
        self.assertLess(torque["cause"], torque["nominal"])
        if found["gap"]:
            self.assertTrue(unseen["validation"]["holds"], found["verdict"])

    def test_nothing_is_missing_where_nothing_is(self):
        for crane, map_name in (("a", "four.yaml"), ("b", "encoders.yaml")):
            with self.subTest(crane=crane):
                found = self.answer(crane, map_name)
                self.assertFalse(found["gap"], found["verdict"])
                self.assertEqual(found["causes"][0]["effects"], [])

    def test_viscous_friction_of_the_bearing_is_named_with_its_size(self):
        found = self.answer("c", "tip.yaml")
        first = found["causes"][0]
        self.assertEqual(first["effects"], ["bearing_viscous"], found["verdict"])
        self.assertGreater(found["effects"]["bearing_viscous"], SURE)  # alone, or beside what these records may hide
        self.assertTrue(first["validation"]["holds"])
        size = first["sizes"][0]
        self.assertLess(size["low_90"], 4e6)  # the README's 4e6 Nms/rad
        self.assertGreater(size["high_90"], 4e6)
        self.check_on_unseen(found)

    def test_a_torque_that_lags_is_named_beside_a_heavier_load(self):
        found = self.answer("d", "four.yaml")
        first = found["causes"][0]
        self.assertIn("torque_lag", first["effects"], found["verdict"])
        self.assertGreater(found["effects"]["torque_lag"], SURE)
        self.assertTrue(any(cause["effects"] == ["torque_lag", "load_mass"] or cause["effects"] == ["load_mass", "torque_lag"]
                            for cause in found["causes"][:2]), found["verdict"])
        self.assertTrue(first["validation"]["holds"])
        self.check_on_unseen(found)

    def test_machines_whose_truth_is_withheld_get_an_answer_that_predicts_what_it_has_not_seen(self):
        for crane, map_name in (("e", "four.yaml"), ("f", "tip.yaml"), ("g", "encoders.yaml"), ("h", "four.yaml"), ("i", "tip.yaml")):
            with self.subTest(crane=crane):
                found = self.answer(crane, map_name)
                self.assertLess(found["probability_unknown"], 0.5, found["verdict"])
                self.check_on_unseen(found)


if __name__ == "__main__":
    unittest.main()
