// Spectra of recorded series: amplitude spectrum, peaks, energy of a band, ring-down.
#pragma once

#include <span>
#include <vector>

namespace slewlab::sim {

// One-sided amplitude spectrum: a sine of amplitude a on the series shows a peak of height a.
struct Spectrum {
  double resolution = 0.0;          // [Hz] between two values; the first stands at 0 Hz
  std::vector<double> amplitude;    // unit of the series
};

// Mean and straight trend removed, Hann window, zero-padded to at least four times the length. `step` [s].
Spectrum amplitude_spectrum(std::span<const double> series, double step);

struct Peak {
  double frequency = 0.0;  // [Hz], interpolated by a parabola through three logarithms
  double amplitude = 0.0;
};

// Local maxima between `lowest` and `highest` [Hz] of at least `share` of the largest one there, largest first.
std::vector<Peak> find_peaks(const Spectrum& spectrum, double lowest, double highest, double share);

// The largest of them; frequency 0 where the band has no local maximum.
Peak largest_peak(const Spectrum& spectrum, double lowest, double highest);

// Root mean square of the series' share between `lowest` and `highest` [Hz]: trend removed, no window, by
// Parseval's theorem.
double band_rms(std::span<const double> series, double step, double lowest, double highest);

// Welch's power spectral density [unit^2/Hz]: Hann windows of `segment` samples, half overlapping. The first
// value stands at 0 Hz, the others 1 / (segment step) apart. Throws std::invalid_argument when the series is
// shorter than a segment.
std::vector<double> power_spectral_density(std::span<const double> series, double step, int segment);

// A free vibration about zero: frequency from the zero crossings, damping ratio from a straight line through
// the logarithms of the peaks between them. Zero where there are fewer than four crossings.
struct RingDown {
  double frequency = 0.0;      // [Hz] damped
  double damping_ratio = 0.0;  // [-]
};
RingDown ring_down(std::span<const double> series, double step);

}  // namespace slewlab::sim
