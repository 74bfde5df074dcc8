// A mesh whose stiffness goes up and down with its angle, at work: what pinion_mesh_variation and
// gearbox_mesh_variation share.
//
// Over a step acts the torque that the change of stiffness adds in its middle (mesh_torque.h), at the mean of the
// ripple over the turned angle. Accelerometers feel the torque of the moment in which they read: at 150 Hz the middle
// of the last step of 1 ms is 27 degrees behind.
#pragma once

#include <array>
#include <memory>

#include "sim/effects/effect.h"
#include "sim/effects/ripple.h"

namespace slewlab::sim {

enum class MeshAngle { house, motor };  // which one the ripple goes over, on the slew axis

// `amplitude` [-] of the group's stiffness; each group goes by its own ripple.
std::unique_ptr<RunningEffect> start_mesh_variation(const EffectStart& start, double amplitude, const GroupRipples& ripples,
                                                    MeshAngle angle);

}  // namespace slewlab::sim
