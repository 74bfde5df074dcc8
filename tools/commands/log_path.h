#pragma once

#include <filesystem>

namespace slewlab::tools {

// The log that a command is given: itself, or in the folder of a run, whole or broken off. Throws common::InputError where
// there is nothing of that name, or the folder has none.
std::filesystem::path log_in(const std::filesystem::path& given);

}  // namespace slewlab::tools
