#include "sim/effects/catalogue.h"

#include "sim/effects/air_drag.h"
#include "sim/effects/bearing_coulomb.h"
#include "sim/effects/bearing_stribeck.h"
#include "sim/effects/bearing_viscous.h"
#include "sim/effects/boom_damping.h"
#include "sim/effects/boom_stiffness.h"
#include "sim/effects/clock_drift.h"
#include "sim/effects/command_delay.h"
#include "sim/effects/command_jitter.h"
#include "sim/effects/command_loss.h"
#include "sim/effects/compression_softening.h"
#include "sim/effects/dead_time.h"
#include "sim/effects/dragging_brake.h"
#include "sim/effects/encoder_delay.h"
#include "sim/effects/encoder_quantisation.h"
#include "sim/effects/encoder_ripple.h"
#include "sim/effects/encoder_scale.h"
#include "sim/effects/flyjib_torsion.h"
#include "sim/effects/gear_friction.h"
#include "sim/effects/gearbox_mesh_variation.h"
#include "sim/effects/gusts.h"
#include "sim/effects/heel.h"
#include "sim/effects/hoisting.h"
#include "sim/effects/house_compliance.h"
#include "sim/effects/house_inertia.h"
#include "sim/effects/hydraulic_compliance.h"
#include "sim/effects/large_angles.h"
#include "sim/effects/larger_play.h"
#include "sim/effects/load_mass.h"
#include "sim/effects/offlead.h"
#include "sim/effects/pedestal_flexibility.h"
#include "sim/effects/pinion_in_series.h"
#include "sim/effects/pinion_mesh_variation.h"
#include "sim/effects/rope_length.h"
#include "sim/effects/tag_line.h"
#include "sim/effects/torque_lag.h"
#include "sim/effects/torque_limit.h"
#include "sim/effects/torque_ripple.h"
#include "sim/effects/uneven_gearbox_stiffness.h"
#include "sim/effects/uneven_motor_inertia.h"
#include "sim/effects/uneven_play.h"
#include "sim/effects/vessel_roll.h"
#include "sim/effects/wind.h"

namespace slewlab::sim {

const std::vector<const EffectDescription*>& effect_catalogue() {
  static const std::vector<const EffectDescription*> catalogue{
      &torque_lag(),
      &torque_limit(),
      &dead_time(),
      &torque_ripple(),
      &uneven_motor_inertia(),
      &uneven_gearbox_stiffness(),
      &larger_play(),
      &uneven_play(),
      &pinion_in_series(),
      &pinion_mesh_variation(),
      &gearbox_mesh_variation(),
      &gear_friction(),
      &dragging_brake(),
      &hydraulic_compliance(),
      &bearing_coulomb(),
      &bearing_viscous(),
      &bearing_stribeck(),
      &house_inertia(),
      &house_compliance(),
      &pedestal_flexibility(),
      &heel(),
      &compression_softening(),
      &boom_damping(),
      &boom_stiffness(),
      &flyjib_torsion(),
      &wind(),
      &load_mass(),
      &rope_length(),
      &hoisting(),
      &large_angles(),
      &air_drag(),
      &offlead(),
      &tag_line(),
      &vessel_roll(),
      &gusts(),
      &encoder_quantisation(),
      &encoder_ripple(),
      &encoder_scale(),
      &encoder_delay(),
      &clock_drift(),
      &command_delay(),
      &command_jitter(),
      &command_loss(),
  };
  return catalogue;
}

const EffectDescription* find_effect(std::string_view name) {
  for (const EffectDescription* description : effect_catalogue()) {
    if (description->about.name == name) return description;
  }
  return nullptr;
}

const std::vector<const common::EffectAbout*>& effect_abouts() {
  static const std::vector<const common::EffectAbout*> abouts = [] {
    std::vector<const common::EffectAbout*> list;
    for (const EffectDescription* description : effect_catalogue()) list.push_back(&description->about);
    return list;
  }();
  return abouts;
}

}  // namespace slewlab::sim
