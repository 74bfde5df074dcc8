// Differences between record and shadow as one vector of numbers that are comparable with each other: the
// spectrum of each channel, divided at each frequency by what a good model may still miss there.
//
//   weight(f) = 1 / sqrt(e^2 P(f) + N(f))
//
// P is the smoothed power of the measured signal itself, e the share of it that mesh, step and laws of a good
// model still miss (learned from machines with nothing missing), N the sensor's noise: white
// as the record's fastest differences show it, rising as 1/f below the corner that its data sheet names.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/record.h"
#include "diagnosis/shadow.h"

namespace slewlab::diagnosis {

struct WhiteningSettings {
  double highest_frequency = 40.0;   // [Hz] fifth bending mode at 37 Hz (thesis 4.2); none matters above
  double lowest_frequency = 0.02;    // [Hz] below which a record of a minute knows nothing
  double discrepancy_share = 0.01;   // [-] e
  double noise_corner = 1.0;         // [Hz] below which an accelerometer's noise rises as 1/f (its data sheet)
  double smoothing = 0.4;            // [-] width of the smoothing of P as a share of the frequency
};

struct Channel {
  bool is_torque = false;  // else an accelerometer
  int index = 0;           // group or accelerometer
};

// How one record's differences become numbers.
struct Whitening {
  std::vector<Channel> channels;
  std::size_t transform_length = 0;
  std::size_t first_bin = 0, bin_count = 0;
  double bin_width = 0.0;               // [Hz]
  std::vector<Eigen::VectorXd> weight;  // per channel, per bin
  std::vector<double> window;           // per grid point, 0 where the record is not to be judged
  Eigen::Index size() const { return static_cast<Eigen::Index>(2 * bin_count * channels.size()); }
};

// `trusted` holds for each grid point whether it may be judged; the window falls to 0 where it may not.
// `motor_inertia` [kg m^2] of one motor turns the encoders' noise into the torque channels'.
Whitening make_whitening(const Record& record, const std::vector<bool>& trusted, double motor_inertia,
                         const WhiteningSettings& settings);

// Where a record may be judged: away from impacts, at which every small difference grows to full size. Takes out
// each stretch in which the shadow's gears are not all in contact, and what follows it until it is forgotten.
std::vector<bool> trusted_stretches(const Record& record, const Shadow& shadow);

// Real and imaginary part of every bin of every channel, weighted.
Eigen::VectorXd whiten(const Whitening& whitening, const Shadow& shadow);

}  // namespace slewlab::diagnosis
