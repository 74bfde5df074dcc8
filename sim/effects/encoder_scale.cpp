// Encoder scale: position and speed read (1 + error) times what they are (counts per turn or ratio set
// wrong).
// Source: textbook. Not in the thesis.
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

class EncoderScale : public Running<EncoderScale> {
 public:
  explicit EncoderScale(const EffectStart& start) : factor_(1.0 + start.value("error")) {}

  void sensor(const SensorMoment&, PlantReadings& readings) override {
    for (double& speed : readings.shaft_speed) speed *= factor_;
    for (double& position : readings.shaft_position) position *= factor_;
  }

 private:
  double factor_;
};

}  // namespace

const EffectDescription& encoder_scale() {
  static const EffectDescription description{
      .about = {.name = "encoder_scale",
                .subsystem = common::Subsystem::sensor,
                .physics = "the encoder reads too much or too little",
                .parameters = {{.name = "error",
                                .unit = common::Unit::none,
                                .meaning = "relative",
                                .lower = -0.3,
                                .upper = 0.3,
                                .typical = 0.02,
                                .prior_scale = 0.01,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .linear = true},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<EncoderScale>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
