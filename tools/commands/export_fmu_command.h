// `slewlab export-fmu FILE.yaml --fmi 2|3`: a machine, or a controller, as an FMU for co-simulation (tools/fmu).
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

struct ExportFmuOptions {
  std::filesystem::path file = {};
  int fmi = 2;
  std::filesystem::path out = {};    // empty: the file's name with .fmu, where one stands
  double period_ms = 10.0;           // communication step; of a controller the only one
  double plant_step_ms = 1.0;
  int seed = 0;
  std::string of_a_plant = {};       // an option that was given and says something of a plant alone
  std::vector<common::Override> overrides = {};
};

// Throws common::InputError where the file or a value is wrong, std::runtime_error where the FMU cannot be written. Answers with the
// exit code 0.
int export_fmu(const ExportFmuOptions& options, std::ostream& out);

}  // namespace slewlab::tools
