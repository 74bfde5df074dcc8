// A sideways acceleration that every mass of boom and load feels: gravity's part on an inclined crane.
#pragma once

#include "diagnosis/evaluation/truth_machine.h"

namespace slewlab::diagnosis::withheld {

// [m/s^2] on the boom and on the load.
inline void add_body_force(const Scene& scene, double on_boom, double on_load, sim::ReferenceForces& forces) {
  const sim::CraneParameters& crane = scene.crane;
  forces.uniform_force += crane.boom.mass / crane.boom.length * on_boom;
  forces.load_force += crane.load.mass * on_load;
  forces.rod_moment += 0.5 * crane.load.mass * crane.load.rod_length * on_load;
}

}  // namespace slewlab::diagnosis::withheld
