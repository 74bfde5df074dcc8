// How far a diagnosis is, as the share of its time: what the time left can be forecast from.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace slewlab::diagnosis {

using Progress = std::function<void(double share, const std::string& doing)>;

// A part of the whole, as shares of it.
struct Stage {
  double from, to;
};

// Of the processor's time. A single diagnosis differs by a half, because how many effects are worth a fit and how long they take to
// settle is not known before: at the end of the screening it is a sixth to a half through. So nothing is forecast before that; the
// rest are means over machines where many effects promise something.
inline constexpr Stage kFitParameters{0.0, 0.09};
inline constexpr Stage kScreen{0.09, 0.2};
inline constexpr Stage kRefineSingles{0.2, 0.217};
inline constexpr Stage kLookFromNominal{0.217, 0.275};
inline constexpr Stage kConvergeSingles{0.275, 0.36};
inline constexpr Stage kScreenBeside{0.36, 0.395};
inline constexpr Stage kRefinePairs{0.395, 0.44};
inline constexpr Stage kConvergePairs{0.44, 0.535};
inline constexpr Stage kGoBack{0.535, 0.743};
inline constexpr Stage kLookForStochastic{0.743, 0.886};
inline constexpr Stage kHoldOut{0.886, 0.96};
inline constexpr Stage kFollow{0.96, 1.0};

// What of the time behind the screening is left where few effects promise something and parameters alone may be the answer.
inline constexpr double kWithFewEffects = 0.7;
Progress shortened(const Progress& tell, double left);

// When it will end, from the shares that are told on the way. The fit of the parameters alone says nothing of the rest: its length depends
// on where it starts.
class Forecast {
 public:
  // `time` in any unit, rising.
  void tell(double time, double share);
  // Of several that are at work the one that is farthest.
  double share() const { return share_; }
  // Time left; nothing before the screening has shown how much there is to be done.
  std::optional<double> left() const;

 private:
  double time_ = 0.0, share_ = 0.0;
  std::optional<double> from_time_;  // of the screening's beginning
  double from_share_ = 0.0;
};

// Of a stage's own share of itself, from 0 to 1, to that of the whole. An empty `tell` gives one that does nothing.
Progress within(const Progress& tell, const Stage& stage);

}  // namespace slewlab::diagnosis
