// Pedestal flexibility: the pedestal bends sideways, so that house and boom's pivot move laterally by y_p,
//   (M_top + M_boom) y_p'' + integral of m y'' dx + 2 zeta sqrt(k (M_top + M_boom)) y_p' + k y_p = F_rope,
// y being the boom's displacement against the house. In the house's frame everything feels the pseudo
// force of -y_p'' per mass: boom, load and rod. Accelerometers feel y_p'' besides; shaft encoders do not.
// Translation across the boom only; the frame is taken as not turning. Explicit, second order; the boom's
// reaction to y_p'' in the same step is solved for.
// Source: textbook; the thesis founds the crane rigidly.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& pedestal_flexibility();

}  // namespace slewlab::sim
