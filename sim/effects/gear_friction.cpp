#include "sim/effects/gear_friction.h"

#include <cmath>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class GearFriction : public Running<GearFriction> {
 public:
  explicit GearFriction(const EffectStart& start)
      : loss_(start.values[0]), group_count_(start.model.group_count) {}

  void friction(const EffectMoment& moment, FrictionLevels& levels) override {
    for (int i = 0; i < group_count_; ++i) levels.motor[i] += loss_ * std::fabs(moment.gear_torque[i]);
  }

 private:
  double loss_;
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
                                .absent = 0.0}}},
      .ports = {EffectPort::friction},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<GearFriction>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
