// What is wrong with a command line, in the words of our other messages: what was found, and what would be right.
#pragma once

#include <string>

namespace slewlab::common {

// `said` is what CLI11 says of the command line of `command` ("slewlab run"). Whatever is not known here stands as CLI11 says it.
std::string refused_words(const std::string& command, const std::string& said);

}  // namespace slewlab::common
