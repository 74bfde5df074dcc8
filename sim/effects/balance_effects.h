// The effects of the catalogue whose laws a torque balance of an axis finds (diagnosis/balance), with their sizes. Laws act against
// the motion on the left of J q'' + laws = F.
#pragma once

#include <string>
#include <vector>

#include "common/effect.h"

namespace slewlab::sim {

// [Nm], [Nm s/rad], [rad/s], [rad]; 0 where the balance has no such law.
struct BalanceSizes {
  double dry = 0.0;
  double viscous = 0.0, viscous_difference = 0.0;  // of half the difference between the directions
  double dry_difference = 0.0;                     // of half the difference between the directions
  double offset = 0.0;                             // constant torque
  double breakaway_excess = 0.0, stribeck_speed = 0.0;
  double rising = 0.0, rising_speed = 0.0;
  double gravity_sine = 0.0, gravity_cosine = 0.0;
  double first_position = 0.0;                     // of the axis in the balance's angle
  double lag = 0.0, delay = 0.0;                   // [s] by which the torque comes late, as a first-order lag or by a fixed time
};

struct BalanceEffects {
  std::vector<common::EffectInstance> effects;
  std::vector<std::string> left_out;  // one line each: out of an effect's bounds, or unknown to the machine
};

// `catalogue` in the machine's units.
BalanceEffects effects_of_balance(const BalanceSizes& sizes, const common::EffectCatalogue& catalogue);

}  // namespace slewlab::sim
