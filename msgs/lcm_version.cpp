#include "msgs/lcm_version.h"

#include <lcm/lcm.h>

namespace slewlab::msgs {

std::string lcm_version() {
  return std::to_string(LCM_MAJOR_VERSION) + '.' + std::to_string(LCM_MINOR_VERSION) + '.' + std::to_string(LCM_MICRO_VERSION);
}

}  // namespace slewlab::msgs
