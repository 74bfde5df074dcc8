// Sensors as they are bought: counting encoders with the drive's speed, accelerometers with coloured noise.
#pragma once

#include <array>
#include <vector>

#include "diagnosis/evaluation/random.h"
#include "diagnosis/evaluation/truth_machine.h"

namespace slewlab::diagnosis::withheld {

// One encoder and the drive's tracking loop over its counts:
//   r = counted - (x + v T), x += v T + g r, v += h r / T,  g = 1 - p^2, h = (1 - p)^2, p = exp(-2 pi f T).
class CountingEncoder {
 public:
  CountingEncoder(const EncoderCounting& counting, double phase);  // phase [counts] of the first edge

  void update(double true_position);  // once per base step
  double position() const { return counted_; }
  double speed() const { return speed_; }

 private:
  EncoderCounting counting_;
  double phase_;
  double counted_ = 0.0, estimate_ = 0.0, speed_ = 0.0;
  std::vector<double> past_;
  std::size_t newest_ = 0;
};

// [rad/s] RMS of what counting alone does to the speed: the loop with counts against the loop without, over speeds
// from standstill to the motors' top speed [rad/s].
double counting_noise(const EncoderCounting& counting, double top_speed);

// White noise plus 1/f noise from first-order filters, one per octave, from a hundred thousandth
// of the base step's rate to a twelfth of it.
class ColouredNoise {
 public:
  ColouredNoise(const NoiseSettings& settings, Random random);
  double next();  // [m/s^2]

 private:
  static constexpr int kOctaves = 14;
  Random random_;
  double white_;
  double octave_deviation_;
  std::array<double, kOctaves> keep_{}, value_{};
};

}  // namespace slewlab::diagnosis::withheld
