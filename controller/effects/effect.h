// An effect on the controller's side of the wire: the controller that runs differs from its settings.
#pragma once

#include <vector>

#include "common/effect.h"
#include "controller/controller.h"

namespace slewlab::controller {

struct ControllerEffect {
  common::EffectAbout about;
  void (*change)(const std::vector<double>& values, ControllerSettings& settings) = nullptr;
};

}  // namespace slewlab::controller
