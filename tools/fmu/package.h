// An FMU is a zip file: this writes one, whole or not at all. Equal contents give equal bytes, whatever the day.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slewlab::tools::fmu {

struct PackedFile {
  std::string name;  // in the archive, slashes between
  std::string content;
  bool is_program = false;
};

// Throws std::runtime_error with the file's name and the reason.
void write_package(const std::filesystem::path& path, const std::vector<PackedFile>& files);

}  // namespace slewlab::tools::fmu
