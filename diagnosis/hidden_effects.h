// What the records may hide: that an effect acts, and is too small to be told.
//
//   P(hidden) / P(nothing missing) = (P_1 H + P_2 H^2) / P_0,    H = mean over the catalogue of P(|x| < x_h)
//
// P_0, P_1, P_2 are the priors of nothing, one and two effects (evidence.h), x an effect's size, of the prior of its sizes (Student's t of 2 degrees
// of freedom over its bounds, coordinates.h). A size x_0 that was simulated changes the differences by a column of which parameters imitate a part;
// the rest of it has the sum of squares V (screen.h). Linearly, a size x gives parameters alone the residual power c = s V (x / x_0)^2, and x_h is
// the size for which c makes a single effect as likely as nothing missing:
//
//   M(c) = c_e + 2 T ln(P_0 n / P_1),
//
// n effects being in the catalogue. An effect that changes nothing that is recorded is hidden whatever its size.
// Assumption: linear in the size; of a law that is not (a limit, a wider play) the size that was simulated tells on which side it is.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/effect.h"
#include "diagnosis/evidence.h"
#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

// c.
double told_from(int effect_count, const EvidenceSettings& settings);

// P(|x| < x_h) by one simulation of the effect: `square` is V of the size `start`, `needed` is c.
double share_hidden(const common::EffectParameter& size, double start, double square, double needed, double independent_share);

struct Hidden {
  double odds = 0.0;                                    // P(hidden) / P(nothing missing)
  std::vector<std::pair<std::string, double>> effects;  // P(|x| < x_h) of each that was tried, the mean over its tries; falling
};
// `effect_count` effects could have been named.
Hidden hidden_effects(const common::EffectCatalogue& catalogue, std::span<const Screened> tried, int effect_count, const EvidenceSettings& settings);

}  // namespace slewlab::diagnosis
