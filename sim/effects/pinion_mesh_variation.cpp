#include "sim/effects/pinion_mesh_variation.h"

#include <numbers>

#include "sim/effects/mean_sine.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kTeeth = 12.0;  // Z_p, thesis Table 2.1

class PinionMeshVariation : public Running<PinionMeshVariation> {
 public:
  explicit PinionMeshVariation(const EffectStart& start)
      : amplitude_(start.values[0]),
        phase_(start.values[1]),
        order_(kTeeth * start.model.parameters.drive.pinion_ratio),
        group_count_(start.model.group_count) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    for (int i = 0; i < group_count_; ++i) {
      const double change =
          amplitude_ * moment.gear_torque[i] *
          mean_sine(order_ * moment.house_angle + phase_, order_ * moment.house_speed * moment.step);
      ports.motor_torque[i] -= change;
      ports.house_torque += change;
    }
  }

 private:
  double amplitude_;
  double phase_;
  double order_;  // [1/rad] meshes per radian of the slew axis
  int group_count_;
};

}  // namespace

const EffectDescription& pinion_mesh_variation() {
  static const EffectDescription description{
      .about = {.name = "pinion_mesh_variation",
                .subsystem = common::Subsystem::drive,
                .physics = "gear stiffness goes up and down with the mesh of the pinion",
                .parameters = {{.name = "amplitude",
                                .unit = common::Unit::none,
                                .meaning = "share of the group's stiffness",
                                .lower = 0.0,
                                .upper = 0.6,
                                .typical = 0.1,
                                .prior_scale = 0.05,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "phase",
                                .unit = common::Unit::radian,
                                .meaning = "phase of the mesh at the start",
                                .lower = -std::numbers::pi,
                                .upper = std::numbers::pi,
                                .typical = 0.0,
                                .prior_scale = 2.0,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<PinionMeshVariation>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
