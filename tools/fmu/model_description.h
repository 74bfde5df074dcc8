// modelDescription.xml of an FMU, and buildDescription.xml of FMI 3.
#pragma once

#include <string>
#include <vector>

#include "tools/fmu/unit.h"

namespace slewlab::tools::fmu {

struct ModelDescription {
  int fmi = 2;                          // 2 or 3
  std::string identifier;               // a C identifier: the library's name
  std::string name, description;        // for people
  std::vector<std::string> sources;     // that are compiled, relative to the folder sources/
};

// Throws std::invalid_argument of a variable's unit that has no definition here: a slip in the program.
std::string model_description(const ModelDescription& model, const UnitFile& file, const Unit& unit);
std::string build_description(const ModelDescription& model);

// The text as a C identifier: other characters become underscores, and a digit does not begin it.
std::string identifier_of(const std::string& text);

}  // namespace slewlab::tools::fmu
