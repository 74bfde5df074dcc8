// Hoisting, luffing and travelling for the reference: the laws of crane_motion.h at every instant, with the inertia that the boom angle of that
// instant has. What the fixed step takes from stretch to stretch changes continuously here.
#pragma once

#include "sim/integrate/crane_motion.h"
#include "sim/integrate/reference.h"

namespace slewlab::sim {

// For make_reference(). Where the boom luffs, angles and displacements that the reference gives are those of the boom angle at the start: the
// tip's is R_0 theta + deflection, and the lower end of the rope stands beside it as it does beside the sheave.
struct MovingReference {
  ReferenceMachine machine;
  ReferenceExtra extra;
};
// Throws as crane_motion().
MovingReference moving_reference(const CraneParameters& crane, const MotionRequests& requests);

}  // namespace slewlab::sim
