#include "tools/fmu/unit_file.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace slewlab::tools::fmu {
namespace {

using common::YamlNode;
using Json = nlohmann::ordered_json;

// An unquoted scalar that is a number stays one, with the same double. An unquoted word ("true", "crane") and a quoted one without a
// number mean the same to every reader; a quoted number is text there, and here.
Json to_json(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return nullptr;
    case YamlNode::Kind::scalar: {
      double number = 0.0;
      if (!node.quoted && common::parse_number(node.scalar, number)) {
        const Json parsed = Json::parse(common::shortest(number), nullptr, false);
        if (!parsed.is_discarded()) return parsed;  // .inf and .nan are no JSON
      }
      return node.scalar;
    }
    case YamlNode::Kind::sequence: {
      Json list = Json::array();
      for (const YamlNode& item : node.items) list.push_back(to_json(item));
      return list;
    }
    case YamlNode::Kind::map: break;
  }
  Json map = Json::object();
  for (const auto& entry : node.entries) map[entry.key] = to_json(entry.value);
  return map;
}

YamlNode from_json(const Json& json, const common::SourceMark& mark) {
  YamlNode node;
  node.mark = mark;
  if (json.is_object()) {
    node.kind = YamlNode::Kind::map;
    for (const auto& [key, value] : json.items()) node.entries.push_back({key, mark, from_json(value, mark)});
  } else if (json.is_array()) {
    node.kind = YamlNode::Kind::sequence;
    for (const Json& item : json) node.items.push_back(from_json(item, mark));
  } else if (!json.is_null()) {
    node.kind = YamlNode::Kind::scalar;
    if (json.is_string()) {
      double number = 0.0;
      node.scalar = json.get<std::string>();
      node.quoted = common::parse_number(node.scalar, number) && std::isfinite(number);
    } else {
      node.scalar = json.is_boolean() ? (json.get<bool>() ? "true" : "false") : common::shortest(json.get<double>());
    }
  }
  return node;
}

}  // namespace

std::string_view name_of(UnitKind kind) { return kind == UnitKind::plant ? "plant" : "controller"; }

std::string unit_text(const UnitFile& file) {
  Json json{{"unit", name_of(file.kind)}, {"period_ns", file.period}};
  if (file.kind == UnitKind::plant) {
    json["plant_step_ns"] = file.plant_step;
    json["seed"] = file.seed;
  }
  json["file"] = to_json(file.root);
  return json.dump(1) + "\n";
}

UnitFile read_unit_file(const std::filesystem::path& resources) {
  const std::filesystem::path path = resources / kUnitFileName;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + " cannot be read; the FMU's folder of resources holds it");
  std::ostringstream text;
  text << stream.rdbuf();
  UnitFile file;
  file.text = text.str();
  try {
    const Json json = Json::parse(file.text);
    file.kind = json.at("unit").get<std::string>() == name_of(UnitKind::plant) ? UnitKind::plant : UnitKind::controller;
    file.period = json.at("period_ns").get<std::int64_t>();
    if (file.kind == UnitKind::plant) {
      file.plant_step = json.at("plant_step_ns").get<std::int64_t>();
      file.seed = json.at("seed").get<int>();
    }
    file.root = from_json(json.at("file"), {path.string(), 0, 0});
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(path.string() + " is damaged: " + error.what());
  }
  return file;
}

}  // namespace slewlab::tools::fmu
