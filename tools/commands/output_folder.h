#pragma once

#include <filesystem>

namespace slewlab::tools {

// Makes the folder that an option names, with those above it. Throws common::InputError where there can be none.
void make_output_folder(const std::filesystem::path& folder, const char* option = "--out");

// The same for the folder of a file that an option names, and it must be no folder itself. An empty name is no file.
void make_folder_of(const std::filesystem::path& file, const char* option = "--out");

}  // namespace slewlab::tools
