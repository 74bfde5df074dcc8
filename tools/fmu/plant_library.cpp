// The unit of the FMU's library that holds a plant.
#include <stdexcept>

#include "tools/fmu/plant_unit.h"

namespace slewlab::tools::fmu {

std::unique_ptr<Unit> make_unit(const UnitFile& file) {
  if (file.kind != UnitKind::plant) throw std::runtime_error("unit.json is a controller's, the library a plant's");
  return make_plant_unit(file);
}

}  // namespace slewlab::tools::fmu
