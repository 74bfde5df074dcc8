// The scales of a machine as effects know them: what the numbers of their parameters are multiples of (common/effect.h).
#pragma once

#include "common/effect.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// Throws std::invalid_argument where the machine has no scales (scales.h).
common::EffectScales effect_scales(const CraneParameters& nominal, const DriveProtectionSettings& protection = {});

common::MachineParts parts_of(const CraneParameters& machine);

inline constexpr double kAirDensity = 1.225;  // [kg/m^3] at sea level and 15 degrees C, standard atmosphere

}  // namespace slewlab::sim
