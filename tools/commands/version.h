// Which slewlab this is, and on which libraries whose versions change what it does.
#pragma once

#include <string>

namespace slewlab::tools {

// "0.2.0"
std::string version();

// "slewlab 0.2.0", and a line each for LCM and SUNDIALS.
std::string version_text();

}  // namespace slewlab::tools
