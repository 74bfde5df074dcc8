// Dry frictions on coupled bodies within one step: each holds its body at rest if it can, and opposes its motion where it
// cannot. With the speeds at the step's end linear in the frictions,
//
//   v = free_speed + mobility f,   lowest <= f <= highest,
//   v = 0 where f lies between, v >= 0 where f = lowest, v <= 0 where f = highest,
//
// a linear complementarity problem with bounds. Solved by principal pivots of least index (Murty, "Linear
// Complementarity, Linear and Nonlinear Programming", 1988, 4.1): the first body that does not obey changes between
// sliding and sticking. Where `mobility` is a P-matrix, as that of any bodies with inertia is, the speed of the last
// body rises with its friction while those before it obey; so it changes twice at most, and by induction the pivots end,
// at the only solution. Otherwise they end at kMostFrictionPivots or at a singular system, and that is said.
//
// Allocates nothing, throws nothing.
#pragma once

#include "sim/integrate/plant_ports.h"

namespace slewlab::sim {

inline constexpr int kMaximumFrictions = kMaximumGroupCount + 1;  // motor groups and house
inline constexpr int kMostFrictionPivots = 19683;                 // 3^9: sliding one way, the other, or sticking, each of 9

struct FrictionProblem {
  int count = 0;
  double free_speed[kMaximumFrictions] = {};                    // [rad/s]
  double mobility[kMaximumFrictions][kMaximumFrictions] = {};   // [rad/s per N m]
  double lowest[kMaximumFrictions] = {};                        // [N m] <= 0
  double highest[kMaximumFrictions] = {};                       // [N m] >= 0
};

enum class FrictionEnd { solved, singular, too_many_pivots };

// `friction` [N m] holds a guess and gets the solution; it is within its bounds whatever the end.
FrictionEnd solve_frictions(const FrictionProblem& problem, double* friction);

}  // namespace slewlab::sim
