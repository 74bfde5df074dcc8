#include "tests/diagnosis/balance/least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "diagnosis/balance/balance_setup.h"
#include "sim/machine/machine_file.h"
#include "sim/model/crane.h"

namespace slewlab::diagnosis {
namespace {

constexpr int kParts = 5;                // inertia, each direction's dry and viscous friction (the constant torque is in the dry ones)
constexpr double kNoiseShare = 0.02;     // of the effort, that counts of the encoder may make of the acceleration
constexpr double kLongest = 0.06;        // [s] to either side
constexpr double kStandstill = 5e-3;     // of top speed
constexpr int kFiner = 10;               // steps of the forward simulation per sample

// All series begin `reach` samples into the record.
struct Series {
  int reach = 0;
  double step = 0.0, standstill = 0.0;
  std::vector<double> speed, acceleration, effort;
  std::vector<double> all_efforts;
};

double least_change(const std::vector<double>& position) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < position.size(); ++n) {
    if (const double change = std::fabs(position[n] - position[n - 1]); change > 0.0) least = std::min(least, change);
  }
  return least;
}

int reach_of(const AxisRecord& record, double inertia) {
  double square = 0.0;
  for (const double effort : record.effort) square += effort * effort;
  const double rms = std::sqrt(square / static_cast<double>(record.effort.size())), counts = least_change(record.position) / std::sqrt(12.0);
  int reach = 2;
  while (reach * record.step < kLongest && inertia * counts * std::sqrt(6.0) / std::pow(reach * record.step, 2) > kNoiseShare * rms) ++reach;
  return reach;
}

// Mean under a hat of `reach` samples to either side.
std::vector<double> under_a_hat(const std::vector<double>& values, int reach) {
  std::vector<double> mean(values.size() - 2 * static_cast<std::size_t>(reach));
  for (std::size_t n = 0; n < mean.size(); ++n) {
    for (int k = -reach; k <= reach; ++k) mean[n] += (reach - std::abs(k)) * values[n + static_cast<std::size_t>(reach + k)] / (reach * reach);
  }
  return mean;
}

// Cut by `reach` more on either side: everything passes the hat.
Series series_of(const AxisRecord& record, int reach, double top_speed) {
  Series series;
  series.reach = reach;
  series.step = record.step;
  series.standstill = std::max(kStandstill * top_speed, least_change(record.position) / (2 * reach * record.step));
  const auto r = static_cast<std::size_t>(reach);
  const std::vector<double>& q = record.position;
  for (std::size_t n = r; n + r < q.size(); ++n) series.speed.push_back((q[n + r] - q[n - r]) / (2.0 * reach * record.step));
  for (std::size_t n = 2 * r; n + 2 * r < q.size(); ++n) series.acceleration.push_back((q[n + r] - 2.0 * q[n] + q[n - r]) / std::pow(reach * record.step, 2));
  // Held from sample to sample: what acts about a sample is the mean of either side.
  std::vector<double> effort = record.effort;
  for (std::size_t n = effort.size(); n-- > 1;) effort[n] = 0.5 * (effort[n] + effort[n - 1]);
  const std::vector<double> mean = under_a_hat(effort, reach);
  series.effort.assign(mean.begin() + reach, mean.end() - reach);
  series.all_efforts = record.effort;
  return series;
}

using Resistance = std::function<double(double speed)>;

std::vector<double> hatted(const Series& series, const std::function<double(std::size_t)>& value) {
  std::vector<double> along(series.speed.size());
  for (std::size_t n = 0; n < along.size(); ++n) along[n] = value(n);
  return under_a_hat(along, series.reach);
}

std::vector<std::vector<double>> columns_of(const Series& series) {
  const auto& v = series.speed;
  return {series.acceleration, hatted(series, [&](std::size_t n) { return std::max(0.0, v[n]); }), hatted(series, [&](std::size_t n) { return std::min(0.0, v[n]); }),
          hatted(series, [&](std::size_t n) { return v[n] > 0.0 ? 1.0 : 0.0; }), hatted(series, [&](std::size_t n) { return v[n] < 0.0 ? -1.0 : 0.0; })};
}

bool moves(const Series& series, std::size_t n) { return std::fabs(series.speed[n + static_cast<std::size_t>(series.reach)]) > series.standstill; }

struct Sum {
  double square = 0.0, count = 0.0;
  void add(double value) {
    square += value * value;
    ++count;
  }
  double rms() const { return std::sqrt(square / std::max(1.0, count)); }
};

int reach_of(const Split& split) {
  int reach = 0;
  for (const AxisRecord& record : split.fitted) reach = std::max(reach, reach_of(record, split.inertia));
  return reach;
}

// Friction with its jump solved for in every step; a friction that pushes is a force like others.
std::vector<double> simulated(const Series& series, double inertia, double viscous_up, double viscous_down, double dry_up, double dry_down) {
  const double h = series.step / kFiner, lean = dry_up + dry_down < 0.0 ? 0.0 : 0.5 * (dry_up + dry_down), constant = 0.5 * (dry_up - dry_down);
  std::vector<double> speeds;
  double v = series.speed.front();
  for (std::size_t n = 0; n < series.speed.size(); ++n) {
    speeds.push_back(v);
    for (int k = 0; k < kFiner; ++k) {
      const double free = v + h / inertia * (series.all_efforts[n + static_cast<std::size_t>(series.reach)] - (v > 0.0 ? viscous_up : viscous_down) * v - constant);
      const double hold = h / inertia * lean;
      v = std::fabs(free) <= hold ? 0.0 : free - std::copysign(hold, free);
    }
  }
  return speeds;
}

}  // namespace

Split split_of(const sim::MachineFile& axis, const std::vector<NamedRun>& fitted, const std::vector<NamedRun>& unseen) {
  Split split;
  for (const NamedRun& run : fitted) split.fitted.push_back(axis_record(run, axis));
  for (const NamedRun& run : unseen) split.unseen.push_back(axis_record(run, axis));
  split.inertia = sim::rigid_inertia(axis.parameters);
  split.top_speed = axis.parameters.drive.top_speed;
  return split;
}

UnseenErrors least_squares(const Split& split) {
  const int reach_of_all = reach_of(split);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kParts, kParts);
  Eigen::VectorXd with = Eigen::VectorXd::Zero(kParts);
  for (const AxisRecord& record : split.fitted) {
    const Series series = series_of(record, reach_of_all, split.top_speed);
    const auto columns = columns_of(series);
    for (std::size_t n = 0; n < series.effort.size(); ++n) {
      if (!moves(series, n)) continue;
      Eigen::VectorXd row(kParts);
      for (int k = 0; k < kParts; ++k) row(k) = columns[static_cast<std::size_t>(k)][n];
      products += row * row.transpose();
      with += row * series.effort[n];
    }
  }
  const Eigen::VectorXd scale = products.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * products * scale.asDiagonal();
  const Eigen::VectorXd sizes = scale.asDiagonal() * scaled.completeOrthogonalDecomposition().solve(scale.asDiagonal() * with);
  Sum balance, forward;
  for (const AxisRecord& record : split.unseen) {
    const Series series = series_of(record, reach_of_all, split.top_speed);
    const auto columns = columns_of(series);
    for (std::size_t n = 0; n < series.effort.size(); ++n) {
      if (!moves(series, n)) continue;
      double left = series.effort[n];
      for (int k = 0; k < kParts; ++k) left -= sizes(k) * columns[static_cast<std::size_t>(k)][n];
      balance.add(left);
    }
    const std::vector<double> speeds = simulated(series, sizes(0), sizes(1), sizes(2), sizes(3), sizes(4));
    for (std::size_t n = 0; n < speeds.size(); ++n) forward.add(series.speed[n] - speeds[n]);
  }
  return {balance.rms(), forward.rms()};
}

UnseenErrors predicted(const Split& split, const AxisDiagnosis& found) {
  const int reach_of_all = reach_of(split);
  const BalanceModel& model = found.answer.best;
  Sum balance, forward;
  for (const AxisRecord& record : split.unseen) {
    const Series series = series_of(record, reach_of_all, split.top_speed);
    const auto reach = static_cast<std::size_t>(series.reach);
    std::vector<double> left(series.effort.size());
    for (std::size_t n = 0; n < left.size(); ++n) left[n] = series.effort[n] - model.inertia * series.acceleration[n];
    const BalanceRecord smooth = make_balance_record(record, found.half_window, found.lateness);
    const std::size_t cut = (record.position.size() - smooth.motion.speed.size()) / 2;
    const auto motion_at = [&](std::size_t at) { return std::clamp<std::size_t>(at, cut, cut + smooth.motion.speed.size() - 1) - cut; };
    const auto rate = [&](std::size_t n) { return smooth.motion.effort_rate[motion_at(n + reach)]; };
    const std::vector<double> skewed = hatted(series, rate);
    for (std::size_t n = 0; n < left.size(); ++n) left[n] -= model.skew * skewed[n];
    for (const BalanceTerm& term : model.acting()) {
      const LawShape& shape = shape_of(found.laws, term);
      for (std::size_t c = 0; c < shape.columns.size(); ++c) {
        const std::vector<double> column = hatted(series, [&](std::size_t n) {
          const std::size_t at = n + reach;
          const double* late = smooth.motion.late_count > 0 ? &smooth.motion.late[motion_at(at) * smooth.motion.late_count] : nullptr;
          return shape.columns[c]({record.start_time + static_cast<double>(at) * record.step, record.position[at], series.speed[n], rate(n), late});
        });
        for (std::size_t n = 0; n < left.size(); ++n) left[n] -= term.size[c] * column[n];
      }
    }
    for (std::size_t n = 0; n < left.size(); ++n) {
      if (moves(series, n)) balance.add(left[n]);
    }
    const std::vector<double> speeds = forward_speed(record, smooth.motion, found.laws, model);
    for (std::size_t n = 0; n < series.speed.size(); ++n) forward.add(series.speed[n] - speeds[n + reach]);
  }
  return {balance.rms(), forward.rms()};
}

}  // namespace slewlab::diagnosis
