#include "diagnosis/nuisance.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace slewlab::diagnosis {

namespace {

// 1.73 standard deviations are the 5 %; a little more for what mesh and step make wrong.
constexpr double kWall = 2.0;        // [standard deviations]
constexpr double kSteepness = 30.0;  // [-] of a wall, in units of the normal prior's curvature

constexpr double kStudent = 3.0;  // one more than the degrees of freedom

}  // namespace

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

double encoder_latency(const std::vector<double>& amount, double deviation) {
  return amount.size() < common_nuisance_count() ? 0.0 : deviation * amount[nuisances().size()];
}

Swing swing_at_start(const std::vector<double>& amount, std::size_t record, double rope_length) {
  const std::size_t first = nuisance_count(record);
  if (amount.size() < first + kSwingAmounts || !(rope_length > 0.0)) return {};
  return {kSwingDeviation * amount[first], kSwingDeviation * std::sqrt(sim::kGravity / rope_length) * amount[first + 1]};
}

double swing_reach(const std::vector<double>& amount, std::size_t record) {
  const std::size_t first = nuisance_count(record);
  return amount.size() < first + kSwingAmounts ? 0.0 : kSwingDeviation * std::hypot(amount[first], amount[first + 1]);
}

std::size_t common_nuisance_count() { return nuisances().size() + 1; }

std::size_t nuisance_count(std::size_t records) { return common_nuisance_count() + kSwingAmounts * records; }

PriorTerm nuisance_prior(std::size_t k, double z) {
  PriorTerm term{z * z, z, 1.0};
  const double beyond = std::fabs(z) - kWall;
  if (k < nuisances().size() && beyond > 0.0) {
    term.cost += kSteepness * beyond * beyond;
    term.slope += std::copysign(kSteepness * beyond, z);
    term.curvature += kSteepness;
  }
  return term;
}

bool is_said_by(std::string_view effect, std::size_t k) {
  static const std::multimap<std::string_view, std::string_view> kSays{
      {"house_inertia", "house inertia"},         {"boom_damping", "boom damping"},
      {"boom_stiffness", "boom bending stiffness"}, {"boom_stiffness", "boom torsional stiffness"},
      {"load_mass", "load mass"},                 {"rope_length", "rope length"}};
  if (k >= nuisances().size()) return false;
  const auto [first, last] = kSays.equal_range(effect);
  return std::any_of(first, last, [&](const auto& entry) { return entry.second == nuisances()[k].name; });
}

PriorTerm effect_prior(double x) {
  const double weight = 1.0 / (1.0 + x * x / kStudent);
  return {kStudent * std::log1p(x * x / kStudent), weight * x, weight};
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
