#pragma once

#include <exception>
#include <filesystem>

#include "common/input_error.h"

namespace slewlab::tools {

// The log that a command is given: itself, or in the folder of a run, whole or broken off. Throws common::InputError where
// there is nothing of that name, or the folder has none.
std::filesystem::path log_in(const std::filesystem::path& given);

// What a log is refused with that cannot be read, and why: a wrong file on the command line, not work that failed.
common::InputError no_log(const std::filesystem::path& log, const std::exception& why);

}  // namespace slewlab::tools
