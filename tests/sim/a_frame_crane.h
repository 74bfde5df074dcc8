// The thesis's crane with the boom of config/cranes/a_frame.yaml, on luffing cylinders with 4 m of oil in them, so that the boom may go down to
// 20 degrees.
#pragma once

#include "sim/model/boom.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {

inline CraneParameters a_frame_crane(int element_count = 8) {
  CraneParameters crane = thesis_crane(element_count);
  BoomParameters& boom = crane.boom;
  boom.type = BoomType::a_frame;
  boom.mass = 40e3;
  boom.chord_outer_diameter = 0.5;
  boom.chord_inner_diameter = 0.45;
  boom.torsion_constant = 0.02;
  boom.profile = {{0.0, 3.0, 0.24}, {1.0, 0.5, 0.24}};
  boom.cylinders = {.stiffness = 120e6, .position = 0.35, .spacing = 3.0, .base_radius = 6.0, .base_height = -4.0, .oil_column = 4.0};
  boom.cylinders.force = cylinder_force(boom, crane.load.mass);
  return crane;
}

// The crane as it would be built at another boom angle [rad]: with the weight's lever and the oil of that angle.
inline CraneParameters built_at(CraneParameters crane, double angle) {
  BoomParameters& boom = crane.boom;
  const double column = oil_column(boom, angle);
  boom.angle = angle;
  boom.cylinders.stiffness *= boom.cylinders.oil_column / column;
  boom.cylinders.oil_column = column;
  boom.cylinders.force = cylinder_force(boom, crane.load.mass + boom.jib_mass);
  return crane;
}

}  // namespace slewlab::sim
