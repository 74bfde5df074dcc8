// Where the gap lies before any effect is added: in which signal and band of frequencies, and at which moments.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

// Shares that sum to 1.
struct BandShare {
  std::string channel;
  double from = 0.0, to = 0.0;  // [Hz]
  double share = 0.0;           // of what the most probable cause takes away, or of what stands above the noise
  double mean_square = 0.0;     // residual variance ratio of parameters alone; 1 = noise only
};

struct ChannelShare {
  std::string channel;
  double share = 0.0;
};
// The channel in which twice as much lies as in all others together; nothing where there is none.
std::optional<ChannelShare> channel_of_most(const std::vector<BandShare>& bands);
// Of what a fit takes away of the differences, the largest share that one accelerometer has of it below a frequency [Hz].
ChannelShare largest_slow_share(const Problem& problem, const Eigen::VectorXd& difference, const Eigen::VectorXd& left, double below);

struct Moment {
  std::string record;
  double time = 0.0;            // [s] its middle
  std::string phase;            // accelerating, braking, constant speed, reversing, standing
  double missing_torque = 0.0;  // [Nm per motor] RMS in it
};

// The power of `difference` less that of `left`, by signal and band (thresholds.h); falling shares.
std::vector<BandShare> bands_of_gap(const Problem& problem, const Eigen::VectorXd& difference, const Eigen::VectorXd& left);

// The moments at which the machine at a point misses most torque, at most `most` of them, falling.
std::vector<Moment> largest_moments(const Problem& problem, const Point& point, std::size_t most);

}  // namespace slewlab::diagnosis
