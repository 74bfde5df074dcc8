#include "diagnosis/torque_noise.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "diagnosis/median_deviation.h"

namespace slewlab::diagnosis {

namespace {

constexpr std::size_t kReadings = 8;         // of which a command may be made; chosen: a filter of a few cycles
constexpr std::size_t kPerUnknown = 10;      // differences at least
constexpr std::size_t kMost = 50'000;        // differences; of longer records every so many
constexpr double kHeld = 0.4;                // share of torques that did not change, from which on they are held; chosen: noise seldom repeats
constexpr double kHuber = 2.0;               // [deviations] from which on a difference counts less
constexpr int kRounds = 4;                   // of weights

// Of the differences that have all readings behind them, from so many before them on.
Eigen::VectorXd some_of(const Eigen::VectorXd& differences, Eigen::Index from) {
  const Eigen::Index complete = differences.size() - static_cast<Eigen::Index>(kReadings - 1);
  const Eigen::Index step = (complete - 1) / static_cast<Eigen::Index>(kMost) + 1;
  return differences(Eigen::seqN(from, (complete - 1) / step + 1, step));
}

double deviation_of(const Eigen::VectorXd& values) { return median_deviation({values.begin(), values.end()}); }

bool is_held(const Eigen::VectorXd& torque) {
  Eigen::Index unchanged = 0;
  for (Eigen::Index n = 1; n < torque.size(); ++n) unchanged += torque[n] == torque[n - 1] ? 1 : 0;
  return static_cast<double>(unchanged) > kHeld * static_cast<double>(torque.size());
}

// Third differences of what the encoders said at each torque and before it, a column per group, reading and signal.
Eigen::MatrixXd fast_readings(const std::vector<msgs::Encoder>& encoder, const std::vector<msgs::Torque>& torque) {
  const auto groups = static_cast<std::size_t>(torque.front().group_count);
  const auto count = static_cast<Eigen::Index>(torque.size());
  Eigen::MatrixXd read(count, static_cast<Eigen::Index>(2 * groups));
  std::size_t latest = 0;
  for (Eigen::Index n = 0; n < count; ++n) {
    while (latest + 1 < encoder.size() && encoder[latest + 1].simulated_time <= torque[static_cast<std::size_t>(n)].simulated_time) ++latest;
    for (std::size_t g = 0; g < groups; ++g) {
      read(n, static_cast<Eigen::Index>(2 * g)) = encoder[latest].shaft_position[g];
      read(n, static_cast<Eigen::Index>(2 * g + 1)) = encoder[latest].shaft_speed[g];
    }
  }
  const auto readings = static_cast<Eigen::Index>(kReadings);
  Eigen::MatrixXd fast;
  for (Eigen::Index column = 0; column < read.cols(); ++column) {
    const Eigen::VectorXd differences = third_difference(read.col(column));
    for (Eigen::Index j = 0; j < readings; ++j) {
      const Eigen::VectorXd taken = some_of(differences, readings - 1 - j);
      if (fast.size() == 0) fast.resize(taken.size(), read.cols() * readings);
      fast.col(column * readings + j) = taken;
    }
  }
  for (Eigen::Index column = 0; column < fast.cols(); ++column) {
    const double size = std::sqrt(fast.col(column).squaredNorm() / static_cast<double>(fast.rows()));
    if (size > 0.0) fast.col(column) /= size;
  }
  return fast;
}

// The residual of the best combination of the columns, by least squares in which what is far off counts less.
Eigen::VectorXd residual_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(wanted.size()), left = wanted;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd weighted = weight.asDiagonal() * columns;
    Eigen::MatrixXd normal = columns.transpose() * weighted;
    normal.diagonal().array() += 1e-9 * static_cast<double>(wanted.size());  // of columns that say the same
    left = wanted - columns * normal.ldlt().solve(weighted.transpose() * wanted);
    const double most = kHuber * deviation_of(left);
    if (most == 0.0) break;
    weight = left.unaryExpr([&](double one) { return std::min(1.0, most / std::fabs(one)); });
  }
  return left;
}

}  // namespace

Eigen::VectorXd third_difference(const Eigen::VectorXd& values) {
  const Eigen::Index n = values.size() - 3;
  return values.tail(n) - 3.0 * values.segment(2, n) + 3.0 * values.segment(1, n) - values.head(n);
}

double torque_noise(const std::vector<msgs::Encoder>& encoder, const std::vector<msgs::Torque>& torque) {
  if (encoder.empty() || torque.empty()) return 0.0;
  const auto groups = static_cast<std::size_t>(torque.front().group_count);
  if (torque.size() < kPerUnknown * 2 * groups * kReadings + kReadings + 2) return 0.0;
  const Eigen::MatrixXd fast = fast_readings(encoder, torque);
  double largest = 0.0;
  for (std::size_t g = 0; g < groups; ++g) {
    Eigen::VectorXd commanded(static_cast<Eigen::Index>(torque.size()));
    for (std::size_t n = 0; n < torque.size(); ++n) commanded[static_cast<Eigen::Index>(n)] = torque[n].motor_torque[g];
    if (is_held(commanded)) continue;
    const double deviation = deviation_of(residual_of(fast, some_of(third_difference(commanded), static_cast<Eigen::Index>(kReadings - 1))));
    largest = std::max(largest, deviation * deviation / kThirdDifferenceGain);
  }
  return largest;
}

}  // namespace slewlab::diagnosis
