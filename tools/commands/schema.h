// JSON Schemas of the kinds of files that slewlab reads, made of the code that reads them (common/yaml_inquiry.h): for
// completion and for marks under what is wrong in an editor.
//
// A schema knows keys, forms, units and names. What hangs on several values (a ratio of two, a file that is there) only
// `slewlab check` knows.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace slewlab::tools {

// crane, axis, controller, scenario, acceptance, soak, plc_map.
const std::vector<std::string>& schema_kinds();

// Throws common::InputError, naming the near one, where there is no such kind.
nlohmann::ordered_json schema_of(const std::string& kind);

}  // namespace slewlab::tools
