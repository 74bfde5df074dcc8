#include "diagnosis/own_noise.h"

#include <algorithm>
#include <cstddef>

#include "diagnosis/noise_response.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastVariance = 1e-3;  // what is rounded away

}  // namespace

Eigen::VectorXd own_noise(const Problem& problem, const Point& point) {
  Eigen::VectorXd variance(difference_count(problem));
  const sim::MachineSettings machine = machine_at(problem.nominal, problem.nuisances, point);
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Whitening& whitening = problem.whitening[r];
    const std::vector<Eigen::VectorXd> answered = noise_through(whitening, noise_response(machine, problem.records[r], problem.gains, whitening.transform_length, problem.force_steps));
    for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
      for (Eigen::Index b = 0; b < answered[c].size(); ++b) {
        const double weight = whitening.weight[c](b);
        const double v = std::max(kLeastVariance, 1.0 + 0.5 * weight * weight * (answered[c](b) - whitening.answered[c](b)));
        variance(row++) = v;  // of the real and the imaginary part
        variance(row++) = v;
      }
    }
    variance.segment(row, whitening.flanks_size()).setOnes();  // the deviation of the gears' places is hardly noise
    row += whitening.flanks_size();
  }
  return variance;
}

}  // namespace slewlab::diagnosis
