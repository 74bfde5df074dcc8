"""Spectra of recorded series and the peaks in them."""

import numpy as np

SHORTEST = 16   # [samples] of a segment


class Spectrum:
    """Frequencies [Hz] and amplitudes [unit of the series]: a lasting sine of amplitude a shows a peak of a.

    Welch: segments of `segment` [s], three quarters overlapping, mean and straight trend removed, Hann window,
    zero-padded to four times their length, squared amplitudes averaged. `step` [s] between samples. A series
    shorter than a segment is one segment. What dies out within the series counts with its mean power, so heights
    tell which frequency dominates, not how hard the first blow was. The series comes piece by piece.
    """

    def __init__(self, step, segment):
        self.step, self.length = step, int(round(segment / step))
        self.hop = max(1, self.length // 4)  # from one segment to the next
        self.waiting, self.segments, self.power = np.zeros(0), 0, 0.0

    def add(self, series):
        self.waiting = np.concatenate([self.waiting, np.asarray(series, float)])
        begin = 0
        while self.length >= SHORTEST and begin + self.length <= len(self.waiting):
            self._take(self.waiting[begin : begin + self.length])
            begin += self.hop
        self.waiting = self.waiting[begin:]

    def _take(self, piece):
        length = len(piece)
        index = np.arange(length) - 0.5 * (length - 1)
        straight = piece.mean() + index * (index @ piece / (index @ index))
        window = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
        padded = 1 << int(np.ceil(np.log2(4 * length)))
        self.power = self.power + np.abs(np.fft.rfft((piece - straight) * window, padded)) ** 2
        self.frequency, self.scale = np.fft.rfftfreq(padded, self.step), 2 / window.sum()
        self.segments += 1

    def finish(self):
        if self.segments == 0 and SHORTEST <= len(self.waiting):
            self._take(self.waiting)
        if self.segments == 0:
            return np.zeros(0), np.zeros(0)
        return self.frequency, np.sqrt(self.power / self.segments) * self.scale


def amplitude_spectrum(series, step, segment):
    """The same of a series in memory."""
    spectrum = Spectrum(step, segment)
    spectrum.add(series)
    return spectrum.finish()


def find_peaks(frequency, amplitude, lowest, highest, share, floor=0.0, separation=0.2):
    """(frequency [Hz], amplitude) of the peaks between `lowest` and `highest` [Hz], largest first.

    A peak is the largest value within `separation` (share of its frequency) to either side, and at least `share`
    of the largest peak and `floor`. Interpolated by a parabola through three logarithms.
    """
    candidates = []
    for k in range(1, len(frequency) - 1):
        left, middle, right = amplitude[k - 1 : k + 2]
        if not lowest <= frequency[k] <= highest or middle <= left or middle < right or left <= 0 or right <= 0:
            continue
        a, b, c = np.log([left, middle, right])
        shift = 0.5 * (a - c) / (a - 2 * b + c)
        candidates.append((frequency[k] + shift * (frequency[1] - frequency[0]), np.exp(b - 0.25 * (a - c) * shift)))
    peaks = []
    for peak in sorted(candidates, key=lambda p: -p[1]):
        if peak[1] >= floor and all(abs(peak[0] - other[0]) > separation * other[0] for other in peaks):
            peaks.append(peak)
    return [peak for peak in peaks if peak[1] >= share * peaks[0][1]]
