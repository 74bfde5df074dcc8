#include "diagnosis/balance/balance_record.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "diagnosis/median_deviation.h"
#include "diagnosis/rounding.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNoiseShare = 0.02;          // of the effort's root mean square, chosen: noise then hides in the laws' residual
constexpr std::size_t kFewestMotionHalf = 2;  // [samples] the fewest that a cubic can be fitted to with one to spare
constexpr std::size_t kLeastWindows = 4;      // of a record

// Weights of the `derivative`-th derivative at the middle of a cubic fitted to 2 `half` + 1 values a unit apart.
Eigen::VectorXd weights(std::size_t half, int derivative) {
  const auto n = static_cast<Eigen::Index>(2 * half + 1);
  Eigen::MatrixXd powers(n, 4);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(half)) / static_cast<double>(half);
    powers.row(i) << 1.0, x, x * x, x * x * x;
  }
  const Eigen::MatrixXd inverse = (powers.transpose() * powers).inverse() * powers.transpose();
  const double factor = derivative == 2 ? 2.0 : 1.0;
  return factor * inverse.row(derivative).transpose() / std::pow(static_cast<double>(half), derivative);
}

// The mean whose second derivative the weights of the second derivative are: these are its second differences, so that
//   sum weight_2 q = sum weight (q_{n+1} - 2 q_n + q_{n-1})
// to the last digit. A zero at either end.
Eigen::VectorXd mean_weights(std::size_t half) {
  const Eigen::VectorXd second = weights(half, 2);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(second.size());
  double slope = 0.0;
  for (Eigen::Index i = 0; i + 1 < second.size(); ++i) {
    slope += second(i);
    mean(i + 1) = mean(i) + slope;
  }
  mean(second.size() - 1) = 0.0;
  return mean;
}

std::vector<double> convolved(const std::vector<double>& values, std::size_t half, const Eigen::VectorXd& weight, bool is_mean) {
  const auto window = static_cast<Eigen::Index>(2 * half + 1);
  std::vector<double> result(values.size() - 2 * half);
  // About the window's middle, so that a position far from zero loses no digits.
  for (std::size_t n = 0; n < result.size(); ++n) {
    const double middle = values[n + half];
    double sum = is_mean ? middle : 0.0;
    for (Eigen::Index i = 0; i < window; ++i) sum += weight(i) * (values[n + static_cast<std::size_t>(i)] - middle);
    result[n] = sum;
  }
  return result;
}

std::vector<double> derived(const std::vector<double>& values, std::size_t half, int derivative, double step) {
  return convolved(values, half, weights(half, derivative) / std::pow(step, derivative), derivative == 0);
}

// What white noise of 1 becomes in the second derivative, samples being a unit apart.
double acceleration_weight(std::size_t half) {
  const double n = 2.0 * static_cast<double>(half) + 1.0;
  return std::sqrt(720.0 / (n * (n * n - 1.0) * (n * n - 4.0)));
}

// A second difference is the acceleration's mean under a hat of two samples, so what is held acts with half of either side.
std::vector<double> about_the_samples(std::vector<double> held) {
  for (std::size_t n = held.size(); n-- > 1;) held[n] = 0.5 * (held[n] + held[n - 1]);
  return held;
}

// (F - F_late) / lag, of F_late' = (F - F_late) / lag its mean from each sample to the next, exact for what is held.
std::vector<double> withheld_by_lag(const std::vector<double>& effort, double step, double lag) {
  const double fall = -std::expm1(-step / lag);
  std::vector<double> rest(effort.size());
  double late = effort.front();
  for (std::size_t n = 0; n < effort.size(); ++n) {
    rest[n] = (effort[n] - late) * fall / step;
    late += fall * (effort[n] - late);
  }
  return rest;
}

// (F - F_late) / delay, of F_late the effort a delay ago its mean from each sample to the next, exact for what is held.
std::vector<double> withheld_by_delay(const std::vector<double>& effort, double step, double delay) {
  const auto whole = static_cast<std::size_t>(delay / step);
  const double part = delay / step - static_cast<double>(whole);
  std::vector<double> rest(effort.size());
  for (std::size_t n = 0; n < effort.size(); ++n) {
    const double newer = effort[n - std::min(n, whole)], older = effort[n - std::min(n, whole + 1)];
    rest[n] = (effort[n] - (1.0 - part) * newer - part * older) / delay;
  }
  return rest;
}

std::vector<double> withheld(const std::vector<double>& effort, double step, const Lateness& lateness) {
  return lateness.is_delay ? withheld_by_delay(effort, step, lateness.time) : withheld_by_lag(effort, step, lateness.time);
}

// Third differences of white noise have 1 + 9 + 9 + 1 = 20 times its variance; a smooth series has next to none.
double noise_of_differences(const std::vector<double>& values) {
  std::vector<double> third;
  for (std::size_t n = 3; n < values.size(); ++n) third.push_back(values[n] - 3.0 * values[n - 1] + 3.0 * values[n - 2] - values[n - 3]);
  return median_deviation(std::move(third)) / std::sqrt(20.0);
}

// 0 where nothing changes.
double least_change(const std::vector<double>& values) {
  double least = 0.0;
  for (std::size_t n = 1; n < values.size(); ++n) {
    const double change = std::fabs(values[n] - values[n - 1]);
    if (change > 0.0 && (least == 0.0 || change < least)) least = change;
  }
  return least;
}

}  // namespace

double position_noise(const std::vector<double>& position) {
  // Counts: no change is smaller than one of them. A smooth signal's least change is far below its noise.
  return std::max(noise_of_differences(position), least_change(position) / std::sqrt(12.0));
}

double effort_noise(const std::vector<double>& effort) {
  constexpr std::size_t kChanges = 100, kLevels = 32;  // at least, of efforts that were rounded; chosen: more levels than a test signal has
  return std::max(noise_of_differences(effort), std::sqrt(variance_of(find_rounding(effort, kChanges, kLevels))));
}

double smoothed_effort_noise(const AxisRecord& record, std::size_t half_window) {
  // A step shows in two second differences; a smooth torque, whose course between samples its neighbours tell, in none.
  double changes = 0.0;
  for (std::size_t n = 2; n < record.effort.size(); ++n) changes += 0.5 * std::pow(record.effort[n] - 2.0 * record.effort[n - 1] + record.effort[n - 2], 2);
  const double unknown_instant = changes / static_cast<double>(std::max<std::size_t>(1, record.effort.size())) / 12.0;
  const Eigen::VectorXd weight = mean_weights(half_window);
  double square = 0.0;  // of the weights of single samples, each of which acts with half of either side
  for (Eigen::Index i = 0; i <= weight.size(); ++i) {
    const double sum = 0.5 * ((i < weight.size() ? weight(i) : 0.0) + (i > 0 ? weight(i - 1) : 0.0));
    square += sum * sum;
  }
  const double noise = effort_noise(record.effort);
  return std::sqrt((noise * noise + unknown_instant) * square);
}

double acceleration_noise(const AxisRecord& record, std::size_t half_window) {
  return position_noise(record.position) / (record.step * record.step) * acceleration_weight(half_window);
}

std::size_t balance_half_window(const AxisRecord& record, double inertia, double longest) {
  double square = 0.0;
  for (const double effort : record.effort) square += effort * effort;
  const double rms = std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, record.effort.size())));
  const auto most = std::max(kFewestHalf, static_cast<std::size_t>(0.5 * longest / record.step));
  std::size_t half = kFewestHalf;
  const double noise = position_noise(record.position) / (record.step * record.step);
  const auto is_noisy = [&](std::size_t h) { return inertia * noise * acceleration_weight(h) > kNoiseShare * rms; };
  while (half < most && is_noisy(half)) ++half;
  return half;
}

BalanceRecord make_balance_record(const AxisRecord& record, std::size_t half_window, const std::vector<Lateness>& lateness) {
  const std::size_t window = 2 * half_window + 1;
  if (record.position.size() < kLeastWindows * window || record.effort.size() != record.position.size()) {
    throw std::invalid_argument(record.name + ": the record is too short for a torque balance");
  }
  BalanceRecord balance;
  balance.name = record.name;
  balance.step = record.step;
  balance.half_window = half_window;
  const std::size_t motion_half = std::max(kFewestMotionHalf, half_window / 2), cut = motion_half + half_window;
  const auto inner = [&](std::vector<double> values) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(motion_half),
                               values.end() - static_cast<std::ptrdiff_t>(motion_half));
  };
  balance.motion.position = derived(record.position, motion_half, 0, record.step);
  balance.motion.speed = derived(record.position, motion_half, 1, record.step);
  balance.speed_noise = position_noise(record.position) / record.step * weights(motion_half, 1).norm();
  balance.position = inner(derived(record.position, half_window, 0, record.step));
  balance.speed = inner(derived(record.position, half_window, 1, record.step));
  balance.acceleration = inner(derived(record.position, half_window, 2, record.step));
  const std::vector<double> effort = about_the_samples(record.effort);
  balance.motion.effort_rate = derived(effort, motion_half, 1, record.step);
  balance.effort = inner(balance_smoothed(effort, half_window));
  balance.motion.late_count = lateness.size();
  balance.motion.late.resize(lateness.size() * balance.motion.position.size());
  for (std::size_t k = 0; k < lateness.size(); ++k) {
    const std::vector<double> late = about_the_samples(withheld(record.effort, record.step, lateness[k]));
    for (std::size_t n = 0; n < balance.motion.position.size(); ++n) balance.motion.late[n * lateness.size() + k] = late[n + motion_half];
  }
  const auto times = [&](std::size_t count, std::size_t first) {
    std::vector<double> time(count);
    for (std::size_t n = 0; n < count; ++n) time[n] = record.start_time + record.step * static_cast<double>(n + first);
    return time;
  };
  balance.motion.time = times(balance.motion.position.size(), motion_half);
  balance.time = times(balance.position.size(), cut);
  return balance;
}

std::vector<double> effort_noise_products(double step, std::size_t half_window, const std::vector<Lateness>& lateness) {
  constexpr double kTail = 5.0;  // time constants after which a lag has forgotten the sample
  double longest = 0.0;
  for (const Lateness& one : lateness) longest = std::max(longest, one.time);
  const std::size_t before = 2 * half_window + 2;
  std::vector<double> sample(2 * before + static_cast<std::size_t>(kTail * longest / step), 0.0);
  sample[before] = 1.0;
  std::vector<std::vector<double>> answers{balance_smoothed(about_the_samples(sample), half_window)};
  for (const Lateness& one : lateness) answers.push_back(balance_smoothed(about_the_samples(withheld(sample, step, one)), half_window));
  std::vector<double> products;
  for (const std::vector<double>& one : answers) {
    for (const std::vector<double>& other : answers) products.push_back(std::inner_product(one.begin(), one.end(), other.begin(), 0.0));
  }
  return products;
}

std::vector<double> balance_smoothed(const std::vector<double>& values, std::size_t half_window) {
  return convolved(values, half_window, mean_weights(half_window), true);
}

std::vector<std::size_t> moving_samples(const BalanceRecord& record, double resolved_speed) {
  std::vector<std::size_t> judged;
  for (std::size_t n = 0; n < record.speed.size(); ++n) {
    if (std::fabs(record.speed[n]) > resolved_speed) judged.push_back(n);
  }
  return judged;
}

}  // namespace slewlab::diagnosis
