#include "tools/commands/whole_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace slewlab::tools {

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path half = path;
  half += ".half";
  std::ofstream file(half, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) {
    const std::string reason = std::strerror(errno);
    std::error_code ignored;
    std::filesystem::remove(half, ignored);
    throw std::runtime_error("cannot write " + path.string() + ": " + reason);
  }
  std::filesystem::rename(half, path);
}

}  // namespace slewlab::tools
