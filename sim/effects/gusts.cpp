// Gusts: the wind's speed v + w(t) instead of v; what acts is the difference to the steady wind,
//   F = 1/2 rho (C A) ((v + w) |v + w| - v |v|) sin(psi - theta_house),
// on boom and load as in wind. w is a sum of 32 sines, 0.01 ... 5 Hz at 31.3 m of reach, with the spectrum of a first-order
// filter of the correlation time, its standard deviation as given, phases drawn from the seed: smooth, and
// the same for every step length.
// Source: textbook (superposition of harmonics). Not in the thesis.
#include "sim/effects/effect.h"

#include <array>
#include <cmath>
#include <numbers>

#include "sim/effects/random_number.h"
#include "sim/effects/wind_force.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr int kSineCount = 32;
constexpr double kLowest = 0.01787;  // [1/swing time]: 0.01 Hz at 31.3 m of reach
constexpr double kHighest = 8.934;   // [1/swing time]: 5 Hz there
constexpr double kSameStep = 1e-6;   // of a step, by which times that are rounded may differ
constexpr int kMostTurns = 1000;     // before the sines are worked out anew: an angle is then off by a thousandth of a step's at most

class Gusts : public Running<Gusts> {
 public:
  explicit Gusts(const EffectStart& start)
      : mean_(start.value("mean_speed")),
        direction_(start.value("direction")),
        areas_(drag_areas(start.model.parameters, start.value("boom_drag_area"), start.value("load_drag_area"))) {
    const double lowest = kLowest / start.scales[common::ScaleOf::swing_time];  // [Hz]
    double variance = 0.0;
    for (std::size_t k = 0; k < kSineCount; ++k) {
      // Somewhere in the k-th of equal spans of the logarithm; the span's width goes with the frequency.
      const double place = (static_cast<double>(k) + uniform_number(start.seed, 2 * k)) / kSineCount;
      const double frequency = 2.0 * std::numbers::pi * lowest * std::pow(kHighest / kLowest, place);
      const double corner = frequency * start.value("correlation_time");
      frequency_[k] = frequency;
      phase_[k] = 2.0 * std::numbers::pi * uniform_number(start.seed, 2 * k + 1);
      amplitude_[k] = std::sqrt(frequency / (1.0 + corner * corner));
      variance += 0.5 * amplitude_[k] * amplitude_[k];
    }
    for (double& amplitude : amplitude_) amplitude *= start.value("deviation") / std::sqrt(variance);
    turn_cosine_.fill(1.0);  // over a step of nothing
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    turn_to(moment.time);
    double speed = mean_;
    for (const double sine : sine_) speed += sine;
    const double pressure =
        0.5 * kAirDensity * (speed * std::fabs(speed) - mean_ * mean_) * std::sin(direction_ - moment.house_angle);
    add_wind(areas_, pressure, pressure, ports);
  }

 private:
  // From one call to the next the sines turn by the same angle as long as the step is the same: by the theorem of addition, and from time to time anew, so that its
  // rounding does not grow.
  void turn_to(double time) {
    const double step = time - time_;
    time_ = time;
    if (std::fabs(step - step_) <= kSameStep * std::fabs(step_) && ++turns_ < kMostTurns) {
      for (std::size_t k = 0; k < kSineCount; ++k) {
        const double sine = sine_[k] * turn_cosine_[k] + cosine_[k] * turn_sine_[k];
        cosine_[k] = cosine_[k] * turn_cosine_[k] - sine_[k] * turn_sine_[k];
        sine_[k] = sine;
      }
      return;
    }
    turns_ = 0;
    for (std::size_t k = 0; k < kSineCount; ++k) {
      const double angle = frequency_[k] * time + phase_[k];
      sine_[k] = amplitude_[k] * std::sin(angle);
      cosine_[k] = amplitude_[k] * std::cos(angle);
    }
    if (std::fabs(step - step_) <= kSameStep * std::fabs(step_)) return;
    step_ = step;
    for (std::size_t k = 0; k < kSineCount; ++k) {
      turn_sine_[k] = std::sin(frequency_[k] * step);
      turn_cosine_[k] = std::cos(frequency_[k] * step);
    }
  }

  double mean_, direction_;
  DragAreas areas_;
  std::array<double, kSineCount> frequency_{}, phase_{}, amplitude_{};
  double time_ = 0.0, step_ = 0.0;  // [s] of the last call, and from the one before
  int turns_ = kMostTurns;          // since the sines were worked out: not yet
  std::array<double, kSineCount> sine_{}, cosine_{}, turn_sine_{}, turn_cosine_{};
};

}  // namespace

const EffectDescription& gusts() {
  static const EffectDescription description{
      .about = {.name = "gusts",
                .subsystem = common::Subsystem::environment,
                .physics = "the wind's speed goes up and down at random",
                .parameters = {{.name = "deviation",
                                .unit = common::Unit::metre_per_second,
                                .per = common::ScaleOf::wind_speed,
                                .meaning = "standard deviation of the wind's speed",
                                .lower = 0.0,
                                .upper = 1.142,
                                .typical = 0.2282,
                                .prior_scale = 0.1141,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "mean_speed",
                                .unit = common::Unit::metre_per_second,
                                .per = common::ScaleOf::wind_speed,
                                .meaning = "of the wind",
                                .lower = 0.0,
                                .upper = 2.853,
                                .typical = 0.6846,
                                .prior_scale = 0.2853,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               common::angle_parameter("direction",
                                                       "where it blows to, from the boom's first direction", 0.5 * std::numbers::pi),
                               {.name = "correlation_time",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::swing_time,
                                .meaning = "of the wind's speed",
                                .lower = 0.2798,
                                .upper = 33.59,
                                .typical = 2.798,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt},
                               boom_drag_area_parameter(),
                               load_drag_area_parameter()},
                .needs = {.boom = true},
                .family = common::Family::wind,
                .stochastic = common::Stochastic{.power_exponent = 2.0}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Gusts>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
