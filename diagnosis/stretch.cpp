#include "diagnosis/stretch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slewlab::diagnosis {

namespace {

constexpr double kNanosecond = 1e-9;          // [s]
constexpr std::size_t kSpeedsPerTime = 4;     // mean speeds in T
constexpr double kStands = 0.05;              // of the largest mean speed, below which the machine stands; chosen: as a record begins in motion

// The motors' mean speed [rad/s] from one of these instants [ns] to the next.
struct CoarseMotion {
  std::vector<std::int64_t> at;
  std::vector<double> speed;
};

double mean_position(const msgs::Encoder& message) {
  const double sum = std::accumulate(message.shaft_position.begin(), message.shaft_position.end(), 0.0);
  return message.shaft_position.empty() ? 0.0 : sum / static_cast<double>(message.shaft_position.size());
}

CoarseMotion coarse_motion(const msgs::LoggedRun& run, double time) {
  CoarseMotion motion;
  const auto distance = std::max<std::int64_t>(1, std::llround(time / kSpeedsPerTime / kNanosecond));
  double before = 0.0;
  for (const msgs::Encoder& message : msgs::read_encoders(run, distance)) {
    const double position = mean_position(message);
    if (!motion.at.empty()) motion.speed.push_back((position - before) / (static_cast<double>(message.simulated_time - motion.at.back()) * kNanosecond));
    motion.at.push_back(message.simulated_time);
    before = position;
  }
  return motion;
}

double largest_speed(const CoarseMotion& motion) {
  double largest = 0.0;
  for (const double speed : motion.speed) largest = std::max(largest, std::fabs(speed));
  return largest;
}

// Where a stretch begins best that ends at `end` [instants; 0: beyond the run]: where the machine has stood for T and does so for another, as late in each rest as it can, for
// boom and load swing on.
std::vector<bool> beginnings(const CoarseMotion& motion, const std::vector<std::size_t>& end) {
  const double largest = largest_speed(motion);
  std::vector<bool> may_begin(motion.speed.size(), false);
  for (std::size_t k = 0; k + kSpeedsPerTime <= motion.speed.size(); ++k) {
    const std::size_t first = k > kSpeedsPerTime ? k - kSpeedsPerTime : 0;
    may_begin[k] = std::all_of(motion.speed.begin() + static_cast<std::ptrdiff_t>(first), motion.speed.begin() + static_cast<std::ptrdiff_t>(k + kSpeedsPerTime),
                               [&](double speed) { return std::fabs(speed) < kStands * largest; });
  }
  for (std::size_t k = 0; k + 1 < may_begin.size(); ++k) {
    if (may_begin[k + 1] && end[k + 1] != 0) may_begin[k] = false;
  }
  return may_begin;
}

}  // namespace

std::vector<double> fitted_lengths(std::span<const double> lengths, double most) {
  std::vector<std::size_t> rising(lengths.size());
  std::iota(rising.begin(), rising.end(), std::size_t{0});
  std::stable_sort(rising.begin(), rising.end(), [&](std::size_t a, std::size_t b) { return lengths[a] < lengths[b]; });
  std::vector<double> fitted(lengths.size());
  double left = most;
  for (std::size_t i = 0; i < rising.size(); ++i) {
    fitted[rising[i]] = std::min(lengths[rising[i]], left / static_cast<double>(rising.size() - i));
    left -= fitted[rising[i]];
  }
  return fitted;
}

double length_of(const msgs::LoggedRun& run) {
  const std::vector<msgs::EventHead>& heads = run.order.channels[msgs::kEncoderIndex];
  return heads.empty() ? 0.0 : static_cast<double>(heads.back().time - heads.front().time) * kNanosecond;
}

double length_of(const msgs::RunLog& run) {
  return run.encoder.empty() ? 0.0 : static_cast<double>(run.encoder.back().simulated_time - run.encoder.front().simulated_time) * kNanosecond;
}

std::vector<Stretch> stretches_by_motion(const msgs::LoggedRun& run, double length, double time) {
  const CoarseMotion motion = coarse_motion(run, time);
  std::vector<double> moved(motion.speed.size() + 1, 0.0);  // the sum of (1) up to each speed
  std::vector<std::size_t> turning(motion.speed.size() + 1, 0);  // speeds up to each with which the machine does not stand
  const double standing = kStands * largest_speed(motion);
  for (std::size_t k = 0; k < motion.speed.size(); ++k) {
    moved[k + 1] = moved[k] + (k > 0 ? std::fabs(motion.speed[k] - motion.speed[k - 1]) : 0.0);
    turning[k + 1] = turning[k] + (std::fabs(motion.speed[k]) >= standing ? 1 : 0);
  }
  const std::int64_t duration = std::llround(length / kNanosecond);
  std::vector<std::size_t> end(motion.speed.size());  // the last instant of a stretch from there on; 0: the run ends before
  for (std::size_t k = 0, last = 0; k < end.size(); ++k) {
    while (last + 1 < motion.at.size() && motion.at[last] < motion.at[k] + duration) ++last;
    end[k] = motion.at[last] >= motion.at[k] + duration ? last : 0;
  }
  std::vector<Stretch> stretches;
  std::vector<std::size_t> taken;  // where they begin
  const auto is_free = [&](std::size_t k) { return std::none_of(taken.begin(), taken.end(), [&](std::size_t other) { return k < end[other] && other < end[k]; }); };
  const std::vector<bool> anywhere(motion.speed.size(), true);
  for (std::vector<bool> may_begin : {beginnings(motion, end), anywhere}) {
    for (std::size_t k = 0; k < end.size(); ++k) may_begin[k] = may_begin[k] && end[k] != 0 && turning[end[k]] > turning[k] && is_free(k);
    for (;;) {
      std::size_t best = end.size();
      double most = 0.0;
      for (std::size_t k = 0; k < end.size(); ++k) {
        if (!may_begin[k]) continue;
        const double moves = moved[end[k]] - moved[std::min(k + 1, end[k])];
        if (moves > most) {
          best = k;
          most = moves;
        }
      }
      if (best == end.size()) break;
      stretches.push_back({motion.at[best], motion.at[best] + duration, most});
      taken.push_back(best);
      for (std::size_t k = 0; k < end[best]; ++k) may_begin[k] = may_begin[k] && end[k] <= best;
    }
  }
  return stretches;
}

}  // namespace slewlab::diagnosis
