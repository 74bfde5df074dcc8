"""Spectra of recorded series and the peaks in them."""

import numpy as np

SEGMENT = 5.0  # [s] resolves 0.2 Hz: the loop's 1.1 Hz and the boom's 1.3 Hz stay one hill, ring-downs stay visible


def amplitude_spectrum(series, step, segment=SEGMENT):
    """Frequencies [Hz] and amplitudes [unit of the series]: a lasting sine of amplitude a shows a peak of a.

    Welch: segments of `segment` [s], three quarters overlapping, mean and straight trend removed, Hann window,
    zero-padded to four times their length, squared amplitudes averaged. `step` [s] between samples. A series
    shorter than a segment is one segment. What dies out within the series counts with its mean power, so heights
    tell which frequency dominates, not how hard the first blow was.
    """
    series = np.asarray(series, float)
    length = min(len(series), int(round(segment / step)))
    if length < 16:
        return np.zeros(0), np.zeros(0)
    padded = 1 << int(np.ceil(np.log2(4 * length)))
    index = np.arange(length)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * (index + 0.5) / length)
    starts = range(0, len(series) - length + 1, max(1, length // 4))
    power = np.zeros(padded // 2 + 1)
    for start in starts:
        piece = series[start : start + length]
        piece = piece - np.polyval(np.polyfit(index, piece, 1), index)
        power += np.abs(np.fft.rfft(piece * window, padded)) ** 2
    return np.fft.rfftfreq(padded, step), np.sqrt(power / len(starts)) * 2 / window.sum()


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
