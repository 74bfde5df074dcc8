#include "common/effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "common/yaml_node.h"
#include "common/yaml_reader.h"

namespace slewlab::common {

namespace {

const EffectAbout* find(const std::vector<const EffectAbout*>& catalogue, std::string_view name) {
  const auto place = std::find_if(catalogue.begin(), catalogue.end(),
                                  [&](const EffectAbout* about) { return about->name == name; });
  return place == catalogue.end() ? nullptr : *place;
}

}  // namespace

std::string expected_effect_name(const std::vector<const EffectAbout*>& catalogue, std::string_view name) {
  std::vector<std::string> known;
  for (const EffectAbout* about : catalogue) known.emplace_back(about->name);
  if (const auto near = nearest_name(name, known)) return "the name of an effect; '" + *near + "' is near";
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  return "one of " + all;
}

std::string_view name_of(Subsystem subsystem) {
  constexpr std::array<std::string_view, 8> kNames{"drive",       "house",  "boom", "load",
                                                   "environment", "sensor", "wire", "controller"};
  return kNames[static_cast<std::size_t>(subsystem)];
}

EffectParameter angle_parameter(std::string_view name, std::string_view meaning, double typical) {
  return {.name = name,
          .unit = Unit::radian,
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
         rounded(parameter.lower) + " ... " + rounded(parameter.upper) + " | " + rounded(parameter.typical) +
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
                                         const std::vector<const EffectAbout*>& catalogue,
                                         InputProblems& problems) {
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
    const EffectAbout* about = find(catalogue, instance.name);
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

std::string effects_text(const std::vector<EffectInstance>& instances,
                         const std::vector<const EffectAbout*>& catalogue, std::string_view source) {
  std::string text = "effects:\n";
  for (const EffectInstance& instance : instances) {
    const EffectAbout* about = find(catalogue, instance.name);
    if (about == nullptr) throw std::invalid_argument("no effect is called " + instance.name);
    check_instance(*about, instance);
    text += "  - effect: " + instance.name + "\n";
    for (std::size_t i = 0; i < instance.values.size(); ++i) {
      const EffectParameter& parameter = about->parameters[i];
      text += "    " + std::string(parameter.name) + ": " + quantity_text(shortest(instance.values[i]), parameter.unit, source) + "\n";
    }
  }
  return text;
}

}  // namespace slewlab::common
