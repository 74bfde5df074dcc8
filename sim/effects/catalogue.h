// All effects of the machine that this project knows, and their names in a machine's file.
// Effects of the controller stand in controller/effects/catalogue.h.
#pragma once

#include <string_view>
#include <vector>

#include "sim/effects/effect.h"

namespace slewlab::sim {

struct MachineFile;

const std::vector<const EffectDescription*>& effect_catalogue();

// nullptr where no effect has the name.
const EffectDescription* find_effect(std::string_view name);

// The effects that suit a machine, with their numbers in its units: bounds, sizes to start from, priors. The scales are
// those of `scales_of`, of the nominal machine where `machine` is a changed one.
common::EffectCatalogue effects_for(const CraneParameters& machine, const common::EffectScales& scales);
common::EffectCatalogue effects_for(const CraneParameters& nominal);
// Of the settings' machine, with the scales that they carry.
common::EffectCatalogue effects_for(const MachineSettings& settings);
// Of a machine's file, for reading and writing it: units are the machine's kind's. On a linear axis what acts on the axis or counts
// along it is in N, m, m/s and N s/m; what belongs to a motor's shaft only where that is the carriage.
common::EffectCatalogue effects_for(const MachineFile& file);

}  // namespace slewlab::sim
