#include "sim/analysis/bode.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "sim/analysis/state_space.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

std::vector<BodePoint> frequency_response(const CraneParameters& crane, const std::vector<double>& frequencies) {
  const CraneMatrices matrices = assemble_crane(crane, GearState::kClosed);
  const Eigen::VectorXcd force = drive_forces(crane, matrices.at).rowwise().sum().cast<std::complex<double>>();
  std::vector<BodePoint> response;
  response.reserve(frequencies.size());
  for (const double frequency : frequencies) {
    const double w = 2.0 * std::numbers::pi * frequency;
    const std::complex<double> iw(0.0, w);
    const Eigen::MatrixXcd dynamic =
        (matrices.stiffness - w * w * matrices.mass).cast<std::complex<double>>() +
        iw * matrices.damping.cast<std::complex<double>>();
    const Eigen::VectorXcd displacement = dynamic.partialPivLu().solve(force);
    const std::complex<double> tip = matrices.at.tip >= 0
                                         ? displacement(matrices.at.tip)
                                         : tip_radius(crane.boom) * displacement(matrices.at.house);
    response.push_back({.frequency = frequency, .tip_velocity = iw * tip});
  }
  return response;
}

std::vector<double> logarithmic_frequencies(double first, double last, int count) {
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i) frequencies.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return frequencies;
}

double decibel(const std::complex<double>& value) { return 20.0 * std::log10(std::abs(value)); }

}  // namespace slewlab::sim
