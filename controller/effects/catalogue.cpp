#include "controller/effects/catalogue.h"

#include <stdexcept>

#include "controller/effects/droop.h"
#include "controller/effects/other_gains.h"
#include "controller/effects/other_play_compensation.h"
#include "controller/effects/other_ramp.h"
#include "controller/effects/speed_filter.h"

namespace slewlab::controller {

const std::vector<const ControllerEffect*>& effect_catalogue() {
  static const std::vector<const ControllerEffect*> catalogue{
      &droop(), &other_gains(), &other_ramp(), &other_play_compensation(), &speed_filter(),
  };
  return catalogue;
}

const ControllerEffect* find_effect(std::string_view name) {
  for (const ControllerEffect* effect : effect_catalogue()) {
    if (effect->about.name == name) return effect;
  }
  return nullptr;
}

const std::vector<const common::EffectAbout*>& effect_abouts() {
  static const std::vector<const common::EffectAbout*> abouts = [] {
    std::vector<const common::EffectAbout*> list;
    for (const ControllerEffect* effect : effect_catalogue()) list.push_back(&effect->about);
    return list;
  }();
  return abouts;
}

ControllerSettings with_effects(ControllerSettings settings,
                                const std::vector<common::EffectInstance>& effects) {
  for (const common::EffectInstance& instance : effects) {
    const ControllerEffect* effect = find_effect(instance.name);
    if (effect == nullptr)
      throw std::invalid_argument("no effect of the controller is called " + instance.name);
    common::check_instance(effect->about, instance);
    effect->change(instance.values, settings);
  }
  return settings;
}

}  // namespace slewlab::controller
