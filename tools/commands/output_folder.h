#pragma once

#include <filesystem>

namespace slewlab::tools {

// Makes the folder that an option names, with those above it. Throws common::InputError where there can be none.
void make_output_folder(const std::filesystem::path& folder, const char* option = "--out");

}  // namespace slewlab::tools
