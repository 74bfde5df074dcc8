// `slewlab modes MACHINE.yaml`: eigenfrequencies of a crane and of its clamped boom, or of an axis, how they converge with the
// elements, and on request the frequency response from motor torque to tip velocity as CSV.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

struct ModesOptions {
  std::filesystem::path crane = {};
  int elements = -1;                // of the boom; -1 takes the crane's own number
  std::filesystem::path bode = {};  // CSV to write; empty writes none
  std::vector<common::Override> overrides = {};
};

// Throws common::InputError when the crane's file is wrong, std::runtime_error when it has no boom for the
// elements asked for, or when the CSV cannot be written.
// Answers with the exit code 0.
int show_modes(const ModesOptions& options, std::ostream& out);

}  // namespace slewlab::tools
