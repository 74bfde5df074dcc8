// Newton's linear systems of the reference, (I - gamma J) x = b, solved exactly at a cost linear in the modes. J is the Jacobian of
// derive() with the contacts as they are latched; it knows nothing of an extra.
#pragma once

#include <Eigen/LU>
#include <array>
#include <vector>

#include "sim/integrate/reference_equations.h"

namespace slewlab::sim {

inline constexpr int kReferenceChannels = kMaximumGroupCount + 3;  // gears, the rope's force, the tip's place and velocity

// What belongs to one gamma and one set of contacts.
struct ReferenceNewton {
  double gamma = -1.0;  // [s]; below 0: of the past, to be worked out anew
  std::vector<double> inverse;
  std::array<double, 2> load_inverse{};
  Eigen::PartialPivLU<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kReferenceChannels, kReferenceChannels>> coupling;
  int closed_count = 0;
  std::array<int, kMaximumGroupCount> closed{};
};

// `b` and `x` have r.size numbers each.
void solve(const ReferenceEquations& r, ReferenceNewton& newton, double gamma, const double* b, double* x);

}  // namespace slewlab::sim
