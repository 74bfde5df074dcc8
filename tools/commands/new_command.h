// `slewlab new KIND FILE`: a commented file to begin with, which `slewlab check` takes as it is.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace slewlab::tools {

struct NewOptions {
  std::filesystem::path templates;   // folder with crane.yaml, controller.yaml, scenario.yaml
  std::string kind;                  // crane, controller or scenario; map is for tools/python/new_map.py
  std::filesystem::path file;        // to be written; never over one that is there
  std::filesystem::path machine;     // of a controller or a scenario; empty: the template's
  std::filesystem::path controller;  // of a scenario
};

const std::vector<std::string>& new_kinds();

// Throws common::InputError where the kind is unknown, an option cannot matter, the file is there or the machine is wrong.
int write_new(const NewOptions& options, std::ostream& out);

}  // namespace slewlab::tools
