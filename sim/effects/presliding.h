// A dry joint that gives before it slides (Jenkins element: a spring in series with Coulomb friction):
//   s <- clamp(s + (x - x_before) / give, -1, 1),   torque = -level s,
// s being the part of the level that the joint holds. For give -> 0 it is dry friction; raceways, rollers and brake
// plates give by micrometres, and a machine that rests on them rings where dry friction would hold it still.
// Source: Jenkins 1962, "Analysis of the stress-strain relationships in reactor grade graphite", Br. J. Appl. Phys. 13.
#pragma once

#include <algorithm>

namespace slewlab::sim {

struct Presliding {
  double give = 0.0;    // [rad] of the joint, at which it slides; positive
  double before = 0.0;  // [rad]
  double share = 0.0;   // s
  bool begun = false;   // the joint is relaxed where it is first asked
};

// s after the joint has moved to `angle` [rad].
inline double presliding_share(Presliding& joint, double angle) {
  if (joint.begun) joint.share = std::clamp(joint.share + (angle - joint.before) / joint.give, -1.0, 1.0);
  joint.begun = true;
  joint.before = angle;
  return joint.share;
}

}  // namespace slewlab::sim
