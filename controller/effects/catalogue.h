// All effects of the controller that this project knows. Effects of the machine: sim/effects/catalogue.h.
#pragma once

#include <string_view>
#include <vector>

#include "controller/effects/effect.h"

namespace slewlab::controller {

const std::vector<const ControllerEffect*>& effect_catalogue();

// nullptr where no effect has the name.
const ControllerEffect* find_effect(std::string_view name);

// The effects with their numbers in the units of a controller: `motor_speed` is the shaft's at the ramp's top speed, `time`
// the integral time.
common::EffectCatalogue effects_for(const ControllerSettings& nominal);

// The settings with the effects in them. Throws std::invalid_argument: unknown effect, value out of bounds.
ControllerSettings with_effects(ControllerSettings settings,
                                const std::vector<common::EffectInstance>& effects);

}  // namespace slewlab::controller
