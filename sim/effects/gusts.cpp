#include "sim/effects/gusts.h"

#include <array>
#include <cmath>
#include <numbers>

#include "sim/effects/random_number.h"
#include "sim/effects/wind_force.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr int kSineCount = 32;
constexpr double kLowest = 0.01;  // [Hz]
constexpr double kHighest = 5.0;  // [Hz]

class Gusts : public Running<Gusts> {
 public:
  explicit Gusts(const EffectStart& start)
      : mean_(start.values[1]),
        direction_(start.values[2]),
        areas_(drag_areas(start.model.parameters, start.values[4], start.values[5])) {
    double variance = 0.0;
    for (std::size_t k = 0; k < kSineCount; ++k) {
      // Somewhere in the k-th of equal spans of the logarithm; the span's width goes with the frequency.
      const double place = (static_cast<double>(k) + uniform_number(start.seed, 2 * k)) / kSineCount;
      const double frequency = 2.0 * std::numbers::pi * kLowest * std::pow(kHighest / kLowest, place);
      const double corner = frequency * start.values[3];
      frequency_[k] = frequency;
      phase_[k] = 2.0 * std::numbers::pi * uniform_number(start.seed, 2 * k + 1);
      amplitude_[k] = std::sqrt(frequency / (1.0 + corner * corner));
      variance += 0.5 * amplitude_[k] * amplitude_[k];
    }
    for (double& amplitude : amplitude_) amplitude *= start.values[0] / std::sqrt(variance);
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    double speed = mean_;
    for (std::size_t k = 0; k < kSineCount; ++k) {
      speed += amplitude_[k] * std::sin(frequency_[k] * moment.time + phase_[k]);
    }
    const double pressure =
        0.5 * kAirDensity * (speed * std::fabs(speed) - mean_ * mean_) * std::sin(direction_ - moment.house_angle);
    add_wind(areas_, pressure, pressure, ports);
  }

 private:
  double mean_, direction_;
  DragAreas areas_;
  std::array<double, kSineCount> frequency_{}, phase_{}, amplitude_{};
};

}  // namespace

const EffectDescription& gusts() {
  static const EffectDescription description{
      .about = {.name = "gusts",
                .subsystem = common::Subsystem::environment,
                .physics = "the wind's speed goes up and down at random",
                .parameters = {{.name = "deviation",
                                .unit = common::Unit::metre_per_second,
                                .meaning = "standard deviation of the wind's speed",
                                .lower = 0.0,
                                .upper = 20.0,
                                .typical = 4.0,
                                .prior_scale = 2.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "mean_speed",
                                .unit = common::Unit::metre_per_second,
                                .meaning = "of the wind",
                                .lower = 0.0,
                                .upper = 50.0,
                                .typical = 12.0,
                                .prior_scale = 5.0,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               common::angle_parameter("direction",
                                                       "where it blows to, from the boom's first direction", 0.5 * std::numbers::pi),
                               {.name = "correlation_time",
                                .unit = common::Unit::second,
                                .meaning = "of the wind's speed",
                                .lower = 0.5,
                                .upper = 60.0,
                                .typical = 5.0,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt},
                               boom_drag_area_parameter(),
                               load_drag_area_parameter()}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Gusts>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
