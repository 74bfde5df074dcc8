#include "common/effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "common/yaml_node.h"
#include "common/near_name.h"
#include "common/yaml_reader.h"

namespace slewlab::common {

std::string missing_parts(const MachineParts& needs, const MachineParts& has) {
  std::string text;
  const auto add = [&](bool is_missing, const std::string& part) {
    if (is_missing) text += (text.empty() ? "" : " and ") + part;
  };
  add(needs.groups > has.groups, std::to_string(needs.groups) + " motor groups");
  add(needs.gears && !has.gears, "elastic gears");
  add(needs.pinion_teeth && !has.pinion_teeth, "pinion_teeth in its drive");
  add(needs.gearbox_teeth && !has.gearbox_teeth, "gearbox_ring_teeth and gearbox_sun_teeth in its drive");
  add(needs.boom && !has.boom, "a boom");
  add(needs.flexible_boom && has.boom && !has.flexible_boom, "a flexible boom");
  add(needs.flexible_boom && !needs.boom && !has.boom, "a flexible boom");
  add(needs.load && !has.load, "a load");
  return text;
}

bool size_turns_sign(const EffectAbout& about) {
  const EffectParameter& size = about.parameters[kSize];
  return size.absent && size.lower < *size.absent && size.upper > *size.absent;
}

std::size_t index_of(const EffectAbout& about, std::string_view parameter) {
  for (std::size_t i = 0; i < about.parameters.size(); ++i) {
    if (about.parameters[i].name == parameter) return i;
  }
  throw std::out_of_range("effect " + std::string(about.name) + " has no parameter " + std::string(parameter));
}

EffectAbout in_units_of(const EffectAbout& law, const EffectScales& scales) {
  EffectAbout about = law;
  for (EffectParameter& parameter : about.parameters) {
    const double scale = scales[parameter.per];
    parameter.per = ScaleOf::one;
    parameter.lower *= scale;
    parameter.upper *= scale;
    parameter.typical *= scale;
    // A logarithmic one's is a ratio.
    if (parameter.scale == ParameterScale::linear) parameter.prior_scale *= scale;
    if (parameter.absent) *parameter.absent *= scale;
    for (double& value : parameter.tries) value *= scale;
  }
  return about;
}

const EffectAbout* EffectCatalogue::find(std::string_view name) const {
  const auto place = std::find_if(effects.begin(), effects.end(), [&](const EffectAbout& about) { return about.name == name; });
  return place == effects.end() ? nullptr : &*place;
}

const EffectAbout& EffectCatalogue::at(std::string_view name) const {
  if (const EffectAbout* about = find(name)) return *about;
  for (const Unsuited& other : unsuited) {
    if (other.name == name) {
      throw std::invalid_argument("effect " + std::string(name) + " needs " + other.missing + ", which this machine has not");
    }
  }
  throw std::invalid_argument("no effect is called " + std::string(name));
}

EffectCatalogue catalogue_for(const std::vector<const EffectAbout*>& laws, const EffectScales& scales, const MachineParts& has) {
  EffectCatalogue catalogue;
  for (const EffectAbout* law : laws) {
    std::string missing = missing_parts(law->needs, has);
    if (missing.empty()) {
      catalogue.effects.push_back(in_units_of(*law, scales));
    } else {
      catalogue.unsuited.push_back({law->name, std::move(missing)});
    }
  }
  return catalogue;
}

std::vector<EffectInstance> parts_of(const EffectCatalogue& catalogue, const EffectInstance& whole) {
  const EffectAbout& about = catalogue.at(whole.name);
  if (about.parts == nullptr) return {};
  std::vector<EffectInstance> parts = about.parts({about, whole.values});
  for (EffectInstance& part : parts) {
    const EffectAbout* const law = catalogue.find(part.name);
    if (law == nullptr) return {};
    for (std::size_t i = 0; i < part.values.size(); ++i) {
      const EffectParameter& parameter = law->parameters.at(i);
      part.values[i] = std::clamp(part.values[i], parameter.lower, parameter.upper);
    }
  }
  return parts;
}

bool are_the_parts_of_one(const EffectCatalogue& catalogue, std::span<const std::string> effects) {
  return std::any_of(catalogue.effects.begin(), catalogue.effects.end(), [&](const EffectAbout& law) {
    const std::vector<EffectInstance> parts = parts_of(catalogue, typical_instance(law));
    return !parts.empty() && parts.size() == effects.size() && std::all_of(parts.begin(), parts.end(), [&](const EffectInstance& part) {
      return std::find(effects.begin(), effects.end(), part.name) != effects.end();
    });
  });
}

EffectCatalogue joined(EffectCatalogue first, const EffectCatalogue& second) {
  first.effects.insert(first.effects.end(), second.effects.begin(), second.effects.end());
  first.unsuited.insert(first.unsuited.end(), second.unsuited.begin(), second.unsuited.end());
  return first;
}

std::string expected_effect_name(const EffectCatalogue& catalogue, std::string_view name) {
  for (const EffectCatalogue::Unsuited& other : catalogue.unsuited) {
    if (other.name == name) return "an effect that suits this machine; this one needs " + other.missing;
  }
  std::vector<std::string> known;
  for (const EffectAbout& about : catalogue.effects) known.emplace_back(about.name);
  if (const auto near = nearest_name(name, known)) return "the name of an effect; '" + *near + "' is near";
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  return "one of " + all;
}

std::string_view name_of(ScaleOf scale) {
  constexpr std::array<std::string_view, kScaleCount> kNames{
      "-",          "time",           "swing time",        "motor torque", "drive torque", "motor speed", "axis torque", "axis speed",
      "axis angle", "axis damping",   "gear stiffness",    "gearbox stiffness", "gear wind-up", "length", "velocity",
      "wind speed", "mass",           "force",             "lateral stiffness", "lateral damping", "drag area"};
  return kNames[static_cast<std::size_t>(scale)];
}

std::string_view name_of(Family family) {
  constexpr std::array<std::string_view, 9> kNames{"", "friction", "delay", "play", "elasticity", "mass", "gravity", "wind", "ripple"};
  return kNames[static_cast<std::size_t>(family)];
}

std::string_view name_of(Subsystem subsystem) {
  constexpr std::array<std::string_view, 8> kNames{"drive",       "house",  "boom", "load",
                                                   "environment", "sensor", "wire", "controller"};
  return kNames[static_cast<std::size_t>(subsystem)];
}

EffectParameter angle_parameter(std::string_view name, std::string_view meaning, double typical) {
  return {.name = name,
          .unit = Unit::radian,
          .per = ScaleOf::one,
          .meaning = meaning,
          .lower = -std::numbers::pi,
          .upper = std::numbers::pi,
          .typical = typical,
          .prior_scale = 2.0,  // wide: any angle is as likely
          .scale = ParameterScale::linear,
          .absent = std::nullopt};
}

std::string parameter_row(const EffectParameter& parameter) {
  const auto rounded = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return std::string(text);
  };
  std::string absent = "-";
  if (parameter.absent) absent = std::isinf(*parameter.absent) ? "infinite" : rounded(*parameter.absent);
  const bool logarithmic = parameter.scale == ParameterScale::logarithmic;
  const bool about_absent = parameter.absent && std::isfinite(*parameter.absent);
  return "| `" + std::string(parameter.name) + "` | " + std::string(name_of(parameter.unit)) + " | " +
         std::string(name_of(parameter.per)) + " | " + rounded(parameter.lower) + " ... " + rounded(parameter.upper) + " | " + rounded(parameter.typical) +
         " | " + (logarithmic ? "ln: " : "") + rounded(about_absent ? *parameter.absent : parameter.typical) +
         " +- " + rounded(parameter.prior_scale) + " | " + absent + " | " + std::string(parameter.meaning) +
         " |";
}

EffectInstance typical_instance(const EffectAbout& about) {
  EffectInstance instance{.name = std::string(about.name), .values = {}};
  for (const EffectParameter& parameter : about.parameters) instance.values.push_back(parameter.typical);
  return instance;
}

void check_instance(const EffectAbout& about, const EffectInstance& instance) {
  const std::string start = "effect " + std::string(about.name) + ": ";
  if (instance.values.size() != about.parameters.size()) {
    throw std::invalid_argument(start + "needs " + std::to_string(about.parameters.size()) + " values, got " +
                                std::to_string(instance.values.size()));
  }
  for (std::size_t i = 0; i < instance.values.size(); ++i) {
    const EffectParameter& parameter = about.parameters[i];
    const double value = instance.values[i];
    if (value >= parameter.lower && value <= parameter.upper) continue;
    throw std::invalid_argument(start + std::string(parameter.name) + " is " + shortest(value) + " " +
                                std::string(name_of(parameter.unit)) + ", allowed is " +
                                shortest(parameter.lower) + " ... " + shortest(parameter.upper));
  }
}

std::vector<EffectInstance> read_effects(const YamlNode& list,
                                         const EffectCatalogue& catalogue, InputProblems& problems) {
  std::vector<EffectInstance> instances;
  if (list.kind == YamlNode::Kind::null) return instances;
  YamlNode file;
  file.kind = YamlNode::Kind::map;
  file.mark = list.mark;
  file.entries.push_back({"effects", list.mark, list});
  YamlReader reader(file, "", problems);
  reader.each("effects", [&](YamlReader& entry) {
    EffectInstance instance{.name = entry.text("effect"), .values = {}};
    if (instance.name.empty()) return;  // the reader has told why
    const EffectAbout* about = catalogue.find(instance.name);
    if (about == nullptr) {
      entry.report("effect", instance.name, expected_effect_name(catalogue, instance.name));
      return;
    }
    const bool repeated = std::any_of(instances.begin(), instances.end(), [&](const EffectInstance& other) {
      return other.name == instance.name;
    });
    if (repeated) entry.report("effect", instance.name, "each effect once");
    for (const EffectParameter& parameter : about->parameters) {
      instance.values.push_back(
          entry.number(parameter.name, parameter.unit, between(parameter.lower, parameter.upper)));
    }
    entry.finish();
    if (!repeated) instances.push_back(std::move(instance));
  });
  return instances;
}

std::string effects_text(const std::vector<EffectInstance>& instances, const EffectCatalogue& catalogue,
                         std::string_view source, const std::map<std::string, std::string>& notes) {
  std::string text = "effects:\n";
  for (const EffectInstance& instance : instances) {
    const EffectAbout& about = catalogue.at(instance.name);
    check_instance(about, instance);
    text += "  - effect: " + instance.name + "\n";
    for (std::size_t i = 0; i < instance.values.size(); ++i) {
      const EffectParameter& parameter = about.parameters[i];
      const auto note = notes.find(instance.name + "." + std::string(parameter.name));
      const std::string origin = std::string(source) + (note == notes.end() ? "" : ", " + note->second);
      text += "    " + std::string(parameter.name) + ": " + quantity_text(shortest(instance.values[i]), parameter.unit, origin) + "\n";
    }
  }
  return text;
}

}  // namespace slewlab::common
