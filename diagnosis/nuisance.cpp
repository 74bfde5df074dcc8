#include "diagnosis/nuisance.h"

#include <algorithm>

namespace slewlab::diagnosis {

const std::vector<Nuisance>& nuisances() {
  using sim::CraneParameters;
  static const std::vector<Nuisance> kNuisances{
      {"drive inertia", kUnitDeviation,
       [](CraneParameters& c, double f) {
         c.drive.motor_inertia *= f;
         c.drive.brake_inertia *= f;
         c.drive.gearbox_inertia *= f;
       }},
      {"gearbox stiffness", kUnitDeviation, [](CraneParameters& c, double f) { c.drive.gearbox_stiffness *= f; }},
      {"gear damping", kUnitDeviation, [](CraneParameters& c, double f) { c.drive.gear_damping_ratio *= f; }},
      {"play", kUnitDeviation,
       [](CraneParameters& c, double f) {
         c.drive.gearbox_play *= f;
         c.drive.pinion_play *= f;
       }},
      {"house inertia", kUnitDeviation, [](CraneParameters& c, double f) { c.house.inertia *= f; }},
      {"house sensor radius", kUnitDeviation, [](CraneParameters& c, double f) { c.house.sensor_radius *= f; }},
      {"boom mass", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.mass *= f; }},
      {"boom bending stiffness", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.youngs_modulus *= f; }},
      {"boom torsional stiffness", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.torsion_constant *= f; }},
      {"boom damping", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.damping_ratio *= f; }},
      {"boom angle", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.angle *= f; }},
      {"pivot radius", kUnitDeviation, [](CraneParameters& c, double f) { c.boom.pivot_radius *= f; }},
      {"load mass", kUnitDeviation, [](CraneParameters& c, double f) { c.load.mass *= f; }},
      {"rope length", kUnitDeviation, [](CraneParameters& c, double f) { c.load.rope_length *= f; }},
      {"rod length", kUnitDeviation, [](CraneParameters& c, double f) { c.load.rod_length *= f; }},
      {"load damping", kUnitDeviation, [](CraneParameters& c, double f) { c.load.damping_ratio *= f; }},
  };
  return kNuisances;
}

sim::CraneParameters with_nuisances(sim::CraneParameters crane, const std::vector<double>& amount) {
  const std::vector<Nuisance>& all = nuisances();
  for (std::size_t k = 0; k < all.size() && k < amount.size(); ++k) {
    // A factor stays positive however far an optimiser reaches.
    all[k].scale(crane, std::max(0.05, 1.0 + all[k].spread * amount[k]));
  }
  return crane;
}

}  // namespace slewlab::diagnosis
