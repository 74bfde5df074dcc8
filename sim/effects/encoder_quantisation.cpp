#include "sim/effects/encoder_quantisation.h"

#include <algorithm>
#include <cmath>

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class EncoderQuantisation : public Running<EncoderQuantisation> {
 public:
  explicit EncoderQuantisation(const EffectStart& start)
      : resolution_(start.values[0]),
        steps_(std::max(1.0, std::round(start.values[1] / start.model.step))),
        window_(steps_ * start.model.step),
        group_count_(start.model.group_count),
        errors_(steps_) {}

  void sensor(const SensorMoment&, PlantReadings& readings) override {
    if (resolution_ == 0.0) return;
    GroupArray error{};
    for (int i = 0; i < group_count_; ++i) {
      const double position = readings.shaft_position[i];
      readings.shaft_position[i] = resolution_ * std::floor(position / resolution_);
      error[i] = readings.shaft_position[i] - position;
    }
    errors_.push(error);
    const GroupArray& before = errors_.at(steps_).newer;
    for (int i = 0; i < group_count_; ++i) readings.shaft_speed[i] += (error[i] - before[i]) / window_;
  }

 private:
  double resolution_, steps_, window_;
  int group_count_;
  DelayLine<GroupArray> errors_;
};

}  // namespace

const EffectDescription& encoder_quantisation() {
  static const EffectDescription description{
      .about = {.name = "encoder_quantisation",
                .subsystem = common::Subsystem::sensor,
                .physics = "the encoder counts in steps",
                .parameters = {{.name = "resolution",
                                .unit = common::Unit::radian,
                                .meaning = "motor angle per count",
                                .lower = 0.0,
                                .upper = 0.2,
                                .typical = 0.0061,
                                .prior_scale = 0.005,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "window",
                                .unit = common::Unit::second,
                                .meaning = "over which counts make a speed",
                                .lower = 5e-4,
                                .upper = 0.1,
                                .typical = 0.005,
                                .prior_scale = 0.7,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt}}},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<EncoderQuantisation>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
