// Bounds of effects on a plain axis. Ratings of a plain axis are often guessed and its motor is overloaded for short: friction and constant
// torques may reach what such a drive delivers at its most, and a damping takes that torque at a fraction of the top speed. The bounds of
// torques and dampings on the axis lie so many times further out than a crane's; typical sizes and priors stay.
#pragma once

#include "common/effect.h"

namespace slewlab::sim {

// `law` as its own file describes it, `about` the same in the machine's units.
void widen_for_a_plain_axis(const common::EffectAbout& law, common::EffectAbout& about);

}  // namespace slewlab::sim
