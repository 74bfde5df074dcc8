"""Logs longer than one would like to hold in memory: what is made of them costs no more memory than of a short one, and a
page of them shows every peak."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pyarrow.parquet

import made_run
import report
from envelope import BINS, MOST_POINTS, Envelope, broken, thinned
from event_rows import event_type, fill_heads
from holes import Holes
from run_log import RunLog
from run_numbers import numbers, read_run
from sanitizer import IS_SANITIZED

PERIOD = 1_000_000  # [ns]
PEAK = 7.0          # [m/s^2] of one sample
FIELDS = ("house_acceleration", "pivot_acceleration", "middle_acceleration", "tip_acceleration", "slew_angle")


def write_sensors(path, count, peak_at=None):
    """`count` SENSORS messages at 1 kHz: a slow sine, and one sample that stands out."""
    with open(path, "wb") as stream:
        for begin in range(0, count, 10_000):
            k = np.arange(begin, min(count, begin + 10_000))
            events = np.zeros(len(k), event_type("SENSORS", made_run.types.sensors_t))
            fill_heads(events, "SENSORS", made_run.types.sensors_t, k, k * PERIOD)
            events["sequence"], events["configuration_hash"], events["run_identity"] = k, made_run.HASH, made_run.RUN
            for field in FIELDS:
                events[field] = np.sin(2 * np.pi * 0.7 * k * PERIOD * 1e-9)
            events["tip_acceleration"][k == peak_at] = PEAK
            stream.write(events.tobytes())


class LongLogTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = Path(temporary.name)
        cls.short, cls.long, cls.peak_at = cls.folder / "short.lcmlog", cls.folder / "long.lcmlog", 123_457
        write_sensors(cls.short, 200_000)
        write_sensors(cls.long, 1_000_000, cls.peak_at)
        cls.longer = cls.long.stat().st_size - cls.short.stat().st_size  # [bytes]

    def most_memory(self, code):
        """[bytes] that Python held at most while it ran `code`."""
        code += "\nimport re; print(re.search(r'VmHWM:\\s+(\\d+) kB', open('/proc/self/status').read())[1])"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return int(done.stdout.split()[-1]) * 1024

    @unittest.skipIf(IS_SANITIZED, "a sanitizer keeps what is freed")
    def test_memory_does_not_grow_with_the_log(self):
        out = str(self.folder / "out")
        for module, arguments in (("report", ["--quiet"]), ("export", ["--format", "parquet"]), ("export", ["--format", "csv"]),
                                  ("export", ["--format", "mcap"])):
            with self.subTest(module=module, arguments=arguments):
                name = [*arguments, "--out", out + "_" + arguments[-1].strip("-")]
                short, long = (self.most_memory(f"import {module}\nassert {module}.main({[str(log), *name]}) == 0")
                               for log in (self.short, self.long))
                self.assertLess(long - short, 0.2 * self.longer, (short, long))

    @unittest.skipIf(IS_SANITIZED, "a sanitizer keeps what is freed")
    def test_memory_does_not_grow_with_data_that_are_imported(self):
        (self.folder / "map.yaml").write_text("kind: import_map\ntime: {column: t, unit: s}\nresample: mean\nrate: {value: 900, unit: Hz, source: test}\n"
                                              "shaft_position: [{column: x, unit: rad}]\nshaft_speed: [{derive: central_difference}]\n"
                                              "motor_torque: [{column: f, unit: N m}]\n")
        most = []
        for rows in (500_000, 3_500_000):
            data = self.folder / f"{rows}.parquet"
            with pyarrow.parquet.ParquetWriter(data, pyarrow.schema([(name, pyarrow.float64()) for name in "txf"])) as writer:
                for begin in range(0, rows, 50_000):
                    t = np.arange(begin, begin + 50_000) * 1e-3
                    writer.write_table(pyarrow.table({"t": t, "x": np.sin(t), "f": np.cos(t)}, schema=writer.schema))
            arguments = ["--map", str(self.folder / "map.yaml"), str(data), "--out", str(self.folder / "imported.lcmlog")]
            most.append(self.most_memory(f"import import_data\nassert import_data.main({arguments}) == 0"))
        longer = 3_000_000 * 3 * 8  # [bytes] of the three columns; what a process holds at most differs by some 10 MB from run to run
        self.assertLess(most[1] - most[0], 0.35 * longer, most)

    @unittest.skipIf(IS_SANITIZED, "a sanitizer keeps what is freed")
    def test_the_readers_memory_does_not_grow_with_the_log(self):
        def most(log):
            return self.most_memory("from pathlib import Path\nfrom extension_module import loaded\n"
                                    f"for rows in loaded('_log').LogTables(Path({str(log)!r})).stretches(['SENSORS']): pass")

        self.assertLess(most(self.long) - most(self.short), 0.05 * self.longer)

    def test_a_peak_of_one_sample_stays_in_the_picture_and_in_the_numbers(self):
        run = read_run(self.long)
        self.assertEqual(numbers(run)[""]["peak_tip_acceleration"], PEAK)
        fig = report.figure([run], report.panels([run]))
        (tip,) = [trace for trace in fig.data if trace.name == "tip" and trace.xaxis == "x"]
        self.assertEqual(np.max(tip.y), np.float32(PEAK))
        self.assertEqual(tip.x[np.argmax(tip.y)], np.float32(self.peak_at * PERIOD * 1e-9))
        self.assertTrue(all(len(trace.x) <= MOST_POINTS for trace in fig.data))
        self.assertLess(len(report.page([run], [])), 5_000_000)

    def test_the_log_is_read_as_it_was_written(self):
        log = RunLog(self.long)
        self.assertEqual(log.remarks, [])
        self.assertEqual((log.tables["SENSORS"].rows, log.tables["SENSORS"].last), (1_000_000, 999.999))


class EnvelopeTest(unittest.TestCase):
    def test_a_short_series_stays_as_it_is(self):
        x = np.linspace(0.0, 1.0, MOST_POINTS)
        for drawn, given in zip(thinned(x, x**2), (x, x**2)):
            np.testing.assert_array_equal(drawn, given)

    def test_a_gap_of_a_long_series_is_found_however_it_is_cut_and_no_line_is_drawn_through_it(self):
        x = np.delete(np.arange(100_000) * 1e-3, np.r_[20_000:50_000, 70_000:70_004])  # 30 s; and 4 messages, which are no gap
        for pieces in (1, 313):
            gaps = Holes()
            for part in np.array_split(x, pieces):
                gaps.add(part)
            self.assertEqual(gaps.found, [(19.999, 50.0)])
        time, values = broken(*thinned(x, np.sin(x)), gaps.found)
        (at,) = np.flatnonzero(np.isnan(values))
        np.testing.assert_array_equal(time[at - 1:at + 2], [19.999, 0.5 * (19.999 + 50.0), 50.0])
        # Of a part of the series, whose gap lies outside.
        for part in (x < 10.0, x > 60.0):
            np.testing.assert_array_equal(broken(x[part], np.sin(x[part]), gaps.found)[0], x[part])

    def test_first_lowest_highest_and_last_of_each_bin_stay_however_the_series_is_cut(self):
        draw = np.random.default_rng(1)
        x, y = np.sort(draw.uniform(0.0, 10.0, 50_000)), draw.normal(size=50_000)
        y[::97] = np.nan
        whole = thinned(x, y)
        pieces = Envelope(float(x.min()), float(x.max()), len(x))
        for part in np.array_split(np.arange(len(x)), 313):
            pieces.add(x[part], y[part])
        np.testing.assert_array_equal(whole, pieces.points())
        self.assertTrue(np.all(np.diff(whole[0]) >= 0))
        bins = np.clip((x - x[0]) / ((x[-1] - x[0]) / BINS), 0, BINS - 1).astype(int)
        drawn = set(zip(*whole))
        for b in range(BINS):
            mine = np.flatnonzero((bins == b) & np.isfinite(y))
            for k in (mine[0], mine[-1], mine[np.argmin(y[mine])], mine[np.argmax(y[mine])]):
                self.assertIn((x[k], y[k]), drawn)
        self.assertLessEqual(drawn, set(zip(x, y)))


if __name__ == "__main__":
    unittest.main()
