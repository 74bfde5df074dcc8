#include "sim/effects/dragging_brake.h"

#include "sim/effects/presliding.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class DraggingBrake : public Running<DraggingBrake> {
 public:
  explicit DraggingBrake(const EffectStart& start) : group_count_(start.model.group_count) {
    for (int i = 0; i < group_count_; ++i) {
      level_[i] = start.values[0] * (1.0 + start.values[1] * group_side(i, group_count_)) *
                  start.model.parameters.drive.motors_per_group * start.model.ratio;
      joint_[static_cast<std::size_t>(i)].give = start.values[2] / start.model.ratio;
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
                                .meaning = "friction of one motor's brake, mean of the groups",
                                .lower = 0.0,
                                .upper = 200.0,
                                .typical = 20.0,
                                .prior_scale = 10.0,
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
                               give_parameter("motor angle over which the brake takes up its friction; 0: dry friction", 2.0, 0.02)}},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<DraggingBrake>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
