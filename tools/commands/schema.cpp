#include "tools/commands/schema.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "common/input_error.h"
#include "common/near_name.h"
#include "common/yaml_inquiry.h"
#include "controller/controller_tree.h"
#include "sim/drive/fault_file.h"
#include "sim/drive/scenario_file.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/axis_file.h"
#include "sim/machine/crane_file.h"
#include "tools/acceptance/limits.h"
#include "tools/acceptance/plan.h"
#include "tools/campaign/study.h"
#include "tools/plc/plc_map.h"
#include "tools/soak/settings.h"

namespace slewlab::tools {
namespace {

using common::KeyDescription;
using common::YamlReader;
using Json = nlohmann::ordered_json;

Json text_schema() { return {{"type", "string"}}; }

Json closed_object(Json properties, Json required) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"required", std::move(required)}, {"additionalProperties", false}};
}

// The regular expression of a unit's spelling as common::factor_to_si takes it: blanks and signs of multiplication between its parts do
// not matter, and there are signs for powers and degrees.
std::string pattern_of(const std::string& spelling) {
  std::string pattern;
  for (std::size_t i = 0; i < spelling.size();) {
    const std::string_view rest = std::string_view(spelling).substr(i);
    std::string part;
    std::size_t length = 1;
    if (rest.starts_with("^2") || rest.starts_with("^3") || rest.starts_with("^4")) {
      length = 2;
      part = rest[1] == '4' ? "\\^4" : rest[1] == '2' ? "(\\^2|\u00b2)" : "(\\^3|\u00b3)";
    } else if (rest.starts_with("deg")) {
      length = 3;
      part = "(deg|\u00b0)";
    } else if (rest[0] != ' ') {
      length = std::min(rest.find_first_of(" ^/"), rest.size());
      length = std::max<std::size_t>(length, 1);
      part = rest.substr(0, length);
    }
    if (!part.empty()) pattern += (pattern.empty() ? "" : "[ *\u00b7]*") + part;
    i += length;
  }
  return pattern;
}

// The spellings as common/unit has them, for an editor to offer, and every other way of writing them.
Json units(common::Unit unit, const std::vector<common::Unit>& others = {}) {
  Json names = Json::array();
  std::string all = common::spellings_of(unit);
  for (const common::Unit other : others) all += ", " + common::spellings_of(other);
  for (std::size_t begin = 0; begin <= all.size();) {
    const std::size_t end = std::min(all.find(", ", begin), all.size());
    names.push_back(all.substr(begin, end - begin));
    begin = end + 2;
  }
  std::string pattern;
  bool has_other_ways = false;
  for (const auto& name : names) {
    const std::string spelling = name.get<std::string>();
    has_other_ways = has_other_ways || pattern_of(spelling) != spelling;
    pattern += (pattern.empty() ? "" : "|") + pattern_of(spelling);
  }
  if (!has_other_ways) return {{"enum", names}};
  return {{"anyOf", Json::array({{{"enum", names}}, {{"type", "string"}, {"pattern", "^(" + pattern + ")$"}}})}};
}

// Zero is the same in every unit; other bounds are in SI, and only a number without a unit is that in a file.
void bound(Json& number, const common::Range& range, bool in_si) {
  if (std::isfinite(range.lowest) && (in_si || range.lowest == 0.0)) number[range.lowest_allowed ? "minimum" : "exclusiveMinimum"] = range.lowest;
  if (std::isfinite(range.highest) && (in_si || range.highest == 0.0)) number["maximum"] = range.highest;
}

// {value, unit, source}
Json quantity(Json value, common::Unit unit, const std::vector<common::Unit>& other_units = {}) {
  return closed_object({{"value", std::move(value)}, {"unit", units(unit, other_units)}, {"source", text_schema()},
                        {"spread", {{"type", Json::array({"number", "string"})}, {"description", "one standard deviation from unit to unit, such as 10 %"}}}},
                       {"value", "unit", "source"});
}

Json named(const std::vector<std::string>& names) {
  Json choices = Json::array();
  for (const std::string& name : names) choices.push_back(name == "true" ? Json(true) : name == "false" ? Json(false) : Json(name));
  return {{"enum", choices}};
}

Json leaf(const KeyDescription& key) {
  switch (key.kind) {
    case KeyDescription::Kind::number: {
      Json number{{"type", "number"}};
      bound(number, key.range, false);
      return quantity(number, key.unit, key.other_units);
    }
    case KeyDescription::Kind::integer: {
      Json number{{"type", "integer"}};
      bound(number, key.range, true);
      return quantity(number, common::Unit::none);
    }
    case KeyDescription::Kind::numbers: {
      Json number{{"type", "number"}};
      bound(number, key.range, false);
      return quantity({{"type", "array"}, {"items", number}, {"minItems", key.fewest}, {"maxItems", key.most}}, key.unit, key.other_units);
    }
    case KeyDescription::Kind::choice:
      return key.is_sourced ? closed_object({{"value", named(key.choices)}, {"source", text_schema()}}, {"value", "source"}) : named(key.choices);
    case KeyDescription::Kind::text:
    case KeyDescription::Kind::file: return text_schema();
    default: return Json::object();
  }
}

bool is_child(const std::string& path, const std::string& parent) {
  return path.size() > parent.size() && path.starts_with(parent) && path.find('.', parent.size()) == std::string::npos;
}

// The object whose keys begin with `prefix`: "" or a path with its dot.
Json object_below(const std::vector<KeyDescription>& keys, const std::string& prefix) {
  Json properties = Json::object();
  for (const KeyDescription& key : keys) {
    if (!is_child(key.path, prefix) || key.path.ends_with('*')) continue;
    Json& property = properties[key.path.substr(prefix.size())];
    if (key.kind == KeyDescription::Kind::map) {
      property = object_below(keys, key.path + '.');
      property["type"] = Json::array({"object", "null"});  // null takes away what an included file has
    } else if (key.kind == KeyDescription::Kind::list) {
      property = {{"type", Json::array({"array", "null"})}, {"items", object_below(keys, key.path + ".*.")}};
    } else {
      property = leaf(key);
    }
  }
  // What an included file says need not be said again, so that no key is required below the root.
  return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
}

// What a machine's file may have under `effects:`. Of an axis units are its own, and left open.
Json effects_schema(bool is_crane) {
  Json kinds = Json::array();
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) {
    Json properties{{"effect", {{"const", effect->about.name}}}};
    Json required{"effect"};
    for (const common::EffectParameter& parameter : effect->about.parameters) {
      const std::string name(parameter.name);
      properties[name] = is_crane ? quantity({{"type", "number"}}, parameter.unit)
                                  : closed_object({{"value", {{"type", "number"}}}, {"unit", text_schema()}, {"source", text_schema()}}, {"value", "unit", "source"});
      properties[name]["description"] = parameter.meaning;
      required.push_back(name);
    }
    Json kind = closed_object(properties, required);
    kind["description"] = effect->about.physics;
    kinds.push_back(kind);
  }
  return {{"type", Json::array({"array", "null"})}, {"items", {{"anyOf", kinds}}}};
}

Json whole(const std::string& kind, const std::vector<KeyDescription>& keys) {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "slewlab " + kind}};
  schema.update(object_below(keys, ""));
  Json required = Json::array();
  for (const KeyDescription& key : keys) {
    if (key.is_required && is_child(key.path, "")) required.push_back(key.path);
  }
  schema["properties"]["include"] = {{"anyOf", Json::array({text_schema(), {{"type", "array"}, {"items", text_schema()}}})},
                                     {"description", "files that lie under this one"}};
  schema["if"] = {{"not", {{"required", Json::array({"include"})}}}};
  schema["then"] = {{"required", required}};
  return schema;
}

Json machine(const std::string& kind, void (*read)(YamlReader&, sim::MachineFile&)) {
  Json schema = whole(kind, common::describe_keys([&](YamlReader& reader) {
    sim::MachineFile file;
    read(reader, file);
    reader.raw("effects");
  }));
  schema["properties"]["effects"] = effects_schema(kind == "crane");
  return schema;
}

Json scenario() {
  const auto keys_with = [](sim::MachineKind kind) {
    return common::describe_keys([kind](YamlReader& reader) {
      sim::Scenario scenario;
      scenario.crane.kind = kind;
      sim::read_scenario(reader, scenario);
      sim::read_faults(reader, 0, {.group_count = sim::kMaximumGroupCount}, 0);
    });
  };
  Json schema = whole("scenario", keys_with(sim::MachineKind::crane));
  schema["properties"]["axis"] = schema["properties"]["crane"];
  Json& required = schema["then"]["required"];
  required.erase(std::find(required.begin(), required.end(), "crane"));  // or axis
  return schema;
}

// Values of a key whose unit is the key's own affair.
Json campaign() {
  Json schema = whole("campaign", common::describe_keys([](YamlReader& reader) {
    Study study;
    read_study(reader, study);
  }));
  const Json item{{"type", Json::array({"number", "string", "boolean"})}};
  const auto list = [](Json items, int fewest, std::optional<int> most) {
    Json values{{"type", "array"}, {"items", std::move(items)}, {"minItems", fewest}};
    if (most) values["maxItems"] = *most;
    return closed_object({{"value", values}, {"unit", text_schema()}, {"source", text_schema()}}, {"value", "source"});
  };
  Json& varied = schema["properties"]["vary"]["items"]["properties"];
  varied["values"] = list(item, 1, std::nullopt);
  for (const char* name : {"range", "log_range", "normal"}) varied[name] = list({{"type", "number"}}, 2, 2);
  return schema;
}

const std::vector<std::pair<std::string, std::function<Json()>>>& makers() {
  static const std::vector<std::pair<std::string, std::function<Json()>>> kMakers{
      {"crane", [] { return machine("crane", sim::read_crane); }},
      {"axis", [] { return machine("axis", sim::read_axis); }},
      {"controller", [] {
         return whole("controller", common::describe_keys([](YamlReader& reader) {
           controller::ControllerSettings settings;
           controller::read_controller(reader, settings);
         }));
       }},
      {"scenario", scenario},
      {"acceptance", [] { return whole("acceptance", common::describe_keys([](YamlReader& reader) { read_acceptance_limits(reader); })); }},
      {"acceptance_plan", [] { return whole("acceptance_plan", common::describe_keys([](YamlReader& reader) { read_acceptance_plan(reader); })); }},
      {"campaign", campaign},
      {"soak", [] {
         return whole("soak", common::describe_keys([](YamlReader& reader) {
           SoakSettings settings;
           read_soak_settings(reader, settings);
         }));
       }},
      {"plc_map", [] {
         return whole("plc_map", common::describe_keys([](YamlReader& reader) {
           PlcMap map;
           read_plc_map(reader, map);
         }));
       }},
  };
  return kMakers;
}

}  // namespace

const std::vector<std::string>& schema_kinds() {
  static const std::vector<std::string> kKinds = [] {
    std::vector<std::string> kinds;
    for (const auto& [kind, make] : makers()) kinds.push_back(kind);
    return kinds;
  }();
  return kKinds;
}

nlohmann::ordered_json schema_of(const std::string& kind) {
  for (const auto& [known, make] : makers()) {
    if (known == kind) return make();
  }
  std::vector<std::string> known = schema_kinds();
  known.push_back("import_map");  // of which the import's own reader tells
  throw common::InputError({{{"KIND", 0, 0}, "", "'" + kind + "'", common::known_names_text(kind, known)}});
}

}  // namespace slewlab::tools
