// What dynamic pressures across the boom do to boom and load.
#pragma once

#include "sim/effects/effect.h"
#include "sim/machine/effect_scales.h"

namespace slewlab::sim {

struct DragAreas {
  double boom_per_length = 0.0;  // [m] drag coefficient times area, per length of the boom
  double load = 0.0;             // [m^2]
};

// Both are guesses before a wind is measured; a diagnosis fits them beside the wind's speed.
common::EffectParameter boom_drag_area_parameter();
common::EffectParameter load_drag_area_parameter();

// `boom` [m^2] of the whole boom, `load` [m^2]; 0 where the crane has no boom or no load.
DragAreas drag_areas(const CraneParameters& crane, double boom, double load);

// Pressures [N/m^2] across the boom.
void add_wind(const DragAreas& areas, double on_boom, double on_load, PortForces& ports);

}  // namespace slewlab::sim
