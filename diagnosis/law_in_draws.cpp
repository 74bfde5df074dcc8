#include "diagnosis/law_in_draws.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "diagnosis/validate.h"
#include "sim/machine/scales.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLongestWindow = 0.5;  // [characteristic times]
constexpr double kAmount = 0.01;        // of the rated torque, by the largest change: so little that no tooth parts
constexpr std::uint64_t kDraws = 4;
constexpr double kSameDirection = 1e-9;  // of the trace of the columns' products, added to their diagonal: two windows may be the same

// What a change of the command counts by: the change, the command before it, the speed, each over its largest.
using Factor = std::function<double(double change, double before, double speed)>;
const std::vector<Factor>& factors() {
  static const std::vector<Factor> kFactors{[](double, double, double) { return 1.0; },
                                            [](double change, double, double) { return change > 0.0 ? 1.0 : 0.0; },
                                            [](double change, double before, double) { return change * before > 0.0 ? 1.0 : 0.0; },
                                            [](double change, double, double) { return std::fabs(change); },
                                            [](double, double, double speed) { return std::fabs(speed); }};
  return kFactors;
}

double largest(const std::vector<double>& values) {
  double most = std::numeric_limits<double>::min();
  for (const double value : values) most = std::max(most, std::fabs(value));
  return most;
}

// For one window [s] and one factor: of each record.
std::vector<MoreTorques> torques_of(const Problem& problem, double window, const Factor& factor) {
  const double rated = kAmount * sim::scales_of(problem.nominal.crane).motor_torque;
  std::vector<MoreTorques> torques(problem.records.size());
  for (std::size_t r = 0; r < torques.size(); ++r) {
    const Record& record = problem.records[r];
    const auto rows = static_cast<std::size_t>(std::max(1.0, std::round(window / record.step)));
    for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
      const std::vector<double>&command = record.motor_torque[g], &speed = record.shaft_speed[g];
      const double most = largest(command), fastest = largest(speed);
      std::vector<double>& torque = torques[r].of_group[g];
      for (std::size_t n = 0; n < record.size(); ++n) {
        const double before = command[n - std::min(n, rows)] / most, change = command[n] / most - before;
        torque.push_back(rated * change * factor(change, before, speed[n] / fastest));
      }
    }
  }
  return torques;
}

// What the columns leave of some differences.
class LeftOver {
 public:
  explicit LeftOver(const std::vector<Eigen::VectorXd>& columns) : columns_(columns.front().size(), static_cast<Eigen::Index>(columns.size())) {
    for (std::size_t c = 0; c < columns.size(); ++c) columns_.col(static_cast<Eigen::Index>(c)) = columns[c].normalized();
    Eigen::MatrixXd products = gram_of(columns_);
    products.diagonal().array() += kSameDirection * products.trace();
    products_.compute(products);
  }
  double square(const Eigen::VectorXd& difference) const { return (difference - columns_ * products_.solve(columns_.transpose() * difference)).squaredNorm(); }

 private:
  Eigen::MatrixXd columns_;
  Eigen::LDLT<Eigen::MatrixXd> products_;
};

}  // namespace

LawInDraws law_in_draws(Problem& problem, const FitResult& fit) {
  const Point still = without_stochastic(problem.catalogue, fit.point);
  const Eigen::VectorXd here = differences(problem, still);
  std::vector<std::vector<MoreTorques>> torques;
  double step = std::numeric_limits<double>::infinity();
  for (const Record& record : problem.records) step = std::min(step, record.step);
  for (double window = step; window <= std::max(step, kLongestWindow * problem.thresholds.time); window *= 2.0) {
    for (const Factor& factor : factors()) torques.push_back(torques_of(problem, window, factor));
  }
  const LeftOver left_over(changes(problem, column_base(problem, still, here), std::vector<Point>(torques.size(), still), torques));
  std::vector<Point> drawn(kDraws, fit.point);
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) drawn[draw].seed = draw + 1;
  const auto noise = static_cast<double>(here.size());
  LawInDraws found;
  for (Eigen::VectorXd& change : differences(problem, drawn)) {
    change -= here;
    found.left_of_draws += left_over.square(change) / noise / static_cast<double>(kDraws);
  }
  found.left = std::max(0.0, left_over.square(here) / noise - 1.0);
  return found;
}

}  // namespace slewlab::diagnosis
