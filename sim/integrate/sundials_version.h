#pragma once

#include <string>

namespace slewlab::sim {

// Of the SUNDIALS that the reference integrates with: "6.4.1".
std::string sundials_version();

}  // namespace slewlab::sim
