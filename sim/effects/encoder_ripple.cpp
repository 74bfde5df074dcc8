// Encoder ripple: a disk mounted off its centre reads wrong once per turn, and an oval one twice,
//   position += a (sin(p) - sin(phase) + s (sin(2 p) - sin(2 phase))),   p = position + phase,
//   speed (1 + a (cos(p) + 2 s cos(2 p))):
// both belong to one disk, so that one phase places both. It reads 0 where it starts.
// Encoders are mounted one by one, so the phase of the last half of the groups is its own, and a disk that is mounted badly sits in one of them:
// the first half's amplitude is (1 + share) a, the last half's (1 - share) a.
// Source: textbook (eccentric encoder disk). Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/ripple.h"
#include "sim/effects/uneven_groups.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class EncoderRipple : public Running<EncoderRipple> {
 public:
  explicit EncoderRipple(const EffectStart& start)
      : second_share_(start.value("second_share")), group_count_(start.model.group_count) {
    for (int i = 0; i < group_count_; ++i) {
      phase_[i] = group_side(i, group_count_) < 0.0 ? start.value("phase_last") : start.value("phase");
      amplitude_[i] = start.value("amplitude") * uneven_factor(start.value("share"), 0.0, i, group_count_);
    }
  }

  void sensor(const SensorMoment&, PlantReadings& readings) override {
    for (int i = 0; i < group_count_; ++i) {
      const double at = readings.shaft_position[i] + phase_[i];
      readings.shaft_position[i] += amplitude_[i] * (std::sin(at) - std::sin(phase_[i]) +
                                                  second_share_ * (std::sin(2.0 * at) - std::sin(2.0 * phase_[i])));
      readings.shaft_speed[i] *= 1.0 + amplitude_[i] * (std::cos(at) + 2.0 * second_share_ * std::cos(2.0 * at));
    }
  }

 private:
  GroupArray amplitude_{};  // [rad]
  double second_share_;
  GroupArray phase_{};  // [rad]
  int group_count_;
};

}  // namespace

const EffectDescription& encoder_ripple() {
  static const EffectDescription description{
      .about = {.name = "encoder_ripple",
                .subsystem = common::Subsystem::sensor,
                .physics = "the encoder reads wrong once per turn",
                .parameters = {{.name = "amplitude",
                                .unit = common::Unit::radian,
                                .meaning = "of the position's error, motor angle",
                                .lower = 0.0,
                                .upper = 0.1,
                                .typical = 0.01,
                                .prior_scale = 0.005,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("phase", "at the start, in the first half of the groups"),
                               common::angle_parameter("phase_last", "at the start, in the last half"),
                               {.name = "second_share",
                                .unit = common::Unit::none,
                                .meaning = "error twice per turn, share of the amplitude",
                                .lower = -0.8,
                                .upper = 0.8,
                                .typical = 0.0,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0,
                                .detail = true},
                               ripple_share_parameter()},
                .family = common::Family::ripple},
      .ports = {EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<EncoderRipple>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
