#include "sim/effects/clock_drift.h"

#include <algorithm>

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kLongestLag = 1.0;  // [s]

class ClockDrift : public Running<ClockDrift> {
 public:
  explicit ClockDrift(const EffectStart& start)
      : drift_(start.values[0]), step_(start.model.step), line_(kLongestLag / start.model.step) {}

  void sensor(const SensorMoment& moment, PlantReadings& readings) override {
    line_.push({readings.house_acceleration, readings.pivot_acceleration, readings.middle_acceleration,
                readings.tip_acceleration, readings.slew_angle});
    const auto past = line_.at(std::min(kLongestLag, drift_ * moment.time) / step_);
    const auto mixed = [&](double Sample::* field) {
      return blend(past.older.*field, past.newer.*field, past.share);
    };
    readings.house_acceleration = mixed(&Sample::house);
    readings.pivot_acceleration = mixed(&Sample::pivot);
    readings.middle_acceleration = mixed(&Sample::middle);
    readings.tip_acceleration = mixed(&Sample::tip);
    readings.slew_angle = mixed(&Sample::slew);
  }

 private:
  struct Sample {
    double house = 0.0, pivot = 0.0, middle = 0.0, tip = 0.0, slew = 0.0;
  };
  double drift_, step_;
  DelayLine<Sample> line_;
};

}  // namespace

const EffectDescription& clock_drift() {
  static const EffectDescription description{
      .about = {.name = "clock_drift",
                .subsystem = common::Subsystem::sensor,
                .physics = "the sensors' clock runs slow against the drives'",
                .parameters = {{.name = "drift",
                                .unit = common::Unit::none,
                                .meaning = "lag gained per time",
                                .lower = 0.0,
                                .upper = 0.02,
                                .typical = 1e-3,
                                .prior_scale = 5e-4,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<ClockDrift>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
