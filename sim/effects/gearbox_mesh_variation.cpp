// Gearbox mesh variation: the stiffness of the gearbox's first planetary stage goes up and down with its
// mesh,
//   k(theta) = k (1 + a (sin(m + phase) + second_sine sin(2 m) + second_cosine cos(2 m))),   m = Z_r Z_s / (Z_r + Z_s) theta_motor.
// Z_r and Z_s are the machine's drive.gearbox_ring_teeth and gearbox_sun_teeth. a is the share of the group's
// whole stiffness: small, because the fast stage's own compliance counts on the outgoing shaft by its ratio
// squared. Acts as the contact's torque (gear.h) at k(theta) less the one at k, on the house and back on the
// motor; the contact's damping stays (mesh_variation.h, mesh_torque.h). The mean over the turned angle of a
// step is taken, so that a mesh faster than the step does not fold down.
// Source: thesis (2.1), (2.2).
#include "sim/effects/effect.h"

#include "sim/effects/mesh_variation.h"
#include "sim/effects/ripple.h"
#include "sim/integrate/plant.h"
#include "sim/model/gear.h"

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
                               second_cosine_parameter()},
                .is_arrow = true,
                .needs = {.gears = true, .gearbox_teeth = true},
                .family = common::Family::ripple},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        const DriveParameters& drive = start.model.parameters.drive;
        const Ripple ripple{.order = planetary_mesh_frequency(drive.gearbox_ring_teeth, drive.gearbox_sun_teeth, 1.0) * start.model.ratio,
                            .phase = start.value("phase"),
                            .second_sine = start.value("second_sine"),
                            .second_cosine = start.value("second_cosine")};
        return start_mesh_variation(start, start.value("amplitude"), ripples_of_groups(ripple, {.phase_last = ripple.phase}, start.model.group_count), MeshAngle::motor);
      }};
  return description;
}

}  // namespace slewlab::sim
