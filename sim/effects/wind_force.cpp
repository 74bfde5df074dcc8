#include "sim/effects/wind_force.h"

namespace slewlab::sim {

DragAreas drag_areas(const CraneParameters& crane, double boom, double load) {
  return {.boom_per_length = crane.boom.length > 0.0 ? boom / crane.boom.length : 0.0,
          .load = crane.load.mass > 0.0 ? load : 0.0};
}

void add_wind(const DragAreas& areas, double pressure, PortForces& ports) {
  ports.uniform_force += areas.boom_per_length * pressure;
  ports.load_force += areas.load * pressure;
}

}  // namespace slewlab::sim
