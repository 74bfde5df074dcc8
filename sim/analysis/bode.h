// Frequency response of the linear crane (gears closed), damping included: motor torque to tip velocity, as in
// thesis Figure 4.2. (K + i w C - w^2 M) x = f is solved densely at each frequency.
#pragma once

#include <complex>
#include <vector>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

struct BodePoint {
  double frequency = 0.0;                 // [Hz]
  std::complex<double> tip_velocity;      // [(m/s)/Nm]; without beam elements the rigid boom's tip
};

// The same torque on every motor, per motor on the fast axis [Nm]. Frequencies [Hz] must be above 0.
std::vector<BodePoint> frequency_response(const CraneParameters& crane, const std::vector<double>& frequencies);

// `count` >= 2 frequencies [Hz] from `first` to `last`, evenly spread on a logarithmic scale.
std::vector<double> logarithmic_frequencies(double first, double last, int count);

// [dB] 20 log10 |x|.
double decibel(const std::complex<double>& value);

}  // namespace slewlab::sim
