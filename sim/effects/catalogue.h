// All effects of the machine that this project knows, and their names in a crane's file.
// Effects of the controller stand in controller/effects/catalogue.h.
#pragma once

#include <string_view>
#include <vector>

#include "sim/effects/effect.h"

namespace slewlab::sim {

const std::vector<const EffectDescription*>& effect_catalogue();

// nullptr where no effect has the name.
const EffectDescription* find_effect(std::string_view name);

// For common::read_effects and common::effects_text.
const std::vector<const common::EffectAbout*>& effect_abouts();

}  // namespace slewlab::sim
