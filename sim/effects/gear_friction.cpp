// Load-dependent gear friction: the teeth lose a share of the torque they carry, on the motor side and against the
// motor's motion,
//   T_friction = -loss |T_gear| x / sqrt(1 + x^2),   x = motor_speed / sliding_speed.
// loss = 1 - efficiency. Teeth slide back and forth through the pitch point and never hold still together, so that the
// friction of all passes zero smoothly with the speed: it holds nothing at rest.
//
// Acts from the middle of the step, explicitly; stable while loss |T_gear| step < sliding_speed J_group. With both numbers
// at their worst bounds, 1 ms and the thesis's drives that is to 3.3 MNm per group, 400 Nm of each motor.
// Source: thesis 2.6 (friction between the teeth lowers the efficiency; neglected there). The smooth passage is this
// project's.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class GearFriction : public Running<GearFriction> {
 public:
  explicit GearFriction(const EffectStart& start)
      : loss_(start.value("loss")), sliding_speed_(start.value("sliding_speed")), group_count_(start.model.group_count) {}

  void force(const EffectMoment& moment, PortForces& forces) override {
    for (int i = 0; i < group_count_; ++i) {
      const double speed = moment.motor_speed[i] / sliding_speed_;
      forces.motor_torque[i] -= loss_ * std::fabs(moment.gear_torque[i]) * speed / std::sqrt(1.0 + speed * speed);
    }
  }

 private:
  double loss_;
  double sliding_speed_;  // [rad/s] slew axis
  int group_count_;
};

}  // namespace

const EffectDescription& gear_friction() {
  static const EffectDescription description{
      .about = {.name = "gear_friction",
                .subsystem = common::Subsystem::drive,
                .physics = "gears lose a share of the torque they carry",
                .parameters = {{.name = "loss",
                                .unit = common::Unit::none,
                                .meaning = "share of the gear torque, 1 - efficiency",
                                .lower = 0.0,
                                .upper = 0.4,
                                .typical = 0.05,
                                .prior_scale = 0.03,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "sliding_speed",
                                .unit = common::Unit::radian_per_second,
                                .per = common::ScaleOf::axis_speed,
                                .meaning = "slewing speed above which the teeth slide fully",
                                .lower = 0.001,
                                .upper = 0.2,
                                .typical = 0.006,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .detail = true}},
                .needs = {.gears = true},
                .family = common::Family::friction},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<GearFriction>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
