// SHA-256 (FIPS 180-4): answers are sealed by publishing the digest of the file that holds them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace slewlab::diagnosis::withheld {

// 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

// Throws std::runtime_error where the file cannot be read.
std::string read_whole(const std::filesystem::path& file);

// Writes under a temporary name beside `file` and renames. Throws std::runtime_error.
void write_whole(const std::filesystem::path& file, std::string_view text);

}  // namespace slewlab::diagnosis::withheld
