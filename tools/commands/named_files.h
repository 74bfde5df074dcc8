#pragma once

// Which files a shell command names, with their digests: what was run is known by them, by the command alone it is not.

#include <filesystem>
#include <string>
#include <vector>

namespace slewlab::tools {

// The programs that `command` starts (searched in PATH as the shell does) and every other word of it that is a file, seen from the
// working directory; absolute, each once, in the command's order. What a file includes, imports or is linked with is not among them.
std::vector<std::filesystem::path> files_named_by(const std::string& command);

// 64 hexadecimal digits. Throws std::runtime_error where the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace slewlab::tools
