#pragma once

#include <string>

namespace slewlab::msgs {

// Of the LCM that slewlab was built with: "1.3.1".
std::string lcm_version();

}  // namespace slewlab::msgs
