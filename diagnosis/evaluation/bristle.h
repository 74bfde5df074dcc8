// Friction by bristles (LuGre; Canudas de Wit, Olsson, Astrom, Lischinsky 1995), without its viscous part:
//   z' = (w - |w| z) / angle,   torque = level (z + settle z'),
// z being the bristle's deflection as a share of `angle`, at which it slides; below that the joint is a spring.
// `level` may depend on the speed.
#pragma once

#include <cmath>

namespace slewlab::diagnosis::withheld {

struct Bristle {
  double angle;    // [rad] at which it slides
  double settle;   // [s] time constant of the bristle's own damping
};

// Torque against the motion, and the rate of the bristle's state z [share of `angle`].
struct BristleAnswer {
  double torque;
  double rate;
};
inline BristleAnswer bristle_answer(const Bristle& bristle, double level, double speed, double z) {
  const double rate = (speed - std::fabs(speed) * z) / bristle.angle;
  return {level * (z + bristle.settle * rate), rate};
}

}  // namespace slewlab::diagnosis::withheld
