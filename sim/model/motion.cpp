#include "sim/model/motion.h"

#include <algorithm>
#include <cmath>

namespace slewlab::sim {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]

// Of a ramp from 0 to 1, `since` its begin: the way [s] and the acceleration [1/s].
double ramp_way(double since, double ramp_time) {
  if (since <= 0.0) return 0.0;
  if (since >= ramp_time) return since - 0.5 * ramp_time;
  const double share = since / ramp_time;
  return ramp_time * share * share * share * (1.0 - 0.5 * share);
}

double ramp_rise(double since, double ramp_time) {
  if (since <= 0.0 || since >= ramp_time) return 0.0;
  const double share = since / ramp_time;
  return 6.0 * share * (1.0 - share) / ramp_time;
}

}  // namespace

MotionProfile::MotionProfile(const MotionRates& rates, const std::vector<MotionRequest>& requests) {
  for (const MotionRequest& request : requests) {
    const double begin = static_cast<double>(request.time) * kNanosecond;
    const double speed = request.share * rates.top_speed;
    const MotionState now = at(begin);
    const bool under_way = !ramps_.empty() && begin < ramps_.back().begin + ramps_.back().time;
    const double target = ramps_.empty() ? 0.0 : ramps_.back().speed + ramps_.back().change;
    if (speed == target) continue;
    Ramp ramp{.begin = begin, .time = 0.0, .way = now.way, .speed = now.speed, .acceleration = now.acceleration, .change = speed - now.speed};
    if (under_way) {
      // No shorter than what is left of the ramp that it ends, for its acceleration has to be taken away too.
      const double left = ramps_.back().begin + ramps_.back().time - begin;
      ramp.time = std::max(2.25 * std::fabs(ramp.change) / rates.acceleration, left);
    } else {
      ramp.time = 1.5 * std::fabs(ramp.change) / rates.acceleration;
    }
    ramps_.push_back(ramp);
  }
}

MotionState MotionProfile::at(const Ramp& ramp, double time) {
  const double since = time - ramp.begin;
  const double within = std::min(since, ramp.time);
  const double s = within / ramp.time;
  MotionState state;
  state.speed = ramp.speed + ramp.change * s * s * (3.0 - 2.0 * s) + ramp.acceleration * within * (1.0 - s) * (1.0 - s);
  state.way = ramp.way + ramp.speed * since + ramp.change * ramp_way(since, ramp.time) +
              ramp.acceleration * within * within * (0.5 + s * (s / 4.0 - 2.0 / 3.0));
  if (since < ramp.time) state.acceleration = ramp.change * ramp_rise(since, ramp.time) + ramp.acceleration * (1.0 - s) * (1.0 - 3.0 * s);
  return state;
}

MotionState MotionProfile::at(double time) const {
  auto after = std::find_if(ramps_.begin(), ramps_.end(), [&](const Ramp& ramp) { return ramp.begin > time; });
  if (after == ramps_.begin()) return {};
  return at(*(after - 1), time);
}

bool MotionProfile::moves_within(double from, double to) const {
  for (std::size_t i = 0; i < ramps_.size(); ++i) {
    const Ramp& ramp = ramps_[i];
    const double rests_from = ramp.speed + ramp.change == 0.0 ? ramp.begin + ramp.time : to + 1.0;
    const double until = i + 1 < ramps_.size() ? std::min(rests_from, ramps_[i + 1].begin) : rests_from;
    if (ramp.begin < to && until > from) return true;
  }
  return false;
}

double MotionProfile::furthest(double until, double side) const {
  // Between ramps the speed stands, so that the way turns within them alone.
  constexpr int kSamples = 1000;  // of a ramp: its way is known to a millionth of speed times ramp time
  double furthest = 0.0;
  const auto look = [&](double time) { furthest = std::max(furthest, side * at(time).way); };
  for (const Ramp& ramp : ramps_) {
    if (ramp.begin > until) break;
    for (int i = 0; i <= kSamples; ++i) look(std::min(ramp.begin + ramp.time * i / kSamples, until));
  }
  look(until);
  return side * furthest;
}

double MotionProfile::least(double until) const { return furthest(until, -1.0); }

double MotionProfile::largest(double until) const { return furthest(until, 1.0); }

}  // namespace slewlab::sim
