// Command delay: what the controller says arrives at the drives a fixed time later, torque, brake and
// enable. Where it arrives inside a step, the step gets the mean of the torques and the older enable.
// Source: textbook (bus cycle between PLC and drive). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& command_delay();

}  // namespace slewlab::sim
