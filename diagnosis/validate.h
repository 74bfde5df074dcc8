// What there is to judge an answer by besides its fit: the last record as the machines follow it, and the answer fitted again without a part
// of what was measured, so that there is something to predict.
#pragma once

#include <string>

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

struct HeldOut {
  Point point;
  std::string record;      // that it did not see: the last one, or of a single one the second half
  double from_time = 0.0;  // [s] from which it did not
  bool is_half = false;
};

// The last record that was judged, as the nominal machine follows it and as that of the first cause does, without its stochastic effects.
struct Followed {
  std::string record;
  Shadow nominal, explained;
};

// Whether the effect's sizes come from a fit that can be repeated on other records: not read off a record, not stochastic.
bool has_fit(const common::EffectAbout& effect);

// The cause fitted once more, from the nominal machine, without the last record, or of a single one without its second half: that is
// taken out of the problem for good. `follower` is the nominal machine's shadow of it.
HeldOut fit_without_last(Problem& problem, const WhiteningSettings& settings, const Shadow& follower, const Point& answer);

}  // namespace slewlab::diagnosis
