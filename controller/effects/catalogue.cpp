#include "controller/effects/catalogue.h"

#include <stdexcept>


namespace slewlab::controller {

#define EFFECT(name) const ControllerEffect& name();
#include "controller/effects/catalogue.inc"
#undef EFFECT

const std::vector<const ControllerEffect*>& effect_catalogue() {
  static const std::vector<const ControllerEffect*> catalogue{
#define EFFECT(name) &name(),
#include "controller/effects/catalogue.inc"
#undef EFFECT
  };
  return catalogue;
}

const ControllerEffect* find_effect(std::string_view name) {
  for (const ControllerEffect* effect : effect_catalogue()) {
    if (effect->about.name == name) return effect;
  }
  return nullptr;
}

common::EffectCatalogue effects_for(const ControllerSettings& nominal) {
  std::vector<const common::EffectAbout*> laws;
  for (const ControllerEffect* effect : effect_catalogue()) laws.push_back(&effect->about);
  common::EffectScales scales;
  scales[common::ScaleOf::motor_speed] = nominal.ramp.top_speed * nominal.total_ratio;
  scales[common::ScaleOf::time] = nominal.speed_control.integral_time;
  return common::catalogue_for(laws, scales, {});
}

ControllerSettings with_effects(ControllerSettings settings,
                                const std::vector<common::EffectInstance>& effects) {
  const common::EffectCatalogue catalogue = effects_for(settings);
  for (const common::EffectInstance& instance : effects) {
    const ControllerEffect* effect = find_effect(instance.name);
    if (effect == nullptr)
      throw std::invalid_argument("no effect of the controller is called " + instance.name);
    common::check_instance(catalogue.at(instance.name), instance);
    effect->change({effect->about, instance.values}, settings);
  }
  return settings;
}

}  // namespace slewlab::controller
