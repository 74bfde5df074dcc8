import tempfile
import unittest
from pathlib import Path

import made_run
from not_finite import places
from run_log import RunLog


class NotFiniteTest(unittest.TestCase):
    def found(self, change):
        events = made_run.messages()
        for channel, time, message in events:
            change(channel, time / 1e9, message)
        with tempfile.TemporaryDirectory() as folder:
            made_run.write_log(Path(folder) / "run.lcmlog", events)
            return places(RunLog(Path(folder) / "run.lcmlog"))

    def test_a_sound_log_has_none(self):
        self.assertEqual(self.found(lambda *_: None), [])

    def test_one_of_a_group_and_an_infinite_one_are_counted_with_their_first_moment(self):
        def change(channel, time, message):
            if channel == "ENCODER" and 3.0 <= time < 3.05:
                message.shaft_speed = [100.0, float("nan")]
            if channel == "SENSORS" and time == 7.0:
                message.house_acceleration = float("-inf")

        self.assertEqual(sorted(self.found(change)), [("ENCODER", "shaft_speed", 5, 2000, 3.0), ("SENSORS", "house_acceleration", 1, 4001, 7.0)])

    def test_the_last_bin_of_a_histogram_has_no_upper_edge(self):
        events = made_run.messages()
        status = made_run.types.plant_status_t()
        status.simulated_time, status.configuration_hash, status.run_identity = 1_000_000_000, made_run.HASH, made_run.RUN
        status.bin_count, status.bin_edge, status.wakeup_latency, status.step_time = 2, [1e-6, float("inf")], [3, 0], [3, 0]
        with tempfile.TemporaryDirectory() as folder:
            made_run.write_log(Path(folder) / "run.lcmlog", [*events, ("PLANT_STATUS", status.simulated_time, status)])
            log = RunLog(Path(folder) / "run.lcmlog")
            self.assertTrue(log.has("PLANT_STATUS"))
            self.assertEqual(places(log), [])

    def test_what_is_never_there_is_not_fitted(self):
        def change(channel, _, message):
            if channel == "SENSORS":
                message.slew_angle = float("nan")

        self.assertEqual(self.found(change), [])


if __name__ == "__main__":
    unittest.main()
