#include "diagnosis/balance/balance_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slewlab::diagnosis {

namespace {

constexpr double kLongestWindow = 0.5;  // of the time in which the axis changes its speed, in which laws are taken for constant; chosen
constexpr double kResolved = 2e-3;      // of top speed, below which no friction is judged; chosen
constexpr double kNoises = 3.0;         // standard deviations of the speed's noise, likewise
constexpr double kFewMoves = 0.01;      // of a record, by which it moves in a direction; chosen
constexpr double kShortestLate = 1.5;   // [samples], below which a recorder's skew is as likely
// Lags and delays that are tried, of the time in which the axis changes its speed; evenly in the logarithm.
constexpr double kLateShares[] = {0.01, 0.015, 0.022, 0.033, 0.05, 0.075, 0.11, 0.16, 0.24, 0.36, 0.5};

// [s] in which the axis changes its speed: RMS of the speed over that of the acceleration, without what noise of the positions makes of it.
double motion_time(const AxisRecord& record, std::size_t half_window) {
  const BalanceRecord smooth = make_balance_record(record, half_window);
  double speed = 0.0, acceleration = 0.0;
  for (std::size_t n = 0; n < smooth.speed.size(); ++n) {
    speed += smooth.speed[n] * smooth.speed[n];
    acceleration += smooth.acceleration[n] * smooth.acceleration[n];
  }
  const double noise = acceleration_noise(record, half_window);
  acceleration -= noise * noise * static_cast<double>(smooth.speed.size());
  return acceleration > 0.0 ? std::sqrt(speed / acceleration) : std::numeric_limits<double>::infinity();
}

// As long as the noise asks for, unless the axis changes its speed faster than that.
std::size_t half_window_of(const AxisRecord& record, double inertia) {
  constexpr double kRoom = 0.2;  // of the record, that a window takes at most
  std::size_t half = balance_half_window(record, inertia, kRoom * record.step * static_cast<double>(record.position.size()));
  while (2.0 * static_cast<double>(half) * record.step > kLongestWindow * motion_time(record, half) && half > kFewestHalf) {
    half = std::max(kFewestHalf, half - std::max<std::size_t>(1, half / 5));
  }
  return half;
}

}  // namespace

Balance balance_of(const std::vector<AxisRecord>& records, double inertia, double top_speed, bool is_rotary) {
  Balance balance;
  for (const AxisRecord& record : records) balance.half_window = std::max(balance.half_window, half_window_of(record, inertia));
  balance.resolved_speed = kResolved * top_speed;
  BalanceScales scales;
  double low = std::numeric_limits<double>::infinity(), high = -low, speed = 0.0, acceleration = 0.0, step = 0.0;
  std::vector<BalanceRecord> all;
  for (const AxisRecord& record : records) {
    const BalanceRecord& one = all.emplace_back(make_balance_record(record, balance.half_window));
    balance.resolved_speed = std::max(balance.resolved_speed, kNoises * one.speed_noise);
    for (std::size_t n = 0; n < one.speed.size(); ++n) {
      speed += one.speed[n] * one.speed[n];
      acceleration += one.acceleration[n] * one.acceleration[n];
    }
    step = std::max(step, one.step);
    scales.duration = std::max(scales.duration, one.time.back());
    low = std::min(low, *std::min_element(one.position.begin(), one.position.end()));
    high = std::max(high, *std::max_element(one.position.begin(), one.position.end()));
  }
  const auto is_moved_along = [&](int direction) {
    return std::any_of(all.begin(), all.end(), [&](const BalanceRecord& one) { return moves_along(one, direction, balance.resolved_speed); });
  };
  balance.direction = static_cast<int>(is_moved_along(1)) - static_cast<int>(is_moved_along(-1));
  scales.direction = balance.direction;
  scales.top_speed = top_speed;
  scales.resolved_speed = balance.resolved_speed;
  scales.middle_position = 0.5 * (low + high);
  scales.half_range = 0.5 * (high - low);
  scales.is_rotary = is_rotary;
  const double motion_time = acceleration > 0.0 ? std::sqrt(speed / acceleration) : 0.0;
  for (const bool is_delay : {false, true}) {
    for (const double share : kLateShares) {
      if (share * motion_time > kShortestLate * step) balance.lateness.push_back({share * motion_time, is_delay});
    }
  }
  scales.lateness = balance.lateness;
  balance.laws = balance_laws(scales);
  return balance;
}

bool moves_along(const BalanceRecord& record, int direction, double resolved_speed) {
  const auto count = std::count_if(record.speed.begin(), record.speed.end(), [&](double speed) { return direction * speed > resolved_speed; });
  return static_cast<double>(count) > kFewMoves * static_cast<double>(record.speed.size());
}

std::vector<BalanceRecord> smoothed(const std::vector<AxisRecord>& records, const Balance& balance) {
  std::vector<BalanceRecord> all;
  for (const AxisRecord& record : records) {
    all.push_back(make_balance_record(record, balance.half_window, balance.lateness));
    const double noise = effort_noise(record.effort);
    if (!(noise > 0.0)) continue;
    all.back().noise_products = effort_noise_products(record.step, balance.half_window, balance.lateness);
    for (double& product : all.back().noise_products) product *= noise * noise;
  }
  return all;
}

}  // namespace slewlab::diagnosis
