// An effect on the controller's side of the wire: the controller that runs differs from its settings.
#pragma once

#include <vector>

#include "common/effect.h"
#include "controller/controller.h"

namespace slewlab::controller {

struct ControllerEffect {
  common::EffectAbout about;  // numbers as multiples of a controller's scales (common/effect.h)
  void (*change)(const common::EffectValues& values, ControllerSettings& settings) = nullptr;
};

}  // namespace slewlab::controller
