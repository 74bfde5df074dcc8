#include "tools/commands/version.h"

#include "msgs/lcm_version.h"
#include "sim/integrate/sundials_version.h"

namespace slewlab::tools {

std::string version() { return SLEWLAB_VERSION; }

std::string version_text() {
  return "slewlab " + version() + "\nLCM " + msgs::lcm_version() + "\nSUNDIALS " + sim::sundials_version();
}

}  // namespace slewlab::tools
