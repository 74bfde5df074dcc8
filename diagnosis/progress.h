// How far a diagnosis is, as the share of its simulations that are done: what a time left can be forecast from.
#pragma once

#include <functional>
#include <string>

namespace slewlab::diagnosis {

using Progress = std::function<void(double share, const std::string& doing)>;

// A part of the whole, as shares of it.
struct Stage {
  double from, to;
};

// Means over 27 withheld cases (two records, mostly two effects); a single diagnosis differs by a third, because how many effects are
// worth a fit and how long they take to settle is not known before. One that finds nothing worth a fit ends early.
inline constexpr Stage kFitParameters{0.0, 0.05};
inline constexpr Stage kScreen{0.05, 0.33};
inline constexpr Stage kRefineSingles{0.33, 0.40};
inline constexpr Stage kConvergeSingles{0.40, 0.48};
inline constexpr Stage kScreenBeside{0.48, 0.62};
inline constexpr Stage kRefinePairs{0.62, 0.73};
inline constexpr Stage kConvergePairs{0.73, 0.84};
inline constexpr Stage kGoBack{0.84, 0.93};
inline constexpr Stage kLookForChance{0.93, 0.96};
inline constexpr Stage kHoldOut{0.96, 1.0};

// Of a stage's own share of itself, from 0 to 1, to that of the whole. An empty `tell` gives one that does nothing.
Progress within(const Progress& tell, const Stage& stage);

}  // namespace slewlab::diagnosis
