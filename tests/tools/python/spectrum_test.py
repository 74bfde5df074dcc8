import unittest

import numpy as np

from spectrum import amplitude_spectrum, find_peaks

STEP = 0.005  # [s]
SEGMENT = 5.0  # [s]
TIME = np.arange(0.0, 30.0, STEP)


class SpectrumTest(unittest.TestCase):
    def peaks(self, series, share=0.1, floor=0.0):
        return find_peaks(*amplitude_spectrum(series, STEP, SEGMENT), 0.5, 45.0, share, floor)

    def test_a_sine_shows_its_frequency_and_amplitude(self):
        # Between the bins of the zero-padded transform; the parabola's error stays below 1 % of both.
        for frequency in (0.9, 1.31, 5.24, 13.2, 37.0):
            (found,) = self.peaks(2.5 * np.sin(2 * np.pi * frequency * TIME + 0.3))
            self.assertAlmostEqual(found[0], frequency, delta=0.01 * frequency)
            self.assertAlmostEqual(found[1], 2.5, delta=0.01 * 2.5)

    def test_peaks_come_largest_first_and_the_share_and_the_floor_hold(self):
        series = 0.2 * np.sin(2 * np.pi * 1.3 * TIME) + np.sin(2 * np.pi * 5.2 * TIME)
        self.assertEqual([round(f, 1) for f, _ in self.peaks(series)], [5.2, 1.3])
        self.assertEqual([round(f, 1) for f, _ in self.peaks(series, share=0.5)], [5.2])
        self.assertEqual(self.peaks(series, floor=2.0), [])

    def test_mean_and_trend_are_no_peaks(self):
        self.assertEqual(self.peaks(7.0 + 0.3 * TIME, floor=1e-9), [])

    def test_a_series_shorter_than_a_segment_still_has_a_spectrum(self):
        (found,) = self.peaks(np.sin(2 * np.pi * 5.0 * TIME[:400]))
        self.assertAlmostEqual(found[0], 5.0, delta=0.05)
        self.assertEqual(len(amplitude_spectrum(TIME[:10], STEP, SEGMENT)[0]), 0)


if __name__ == "__main__":
    unittest.main()
