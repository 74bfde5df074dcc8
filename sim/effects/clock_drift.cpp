// Clock drift: accelerometers and slew angle are sampled by a clock that runs slow against the drives', so
// that what is stamped t was measured at t - drift t, linear between steps. The lag is kept at 1 s or
// less.
// Source: textbook (clocks of two devices). Not in the thesis.
#include "sim/effects/effect.h"

#include <algorithm>

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kLongestLag = 1.0;  // [times the acceleration time]

class ClockDrift : public Running<ClockDrift> {
 public:
  explicit ClockDrift(const EffectStart& start)
      : drift_(start.value("drift")),
        longest_(kLongestLag * start.scales[common::ScaleOf::time]),
        step_(start.model.step),
        line_(longest_ / step_) {}

  void sensor(const SensorMoment& moment, PlantReadings& readings) override {
    line_.push(readings);
    const auto past = line_.at(std::min(longest_, drift_ * moment.time) / step_);
    for (const auto& sensor : msgs::kSensorFields<msgs::SensorReadings>) {
      readings.*sensor.value = blend(past.older.*sensor.value, past.newer.*sensor.value, past.share);
    }
  }

 private:
  double drift_, longest_, step_;
  DelayLine<msgs::SensorReadings> line_;
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
