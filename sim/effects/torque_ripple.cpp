// Torque ripple: on top of the command, a torque that depends on the rotor's angle,
//   T = T_command + a (sin(n theta_motor + phase) + second_sine sin(2 n theta_motor) + second_cosine cos(2 n theta_motor)),
// n ripples per turn of the motor; rotors are mounted one by one, so the last half of the groups has the same wave with a phase of its own, and a defect sits in one
// of them: the first half has (1 + share) a, the last half (1 - share) a. What acts over a step is its mean along the turned angle, exact for a steady speed, so
// that ripples faster than the step do not fold down into slow ones.
// Source: textbook; cogging and sixth harmonics of a three-phase machine, and their multiples. Left out in thesis 2.4.
#include "sim/effects/effect.h"

#include "sim/effects/ripple.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class TorqueRipple : public Running<TorqueRipple> {
 public:
  explicit TorqueRipple(const EffectStart& start)
      : amplitude_(start.value("amplitude")),
        ripple_(ripples_of_groups({.order = start.value("order") * start.model.ratio,
                                   .phase = start.value("phase"),
                                   .second_sine = start.value("second_sine"),
                                   .second_cosine = start.value("second_cosine")},
                                  {.phase_last = start.value("phase_last"), .share = start.value("share")}, start.model.group_count)),
        group_count_(start.model.group_count) {}

  void actuator(const EffectMoment& moment, GroupArray& motor_torque) override {
    for (int i = 0; i < group_count_; ++i) {
      motor_torque[i] +=
          amplitude_ * mean_ripple(ripple_[static_cast<std::size_t>(i)], moment.motor_angle[i], moment.motor_speed[i] * moment.step);
    }
  }

 private:
  double amplitude_;
  GroupRipples ripple_;  // over the slew axis
  int group_count_;
};

}  // namespace

const EffectDescription& torque_ripple() {
  static const EffectDescription description{
      .about = {.name = "torque_ripple",
                .subsystem = common::Subsystem::drive,
                .physics = "torque that goes up and down with the rotor angle",
                .parameters = {{.name = "amplitude",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::motor_torque,
                                .meaning = "amplitude per motor",
                                .lower = 0.0,
                                .upper = 0.8,
                                .typical = 0.08,
                                .prior_scale = 0.04,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "order",
                                .unit = common::Unit::none,
                                .meaning = "ripples per turn of the motor",
                                .lower = 0.5,
                                .upper = 24.0,
                                .typical = 6.0,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {1.0, 2.0, 3.0, 4.0, 12.0}},  // turn, pole pairs, their harmonics
                               common::angle_parameter("phase", "at the start, in the first half of the groups"),
                               common::angle_parameter("phase_last", "at the start, in the last half"),
                               second_sine_parameter(),
                               second_cosine_parameter(),
                               ripple_share_parameter()},
                .family = common::Family::ripple},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TorqueRipple>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
