#include "sim/effects/catalogue.h"

#include "sim/effects/axis_bounds.h"
#include "sim/machine/effect_scales.h"
#include "sim/machine/machine_file.h"

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

namespace {

common::Unit of_a_linear_axis(common::Unit unit, common::ScaleOf per, bool is_shaft_linear) {
  using common::ScaleOf;
  using common::Unit;
  switch (per) {
    case ScaleOf::axis_torque:
    case ScaleOf::axis_speed:
    case ScaleOf::axis_angle:
    case ScaleOf::axis_damping: break;
    case ScaleOf::motor_torque:
    case ScaleOf::drive_torque:
    case ScaleOf::motor_speed:
      if (is_shaft_linear) break;
      return unit;
    default: return unit;
  }
  switch (unit) {
    case Unit::newton_metre: return Unit::newton;
    case Unit::radian: return Unit::metre;
    case Unit::radian_per_second: return Unit::metre_per_second;
    case Unit::newton_metre_second_per_radian: return Unit::newton_second_per_metre;
    default: return unit;
  }
}

}  // namespace

common::EffectCatalogue effects_for(const MachineFile& file) {
  common::EffectCatalogue catalogue = effects_for(file.parameters, effect_scales(file.parameters, file.drive_protection));
  if (file.kind != MachineKind::axis) return catalogue;
  for (common::EffectAbout& about : catalogue.effects) {
    widen_for_a_plain_axis(find_effect(about.name)->about, about);
    if (!file.axis.is_linear) continue;
    const std::vector<common::EffectParameter>& law = find_effect(about.name)->about.parameters;
    for (std::size_t k = 0; k < law.size(); ++k) about.parameters[k].unit = of_a_linear_axis(law[k].unit, law[k].per, file.axis.is_shaft_linear);
  }
  return catalogue;
}

}  // namespace slewlab::sim
