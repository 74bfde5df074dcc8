#include "tools/acceptance/dead_time.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// Chosen: what counts as a torque that moves is a tenth of the strongest answer, and that stands ten standard deviations above nothing.
constexpr double kWeakest = 0.1;
constexpr double kCertain = 10.0;

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? kNone : sum / static_cast<double>(values.size());
}

// By sequence, counted from the first ENCODER's.
struct Cycles {
  std::vector<double> speed, torque, time;
};

Cycles cycles_of(const msgs::RunLog& run) {
  Cycles cycles;
  if (run.encoder.empty()) return cycles;
  const std::int64_t first = run.encoder.front().sequence;
  std::int64_t last = first;
  for (const msgs::Encoder& encoder : run.encoder) last = std::max<std::int64_t>(last, encoder.sequence);
  const auto count = static_cast<std::size_t>(last - first + 1);
  // A sequence that no plant counted up to has no table.
  if (count > 2 * run.encoder.size()) return cycles;
  cycles = {std::vector<double>(count, kNone), std::vector<double>(count, kNone), std::vector<double>(count, kNone)};
  const auto at = [&](std::int64_t sequence) { return sequence < first || sequence > last ? count : static_cast<std::size_t>(sequence - first); };
  for (const msgs::Encoder& encoder : run.encoder) {
    const std::size_t k = at(encoder.sequence);
    if (k == count) continue;
    cycles.speed[k] = mean(encoder.shaft_speed);
    cycles.time[k] = static_cast<double>(encoder.simulated_time) / kNanosecondsPerSecond;
  }
  for (const msgs::Torque& torque : run.torque) {
    const std::size_t k = at(torque.answered_sequence);
    if (k < count && torque.enable) cycles.torque[k] = mean(torque.motor_torque);
  }
  return cycles;
}

double second_difference(const std::vector<double>& values, std::size_t k) { return values[k] - 2.0 * values[k - 1] + values[k - 2]; }

}  // namespace

AnswerToNoise answer_to_noise(const msgs::RunLog& run, double from, double until) {
  using Square = Eigen::Matrix<double, kAnswerLags, kAnswerLags>;
  using Column = Eigen::Matrix<double, kAnswerLags, 1>;
  const Cycles cycles = cycles_of(run);
  Square normal = Square::Zero();
  Column right = Column::Zero();
  double power = 0.0;
  AnswerToNoise result;
  for (std::size_t k = kAnswerLags + 1; k < cycles.time.size(); ++k) {
    if (!(cycles.time[k - kAnswerLags - 1] >= from && cycles.time[k] < until)) continue;
    Column speeds;
    for (int d = 0; d < kAnswerLags; ++d) speeds(d) = second_difference(cycles.speed, k - static_cast<std::size_t>(d));
    const double torque = second_difference(cycles.torque, k);
    if (!speeds.allFinite() || !std::isfinite(torque)) continue;
    normal += speeds * speeds.transpose();
    right += torque * speeds;
    power += torque * torque;
    ++result.count;
  }
  if (result.count < 10 * kAnswerLags || power == 0.0) return result;
  const Eigen::FullPivLU<Square> solver(normal);
  if (!solver.isInvertible()) return result;
  const Column answer = solver.solve(right);
  const double residual = std::max(0.0, power - right.dot(answer)) / (result.count - kAnswerLags);
  const Column variance = residual * solver.inverse().diagonal();
  double largest = 0.0;
  for (int d = 0; d < kAnswerLags; ++d) {
    const auto i = static_cast<std::size_t>(d);
    result.answer[i] = answer(d);
    result.error[i] = std::sqrt(std::max(0.0, variance(d)));
    largest = std::max(largest, std::fabs(answer(d)));
  }
  const double worst = *std::max_element(result.error.begin(), result.error.end());
  if (!(kWeakest * largest > kCertain * worst)) return result;
  while (std::fabs(result.answer[static_cast<std::size_t>(++result.lag)]) < kWeakest * largest) {
  }
  return result;
}

}  // namespace slewlab::tools
