// Uneven torque of the motor groups (uneven_groups.h): what a group's motors make of the torque that their drive gives out,
//   T_i = T_given,i (1 + m) (1 + s), T_given,i (1 + m) (1 - s),
// a torque constant or a current's measurement that is off, which the drive itself does not see.
// Source: textbook (a drive computes its torque from current and torque constant; magnets and windings deviate by some per cent).
#include "sim/effects/uneven_groups.h"

namespace slewlab::sim {

namespace {

class UnevenMotorTorque : public Running<UnevenMotorTorque> {
 public:
  explicit UnevenMotorTorque(const EffectStart& start) : group_count_(start.model.group_count) {
    const double share = start.value("share"), mean = start.value("mean");
    for (int i = 0; i < group_count_; ++i) factor_[static_cast<std::size_t>(i)] = uneven_factor(share, mean, i, group_count_);
  }

  void actuator(const EffectMoment&, GroupArray& motor_torque) override {
    for (std::size_t i = 0; i < static_cast<std::size_t>(group_count_); ++i) motor_torque[i] *= factor_[i];
  }

 private:
  int group_count_;
  GroupArray factor_{};  // [-]
};

}  // namespace

const EffectDescription& uneven_motor_torque() {
  static const EffectDescription description{
      .about = {.name = "uneven_motor_torque",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor groups differ in the torque that they make of the same command",
                .parameters = {uneven_share_parameter(), uneven_mean_parameter()},
                .needs = {.groups = 2},
                .linear = true},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> { return std::make_unique<UnevenMotorTorque>(start); }};
  return description;
}

}  // namespace slewlab::sim
