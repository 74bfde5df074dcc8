#include "sim/effects/gear_friction.h"

#include <cmath>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class GearFriction : public Running<GearFriction> {
 public:
  explicit GearFriction(const EffectStart& start)
      : loss_(start.values[0]), sliding_speed_(start.values[1]), group_count_(start.model.group_count) {}

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
                                .meaning = "slewing speed above which the teeth slide fully",
                                .lower = 5e-5,
                                .upper = 1e-2,
                                .typical = 3e-4,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .detail = true}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<GearFriction>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
