#include "sim/effects/catalogue.h"

#include "sim/machine/effect_scales.h"

namespace slewlab::sim {

#define EFFECT(name) const EffectDescription& name();
#include "sim/effects/catalogue.inc"
#undef EFFECT

const std::vector<const EffectDescription*>& effect_catalogue() {
  static const std::vector<const EffectDescription*> catalogue{
#define EFFECT(name) &name(),
#include "sim/effects/catalogue.inc"
#undef EFFECT
  };
  return catalogue;
}

const EffectDescription* find_effect(std::string_view name) {
  for (const EffectDescription* description : effect_catalogue()) {
    if (description->about.name == name) return description;
  }
  return nullptr;
}

common::EffectCatalogue effects_for(const CraneParameters& machine, const common::EffectScales& scales) {
  static const std::vector<const common::EffectAbout*> laws = [] {
    std::vector<const common::EffectAbout*> list;
    for (const EffectDescription* description : effect_catalogue()) list.push_back(&description->about);
    return list;
  }();
  return common::catalogue_for(laws, scales, parts_of(machine));
}

common::EffectCatalogue effects_for(const CraneParameters& nominal) { return effects_for(nominal, effect_scales(nominal)); }

common::EffectCatalogue effects_for(const MachineSettings& settings) {
  return effects_for(settings.crane, settings.scales ? *settings.scales : effect_scales(settings.crane, settings.drive_protection));
}

}  // namespace slewlab::sim
