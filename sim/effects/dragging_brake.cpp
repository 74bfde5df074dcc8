// Dragging brake: brakes that do not open fully rub on the motors with a torque that does not depend on
// speed,
//   |T_friction| <= T_drag (1 + u) n_motors i   on the first half of the groups, (1 - u) on the last,
// against the motion, and holding at rest.
// With `give` > 0 each brake gives before it slides (presliding.h); `give` is an angle of the motor.
// Source: thesis 2.5 (brake plates; their details are left out there).
#include "sim/effects/effect.h"

#include "sim/effects/presliding.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class DraggingBrake : public Running<DraggingBrake> {
 public:
  explicit DraggingBrake(const EffectStart& start) : group_count_(start.model.group_count) {
    for (int i = 0; i < group_count_; ++i) {
      level_[i] = start.value("torque") * (1.0 + start.value("unevenness") * group_side(i, group_count_)) *
                  start.model.parameters.drive.motors_per_group * start.model.ratio;
      joint_[static_cast<std::size_t>(i)].give = start.value("give") / start.model.ratio;
    }
  }

  void friction(const EffectMoment&, FrictionLevels& levels) override {
    if (joint_[0].give > 0.0) return;
    for (int i = 0; i < group_count_; ++i) levels.motor[i] += level_[i];
  }

  void force(const EffectMoment& moment, PortForces& forces) override {
    if (joint_[0].give == 0.0) return;
    for (int i = 0; i < group_count_; ++i) {
      forces.motor_torque[i] -= level_[i] * presliding_share(joint_[static_cast<std::size_t>(i)], moment.motor_angle[i]);
    }
  }

 private:
  GroupArray level_{};  // [Nm] slew axis
  std::array<Presliding, kMaximumGroupCount> joint_{};
  int group_count_;
};

}  // namespace

const EffectDescription& dragging_brake() {
  static const EffectDescription description{
      .about = {.name = "dragging_brake",
                .subsystem = common::Subsystem::drive,
                .physics = "brakes that do not open fully rub on the motors",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::motor_torque,
                                .meaning = "friction of one motor's brake, mean of the groups",
                                .lower = 0.0,
                                .upper = 0.8,
                                .typical = 0.08,
                                .prior_scale = 0.04,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "unevenness",
                                .unit = common::Unit::none,
                                .meaning = "relative excess of the first half of the groups",
                                .lower = -1.0,
                                .upper = 1.0,
                                .typical = 0.0,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               give_parameter("motor angle over which the brake takes up its friction; 0: dry friction",
                                              common::ScaleOf::one, 2.0, 0.02)},
                .family = common::Family::friction},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<DraggingBrake>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
