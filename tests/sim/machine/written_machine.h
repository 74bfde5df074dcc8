// A machine's file as a test writes it.
#pragma once

#include <fstream>
#include <string>

#include "common/input_error.h"
#include "sim/machine/machine_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::sim {

inline MachineFile load_written(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "crane_or_axis.yaml";
  std::ofstream(path) << text;
  return load_machine_file(path);
}

// What is said of it; "" where it is good.
inline std::string complaint_about(const std::string& text) {
  try {
    load_written(text);
  } catch (const common::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace slewlab::sim
