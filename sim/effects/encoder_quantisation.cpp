// Encoder quantisation: the position comes in steps of the resolution r, position_q = r floor(position /
// r), and the speed from counts over a window w,
//   speed_q(t) = speed(t) + (e(t) - e(t - w)) / w,   e = position_q - position,
// which is the count's difference over w where the window is short against the motion.
// Source: textbook (incremental encoder). Not in the thesis.
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class EncoderQuantisation : public Running<EncoderQuantisation> {
 public:
  explicit EncoderQuantisation(const EffectStart& start)
      : resolution_(start.value("resolution")),
        steps_(std::max(1.0, std::round(start.value("window") / start.model.step))),
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
                                .per = common::ScaleOf::time,
                                .meaning = "over which counts make a speed",
                                .lower = 0.0004962,
                                .upper = 0.09926,
                                .typical = 0.004963,
                                .prior_scale = 0.7,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt}},
                .read_off = common::ReadOff::encoder_counts},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<EncoderQuantisation>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
