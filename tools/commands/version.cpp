#include "tools/commands/version.h"

#include "msgs/lcm_version.h"
#include "sim/integrate/sundials_version.h"

namespace slewlab::tools {

std::string version_text() {
  return std::string("slewlab ") + SLEWLAB_VERSION + "\nLCM " + msgs::lcm_version() + "\nSUNDIALS " + sim::sundials_version();
}

}  // namespace slewlab::tools
