#include "sim/effects/axis_bounds.h"

namespace slewlab::sim {

namespace {

constexpr double kOverload = 5.0;     // [-] of rated torque, that servo drives deliver for short: data sheets give 2 to 4; one more for a rating that is guessed
constexpr double kSlowest = 0.1;      // [-] of top speed, at which a damping may take all of it; chosen

}  // namespace

void widen_for_a_plain_axis(const common::EffectAbout& law, common::EffectAbout& about) {
  for (std::size_t k = 0; k < law.parameters.size(); ++k) {
    const common::ScaleOf per = law.parameters[k].per;
    const double factor = per == common::ScaleOf::axis_torque ? kOverload : per == common::ScaleOf::axis_damping ? kOverload / kSlowest : 1.0;
    if (about.parameters[k].lower < 0.0) about.parameters[k].lower *= factor;
    about.parameters[k].upper *= factor;
  }
}

}  // namespace slewlab::sim
