#pragma once

// Writes a file so that nobody ever sees half of it: under another name first, then renamed.

#include <filesystem>
#include <string_view>

namespace slewlab::tools {

// Throws std::runtime_error with the file's name and the system's reason.
void write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace slewlab::tools
