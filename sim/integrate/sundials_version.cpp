#include "sim/integrate/sundials_version.h"

#include <sundials/sundials_version.h>

namespace slewlab::sim {

std::string sundials_version() {
  char text[32] = "";
  return SUNDIALSGetVersion(text, sizeof text) == 0 ? text : "unknown";
}

}  // namespace slewlab::sim
