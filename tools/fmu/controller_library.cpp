// The unit of the FMU's library that holds a controller.
#include <stdexcept>

#include "tools/fmu/controller_unit.h"

namespace slewlab::tools::fmu {

std::unique_ptr<Unit> make_unit(const UnitFile& file) {
  if (file.kind != UnitKind::controller) throw std::runtime_error("unit.json is a plant's, the library a controller's");
  return make_controller_unit(file);
}

}  // namespace slewlab::tools::fmu
