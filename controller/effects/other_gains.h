// Other gains: proportional gain and integral time are factors times what the settings say.
// Source: thesis 3.5 (PI; its gains are not given).
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& other_gains();

}  // namespace slewlab::controller
