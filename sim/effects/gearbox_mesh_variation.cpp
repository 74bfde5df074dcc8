#include "sim/effects/gearbox_mesh_variation.h"

#include "sim/effects/mesh_variation.h"
#include "sim/effects/ripple.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

const EffectDescription& gearbox_mesh_variation() {
  static const EffectDescription description{
      .about = {.name = "gearbox_mesh_variation",
                .subsystem = common::Subsystem::drive,
                .physics = "gear stiffness goes up and down with the mesh of the gearbox",
                .parameters = {{.name = "amplitude",
                                .unit = common::Unit::none,
                                .meaning = "share of the group's stiffness",
                                .lower = 0.0,
                                .upper = 0.05,
                                .typical = 0.003,
                                .prior_scale = 0.002,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("phase", "phase of the mesh at the start"),
                               second_sine_parameter(),
                               second_cosine_parameter()}},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        const Ripple ripple{.order = planetary_mesh_frequency(110, 8, 1.0) * start.model.ratio,
                            .phase = start.values[1],
                            .second_sine = start.values[2],
                            .second_cosine = start.values[3]};
        return start_mesh_variation(start, start.values[0], ripple, MeshAngle::motor);
      }};
  return description;
}

}  // namespace slewlab::sim
