#include "sim/effects/balance_effects.h"

#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "common/unit.h"

namespace slewlab::sim {

namespace {

constexpr double kMostLean = 0.3;  // of dry friction, by which its directions differ; more is a torque of its own; chosen

}  // namespace

BalanceEffects effects_of_balance(const BalanceSizes& sizes, const common::EffectCatalogue& catalogue) {
  BalanceEffects result;
  const auto add = [&](const char* name, const std::map<std::string, double>& values) {
    const common::EffectAbout* about = catalogue.find(name);
    if (about == nullptr) {
      result.left_out.push_back(std::string(name) + " does not suit this machine: not in the file");
      return;
    }
    common::EffectInstance instance{name, {}};
    for (const common::EffectParameter& parameter : about->parameters) {
      const auto found = values.find(std::string(parameter.name));
      const double value = found == values.end() ? 0.0 : found->second;
      if (value < parameter.lower || value > parameter.upper) {
        std::ostringstream line;
        line.precision(4);
        line << name << '.' << parameter.name << " = " << value << ' ' << common::name_of(parameter.unit)
             << " lies out of the catalogue's bounds, " << parameter.lower << " to " << parameter.upper << ": not in the file";
        result.left_out.push_back(line.str());
        return;
      }
      instance.values.push_back(value);
    }
    result.effects.push_back(std::move(instance));
  };
  // A constant torque is the same motion as a difference of dry friction between the directions.
  const double lean = sizes.dry > 0.0 ? sizes.dry_difference / sizes.dry : 0.0;
  const bool is_lean = sizes.breakaway_excess == 0.0 && sizes.rising == 0.0 && sizes.dry > 0.0 && std::fabs(lean) <= kMostLean;
  const double offset = sizes.offset + (is_lean ? 0.0 : sizes.dry_difference);
  if (sizes.breakaway_excess != 0.0) {
    add("bearing_stribeck", {{"coulomb_torque", sizes.dry}, {"breakaway_excess", sizes.breakaway_excess}, {"stribeck_speed", sizes.stribeck_speed}});
  } else if (sizes.rising != 0.0) {
    const double total = sizes.dry + sizes.rising;
    add("bearing_rising", {{"torque", total}, {"speed", sizes.rising_speed}, {"at_rest", total > 0.0 ? sizes.dry / total : 0.0}});
  } else if (sizes.dry != 0.0) {
    add("bearing_coulomb", {{"torque", sizes.dry}, {"asymmetry", is_lean ? lean : 0.0}});
  }
  if (sizes.viscous != 0.0) {
    add("bearing_viscous", {{"coefficient", sizes.viscous}, {"asymmetry", sizes.viscous > 0.0 ? sizes.viscous_difference / sizes.viscous : 0.0}});
  }
  if (offset != 0.0) add("torque_offset", {{"torque", -offset}});
  if (sizes.gravity_sine != 0.0 || sizes.gravity_cosine != 0.0) {
    // s sin q + c cos q against the motion is T sin(direction - q) with it.
    const double direction = std::atan2(-sizes.gravity_cosine, sizes.gravity_sine) - sizes.first_position;
    add("tilted_axis", {{"torque", std::hypot(sizes.gravity_sine, sizes.gravity_cosine)}, {"direction", std::remainder(direction, 2.0 * std::numbers::pi)}});
  }
  if (sizes.lag != 0.0) add("torque_lag", {{"time_constant", sizes.lag}, {"delay_share", 0.0}});
  if (sizes.delay != 0.0) add("dead_time", {{"delay", sizes.delay}});
  return result;
}

}  // namespace slewlab::sim
