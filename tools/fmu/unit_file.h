// unit.json in the resources of an FMU: the machine or the controller that it holds, with every include and every --set worked in. The
// content is that of the YAML file it was made of, as JSON, so that an FMU's library needs no YAML parser.
//
//   {"unit": "plant", "period_ns": 10000000, "plant_step_ns": 1000000, "seed": 0, "file": {...}}
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/yaml_node.h"

namespace slewlab::tools::fmu {

inline constexpr const char* kUnitFileName = "unit.json";

enum class UnitKind { plant, controller };
std::string_view name_of(UnitKind kind);

struct UnitFile {
  UnitKind kind = UnitKind::plant;
  std::int64_t period = 10'000'000;     // [ns] communication step: of a controller the only one, of a plant the one it is made for
  std::int64_t plant_step = 1'000'000;  // [ns]
  int seed = 0;                         // of a plant's effects that draw numbers
  common::YamlNode root;                // the file
  std::string text;                     // all of it, as it stands in unit.json
};

// The text of unit.json.
std::string unit_text(const UnitFile& file);

// Throws std::runtime_error where the folder has none or it is damaged.
UnitFile read_unit_file(const std::filesystem::path& resources);

}  // namespace slewlab::tools::fmu
