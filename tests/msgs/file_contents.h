#pragma once

// A whole file, byte for byte; empty where it cannot be read.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace slewlab {

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace slewlab
