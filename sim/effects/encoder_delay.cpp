// Encoder delay: position and speed arrive late, x(t - delay), linear between steps.
// Source: textbook (filtering and bus cycle of an encoder interface). Not in the thesis.
#include "sim/effects/effect.h"

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class EncoderDelay : public Running<EncoderDelay> {
 public:
  explicit EncoderDelay(const EffectStart& start)
      : delay_(start.value("delay") / start.model.step), group_count_(start.model.group_count), line_(delay_) {}

  void sensor(const SensorMoment&, PlantReadings& readings) override {
    line_.push({readings.shaft_speed, readings.shaft_position});
    const auto past = line_.at(delay_);
    for (int i = 0; i < group_count_; ++i) {
      readings.shaft_speed[i] = blend(past.older.speed[i], past.newer.speed[i], past.share);
      readings.shaft_position[i] = blend(past.older.position[i], past.newer.position[i], past.share);
    }
  }

 private:
  struct Sample {
    GroupArray speed{}, position{};
  };
  double delay_;  // [steps]
  int group_count_;
  DelayLine<Sample> line_;
};

}  // namespace

const EffectDescription& encoder_delay() {
  static const EffectDescription description{
      .about = {.name = "encoder_delay",
                .subsystem = common::Subsystem::sensor,
                .physics = "the encoder's reading arrives late",
                .parameters = {{.name = "delay",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "of position and speed",
                                .lower = 0.0,
                                .upper = 0.1986,
                                .typical = 0.02978,
                                .prior_scale = 0.01985,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .family = common::Family::delay,
                .acts_late = true,
                .pure_delay = common::PureDelay::encoder,
                .linear = true},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<EncoderDelay>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
