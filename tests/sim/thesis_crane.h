// The thesis's crane as numbers for unit tests that want no files. config/cranes/thesis.yaml holds the same
// values with their sources; tests/sim/crane_file_test.cpp compares the two.
//
// The boom's inner half widths, its half heights and the torsion constant are not in the thesis. They are
// chosen together so that the whole crane, torsion coupled in by the boom angle, has the bending frequencies
// 1.31, 5.24, 13.2, 23.3, 37 Hz and the first torsion 10.4 Hz of thesis 4.1, 4.2 (docs/model.md).
#pragma once

#include <numbers>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

inline CraneParameters thesis_crane(int element_count = 6) {
  constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
  CraneParameters crane;
  crane.drive = {.group_count = 2,
                 .motors_per_group = 3,
                 .motor_inertia = 1.08,
                 .brake_inertia = 0.037,
                 .gearbox_inertia = 0.05,
                 .gearbox_ratio = 215.4,
                 .pinion_ratio = 12.7,
                 .gearbox_stiffness = 6.9e6,
                 .gear_damping_ratio = 0.03,
                 .gearbox_play = 0.12 * kDegree,
                 .pinion_play = 0.244 * kDegree,
                 .rated_torque = 250.0,
                 .top_speed = 0.05,
                 .pinion_teeth = 12,
                 .gearbox_ring_teeth = 110,
                 .gearbox_sun_teeth = 8};
  crane.house = {.inertia = 2.52e5, .sensor_radius = 3.0};
  crane.boom = {.element_count = element_count,
                .length = 46.6,
                .mass = 81047.0,
                .angle = 53.5 * kDegree,
                .pivot_radius = 3.6,
                .chord_outer_diameter = 0.267,
                .chord_inner_diameter = 0.227,
                .youngs_modulus = 210e9,
                .shear_modulus = 81e9,
                .torsion_constant = 0.167,
                .damping_ratio = 0.01,
                .profile = {{0.0, 2.25, 0.27},
                            {0.2, 1.65, 0.90},
                            {0.4, 1.33, 0.90},
                            {0.6, 1.17, 0.90},
                            {0.8, 0.95, 0.90},
                            {1.0, 0.915, 0.54}}};
  crane.load = {.mass = 30e3, .rope_length = 60.0, .rod_length = 1.5, .damping_ratio = 0.005};
  return crane;
}

}  // namespace slewlab::sim
