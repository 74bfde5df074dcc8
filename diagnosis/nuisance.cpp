#include "diagnosis/nuisance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/yaml_node.h"

namespace slewlab::diagnosis {

namespace {

// 1.73 standard deviations are the 5 %; a little more for what mesh and step make wrong.
constexpr double kWall = 2.0;        // [standard deviations]
constexpr double kSteepness = 30.0;  // [-] of a wall, in units of the normal prior's curvature

constexpr double kStudent = 3.0;  // one more than the degrees of freedom

}  // namespace

const std::vector<Nuisance>& nuisances() {
  using common::Unit;
  using sim::CraneParameters;
  static const std::vector<Nuisance> kNuisances{
      {"drive inertia", kUnitDeviation,
       {{"drive", "motor_inertia", Unit::kilogram_square_metre, [](CraneParameters& c) -> double& { return c.drive.motor_inertia; }},
        {"drive", "brake_inertia", Unit::kilogram_square_metre, [](CraneParameters& c) -> double& { return c.drive.brake_inertia; }},
        {"drive", "gearbox_inertia", Unit::kilogram_square_metre, [](CraneParameters& c) -> double& { return c.drive.gearbox_inertia; }}}},
      {"gearbox stiffness", kUnitDeviation,
       {{"drive", "gearbox_stiffness", Unit::newton_metre_per_radian, [](CraneParameters& c) -> double& { return c.drive.gearbox_stiffness; }}}},
      {"gear damping", kUnitDeviation,
       {{"drive", "gear_damping_ratio", Unit::none, [](CraneParameters& c) -> double& { return c.drive.gear_damping_ratio; }}}},
      {"play", kUnitDeviation,
       {{"drive", "gearbox_play", Unit::radian, [](CraneParameters& c) -> double& { return c.drive.gearbox_play; }},
        {"drive", "pinion_play", Unit::radian, [](CraneParameters& c) -> double& { return c.drive.pinion_play; }}}},
      {"house inertia", kUnitDeviation,
       {{"house", "inertia", Unit::kilogram_square_metre, [](CraneParameters& c) -> double& { return c.house.inertia; }}}},
      {"house sensor radius", kUnitDeviation,
       {{"house", "sensor_radius", Unit::metre, [](CraneParameters& c) -> double& { return c.house.sensor_radius; }}}},
      {"boom mass", kUnitDeviation, {{"boom", "mass", Unit::kilogram, [](CraneParameters& c) -> double& { return c.boom.mass; }}}},
      {"boom bending stiffness", kUnitDeviation,
       {{"boom", "youngs_modulus", Unit::pascal, [](CraneParameters& c) -> double& { return c.boom.youngs_modulus; }}}},
      {"boom torsional stiffness", kUnitDeviation,
       {{"boom", "torsion_constant", Unit::metre_to_the_fourth, [](CraneParameters& c) -> double& { return c.boom.torsion_constant; }}}},
      {"boom damping", kUnitDeviation,
       {{"boom", "damping_ratio", Unit::none, [](CraneParameters& c) -> double& { return c.boom.damping_ratio; }}}},
      {"boom angle", kUnitDeviation, {{"boom", "angle", Unit::radian, [](CraneParameters& c) -> double& { return c.boom.angle; }}}},
      {"pivot radius", kUnitDeviation,
       {{"boom", "pivot_radius", Unit::metre, [](CraneParameters& c) -> double& { return c.boom.pivot_radius; }}}},
      {"load mass", kUnitDeviation, {{"load", "mass", Unit::kilogram, [](CraneParameters& c) -> double& { return c.load.mass; }}}},
      {"rope length", kUnitDeviation,
       {{"load", "rope_length", Unit::metre, [](CraneParameters& c) -> double& { return c.load.rope_length; }}}},
      {"rod length", kUnitDeviation,
       {{"load", "rod_length", Unit::metre, [](CraneParameters& c) -> double& { return c.load.rod_length; }}}},
      {"load damping", kUnitDeviation,
       {{"load", "damping_ratio", Unit::none, [](CraneParameters& c) -> double& { return c.load.damping_ratio; }}}},
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

bool is_said_by(const common::EffectAbout& effect, std::size_t k) {
  return k < nuisances().size() && std::find(effect.stands_for.begin(), effect.stands_for.end(), nuisances()[k].name) != effect.stands_for.end();
}

PriorTerm effect_prior(double x) {
  const double weight = 1.0 / (1.0 + x * x / kStudent);
  return {kStudent * std::log1p(x * x / kStudent), weight * x, weight};
}

sim::CraneParameters with_nuisances(sim::CraneParameters crane, const std::vector<double>& amount) {
  const std::vector<Nuisance>& all = nuisances();
  for (std::size_t k = 0; k < all.size() && k < amount.size(); ++k) {
    // A factor stays positive however far an optimiser reaches.
    const double factor = std::max(0.05, 1.0 + all[k].spread * amount[k]);
    for (const CraneNumber& number : all[k].numbers) number.of(crane) *= factor;
  }
  return crane;
}

std::string parameters_text(const sim::CraneParameters& nominal, const std::vector<double>& amount, std::string_view source) {
  sim::CraneParameters crane = with_nuisances(nominal, amount);
  std::map<std::string_view, std::string> sections;
  for (std::size_t k = 0; k < nuisances().size() && k < amount.size(); ++k) {
    if (amount[k] == 0.0) continue;
    for (const CraneNumber& number : nuisances()[k].numbers) {
      const std::string origin = fmt::format("{}, {:+.1f} %", source, 100.0 * nuisances()[k].spread * amount[k]);
      sections[number.section] +=
          fmt::format("  {}: {}\n", number.key, common::quantity_text(common::shortest(number.of(crane)), number.unit, origin));
    }
  }
  std::string text;
  for (const auto& [section, numbers] : sections) text += fmt::format("{}:\n{}", section, numbers);
  return text;
}

}  // namespace slewlab::diagnosis
