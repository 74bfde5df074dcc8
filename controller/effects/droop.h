// Droop in the drives that the settings know nothing of: the speed reference of a group falls by k T / T100.
// Source: thesis 2.3 and appendix D (as the notes give it); off in the thesis's model.
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& droop();

}  // namespace slewlab::controller
