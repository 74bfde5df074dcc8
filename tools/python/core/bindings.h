// The parts of slewlab._core and slewlab._log, a source file each, and what they share.
#pragma once

#include <nanobind/nanobind.h>

#include <string>
#include <utility>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

void bind_machine(nanobind::module_& m);
void bind_run(nanobind::module_& m);
void bind_log(nanobind::module_& m);
void bind_yaml(nanobind::module_& m);
void bind_plc(nanobind::module_& m);
void bind_campaign(nanobind::module_& m);

// Keys with the text of their values, as of `--set`.
using Changes = std::vector<std::pair<std::string, std::string>>;

inline std::vector<common::Override> overrides_of(const Changes& changes) {
  std::vector<common::Override> overrides;
  for (const auto& [key, value] : changes) overrides.push_back({key, value});
  return overrides;
}

}  // namespace slewlab::tools
