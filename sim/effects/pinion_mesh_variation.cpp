// Pinion mesh variation: the stiffness of the teeth in contact goes up and down with the mesh,
//   k(theta) = k (1 + a (sin(m + phase) + second_sine sin(2 m) + second_cosine cos(2 m))),   m = Z_p i_pinion theta_house,
// second_sine and second_cosine because teeth take over with corners, not with a sine. The pinion turns with
// the house; the gearbox gives between it and the motor. Pinions stand at other teeth of the rim, so the last half of the groups has
// the same wave with a phase of its own; a tooth is damaged in one of them, so the first half has (1 + share) a, the last half (1 - share) a.
// Z_p is the machine's drive.pinion_teeth. a is the share of the group's whole stiffness: 20 % of the pinion's
// (2.7) in series with the gearbox is a = 0.2 k_gearbox / (k_gearbox + k_pinion). Acts as the contact's torque (gear.h) at k(theta) less the one at
// k, on the house and back on the motor; the contact's damping stays (mesh_variation.h, mesh_torque.h).
// Source: thesis (2.1), (2.3).
#include "sim/effects/effect.h"

#include "sim/effects/mesh_variation.h"
#include "sim/effects/ripple.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

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
                               common::angle_parameter("phase", "at the start, in the first half of the groups"),
                               common::angle_parameter("phase_last", "at the start, in the last half"),
                               second_sine_parameter(),
                               second_cosine_parameter(),
                               ripple_share_parameter()},
                .needs = {.gears = true, .pinion_teeth = true},
                .family = common::Family::ripple},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        const DriveParameters& drive = start.model.parameters.drive;
        const Ripple ripple{.order = drive.pinion_teeth * drive.pinion_ratio,
                            .phase = start.value("phase"),
                            .second_sine = start.value("second_sine"),
                            .second_cosine = start.value("second_cosine")};
        return start_mesh_variation(start, start.value("amplitude"), ripples_of_groups(ripple, {.phase_last = start.value("phase_last"), .share = start.value("share")}, start.model.group_count), MeshAngle::house);
      }};
  return description;
}

}  // namespace slewlab::sim
