// What an effect makes of a controller's settings.
#pragma once

#include <string_view>
#include <vector>

#include "controller/effects/catalogue.h"

namespace slewlab::controller {

// Values in the order of the effect's parameters.
inline void change_by(std::string_view effect, const std::vector<double>& values, ControllerSettings& settings) {
  const ControllerEffect* description = find_effect(effect);
  description->change({description->about, values}, settings);
}

}  // namespace slewlab::controller
