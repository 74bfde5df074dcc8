"""The cranes of another simulator whose truth their README tells, as a recorder would have them that writes down every fifth command of a PLC of 10 ms:
the other commands act, and nobody knows them."""

import unittest

from run_log import REPOSITORY
from shared_data import DATA, SharedDataTest

MAP = REPOSITORY / "tests" / "diagnosis" / "other_simulator" / "four.yaml"
NOMINAL = REPOSITORY / "config" / "cranes" / "thesis.yaml"
EVERY = 5  # rows


class SlowRecorderTest(SharedDataTest):
    def thinned(self, crane, record):
        """The log of every fifth row."""
        lines = (DATA / "other_simulator" / crane / f"{record}.csv").read_text().splitlines(keepends=True)
        table = self.folder / f"{crane}_{record}.csv"
        table.write_text("".join([lines[0], *lines[1::EVERY]]))
        slow = self.folder / "slow.yaml"
        slow.write_text(MAP.read_text().replace("{value: 100, unit: Hz", f"{{value: {100 // EVERY}, unit: Hz"))
        return self.imported_from(slow, table)

    def answer(self, crane):
        self.need_data()
        logs = [self.thinned(crane, record) for record in ("fit_1", "fit_2")]
        return self.diagnosed("--crane", NOMINAL, logs, self.folder / crane, "--unseen", self.thinned(crane, "unseen"))

    def test_nothing_is_missing_where_nothing_is(self):
        found = self.answer("a")
        self.assertFalse(found["gap"], found["verdict"])
        self.assertEqual(found["causes"][0]["effects"], [])
        self.assertGreater(found["commands_per_row"], 1)
        self.assertTrue(any("faster than the recorder" in remark for remark in found["remarks"]))

    def test_a_torque_that_lags_is_named_beside_a_heavier_load(self):
        found = self.answer("d")
        first = found["causes"][0]
        self.assertEqual(sorted(first["effects"]), ["load_mass", "torque_lag"], found["verdict"])
        self.assertGreater(found["commands_per_row"], 1)
        self.assertTrue(first["validation"]["holds"])
        self.assertTrue(found["unseen"][0]["validation"]["holds"], found["verdict"])


if __name__ == "__main__":
    unittest.main()
