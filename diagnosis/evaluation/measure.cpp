#include "diagnosis/evaluation/measure.h"

#include <cmath>
#include <numbers>

namespace slewlab::diagnosis::withheld {

namespace {

// Instruments and drives work at rates of their own, whatever machine they sit on; all go with the base step.
constexpr double kTrackingFrequency = 0.1 / kBaseStep;  // [Hz] of the drive's speed loop: a tenth of its rate is usual
constexpr double kLowestOctave = 1e-5 / kBaseStep;      // [Hz]: a hundred thousand steps are longer than any manoeuvre
constexpr double kTwoPi = 2.0 * std::numbers::pi;

}  // namespace

CountingEncoder::CountingEncoder(const EncoderCounting& counting, double phase) : counting_(counting), phase_(phase) {
  const double steps = std::round(counting.window / kBaseStep);
  if (steps >= 1.0) past_.assign(static_cast<std::size_t>(steps), 0.0);
}

void CountingEncoder::update(double true_position) {
  const double q = counting_.resolution;
  // The zero of the position is the count on which the drive was switched on.
  counted_ = q > 0.0 ? q * (std::floor(true_position / q + phase_) - std::floor(phase_)) : true_position;
  if (past_.empty()) {
    const double pole = std::exp(-kTwoPi * kTrackingFrequency * kBaseStep);
    const double predicted = estimate_ + speed_ * kBaseStep;
    const double error = counted_ - predicted;
    estimate_ = predicted + (1.0 - pole * pole) * error;
    speed_ += (1.0 - pole) * (1.0 - pole) * error / kBaseStep;
    return;
  }
  const double oldest = past_[newest_];
  past_[newest_] = counted_;
  newest_ = (newest_ + 1) % past_.size();
  speed_ = (counted_ - oldest) / (static_cast<double>(past_.size()) * kBaseStep);
}

double counting_noise(const EncoderCounting& counting, double top_speed) {
  constexpr int kSteps = 5000;
  EncoderCounting ideal = counting;
  ideal.resolution = 0.0;
  CountingEncoder counted(counting, 0.5), smooth(ideal, 0.5);
  double position = 0.0, square = 0.0;
  for (int n = 0; n < kSteps; ++n) {
    position += 0.5 * top_speed * (1.0 - std::cos(kTwoPi * n / kSteps)) * kBaseStep;
    counted.update(position);
    smooth.update(position);
    square += (counted.speed() - smooth.speed()) * (counted.speed() - smooth.speed());
  }
  return std::sqrt(square / kSteps);
}

ColouredNoise::ColouredNoise(const NoiseSettings& settings, Random random)
    : random_(random),
      white_(settings.accelerometer * std::sqrt(1.0 - settings.flicker_share)),
      octave_deviation_(settings.accelerometer * std::sqrt(settings.flicker_share / kOctaves)) {
  for (int k = 0; k < kOctaves; ++k) {
    const auto j = static_cast<std::size_t>(k);
    keep_[j] = std::exp(-kTwoPi * kLowestOctave * std::exp2(k) * kBaseStep);
    value_[j] = octave_deviation_ * random_.normal();
  }
}

double ColouredNoise::next() {
  double sum = white_ * random_.normal();
  for (std::size_t j = 0; j < value_.size(); ++j) {
    value_[j] = keep_[j] * value_[j] + octave_deviation_ * std::sqrt(1.0 - keep_[j] * keep_[j]) * random_.normal();
    sum += value_[j];
  }
  return sum;
}

}  // namespace slewlab::diagnosis::withheld
