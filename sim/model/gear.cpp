#include "sim/model/gear.h"

#include <algorithm>
#include <numbers>

namespace slewlab::sim {

double planetary_mesh_frequency(int ring_teeth, int sun_teeth, double sun_frequency) {
  const double ring = ring_teeth;
  const double sun = sun_teeth;
  return ring * sun / (ring + sun) * sun_frequency;
}

double pinion_mesh_frequency(int pinion_teeth, double pinion_frequency) {
  return pinion_teeth * pinion_frequency;
}

double pinion_play(double share_of_module, double module, double pinion_radius) {
  return share_of_module * module / pinion_radius;
}

double pinion_mesh_stiffness(const PinionTooth& tooth) {
  const double b = tooth.thickness;
  const double contact = 4.0 * (1.0 - tooth.poisson_ratio * tooth.poisson_ratio) * tooth.length * b * b;
  const double bending = 4.0 * std::numbers::pi * tooth.height * tooth.height * tooth.height;
  return tooth.teeth_in_contact * tooth.pinion_radius * tooth.pinion_radius * std::numbers::pi *
         tooth.youngs_modulus * tooth.length * b * b * b / (contact + bending);
}

double contact_torque(const GearContact& gear, double deflection, double deflection_rate) {
  if (deflection > gear.half_play) {
    return std::max(0.0, gear.stiffness * (deflection - gear.half_play) + gear.damping * deflection_rate);
  }
  if (deflection < -gear.half_play) {
    return std::min(0.0, gear.stiffness * (deflection + gear.half_play) + gear.damping * deflection_rate);
  }
  return 0.0;
}

double backlash_stiffness(const GearContact& gear, double deflection) {
  if (deflection > gear.half_play) return gear.stiffness * (1.0 - gear.half_play / deflection);
  if (deflection < -gear.half_play) return gear.stiffness * (1.0 + gear.half_play / deflection);
  return 0.0;
}

}  // namespace slewlab::sim
