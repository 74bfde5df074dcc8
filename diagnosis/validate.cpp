#include "diagnosis/validate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "diagnosis/chance.h"
#include "diagnosis/prediction.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kHeldOutRounds = 3;       // at most, with fresh columns
constexpr int kBeginningSteps = 2;      // Gauss-Newton steps; what begins differently is small, and linear nearly
constexpr double kBeginningStep = 0.1;  // [standard deviations] of a difference quotient
constexpr double kBetter = 4.6;         // -2 ln of odds of one to ten: what chance takes off a residual that was not fitted
// Relative closed-loop error beyond which two runs are no longer the same motion (two independent ones differ by 1.4), and the share
// by which one may be worse by chance.
constexpr double kDecorrelated = 0.7, kWorse = 1.05;

std::unique_ptr<Problem> same_machine(const Problem& problem) {
  auto other = std::make_unique<Problem>();
  other->nominal = problem.nominal;
  other->catalogue = problem.catalogue;
  other->thresholds = problem.thresholds;
  other->nuisances = problem.nuisances;
  other->gains = problem.gains;
  other->settings = problem.settings;
  other->threads = problem.threads;
  other->is_stopped = problem.is_stopped;
  return other;
}

// Window and noise of the first or the second half of a record.
Whitening whitening_of_half(const Problem& problem, const WhiteningSettings& settings, const Shadow& follower, bool second) {
  const Record& last = problem.records.back();
  std::vector<bool> trusted = trusted_stretches(last, follower, settings);
  const auto middle = trusted.begin() + static_cast<std::ptrdiff_t>(last.size() / 2);
  if (second) {
    std::fill(trusted.begin(), middle, false);
  } else {
    std::fill(middle, trusted.end(), false);
  }
  return make_whitening(last, trusted, problem.gains, follower, settings);
}

// The differences of one record with what only its beginning is like (the load's swing, where the motors stand) fitted there, everything
// else as it is.
Eigen::VectorXd differences_from_its_beginning(Problem& problem, Point point) {
  const std::size_t first = problem.nuisances.common_count(), count = problem.nuisances.per_record();
  Eigen::VectorXd difference = differences(problem, point);
  for (int step = 0; step < kBeginningSteps && count > 0; ++step) {
    Eigen::MatrixXd columns(difference.size(), static_cast<Eigen::Index>(count));
    Eigen::VectorXd amount(static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
      Point moved = point;
      moved.nuisance[first + k] += kBeginningStep;
      columns.col(static_cast<Eigen::Index>(k)) = (differences(problem, moved) - difference) / kBeginningStep;
      amount(static_cast<Eigen::Index>(k)) = point.nuisance[first + k];
    }
    const double weight = data_weight(difference, problem.settings);
    Eigen::MatrixXd curvature = weight * columns.transpose() * columns;
    curvature.diagonal().array() += 1.0;  // the prior's
    const Eigen::VectorXd change = -curvature.ldlt().solve(weight * columns.transpose() * difference + amount);
    Point moved = point;
    for (std::size_t k = 0; k < count; ++k) moved.nuisance[first + k] += change(static_cast<Eigen::Index>(k));
    Eigen::VectorXd after = differences(problem, moved);
    if (!(after.squaredNorm() < difference.squaredNorm())) break;
    point = std::move(moved);
    difference = std::move(after);
  }
  return difference;
}

}  // namespace

bool has_fit(const common::EffectAbout& effect) { return effect.read_off == common::ReadOff::none && !comes_by_chance(effect); }

HeldOutData::HeldOutData(const Problem& problem, const WhiteningSettings& settings, const Shadow& follower)
    : fitted_(same_machine(problem)), predicted_(same_machine(problem)), is_half_(problem.records.size() == 1) {
  const Record& last = problem.records.back();
  from_time_ = last.start_time;
  fitted_->records = problem.records;
  fitted_->whitening = problem.whitening;
  predicted_->records = {last};
  predicted_->whitening = {problem.whitening.back()};
  if (is_half_) {
    fitted_->whitening = {whitening_of_half(problem, settings, follower, false)};
    predicted_->whitening = {whitening_of_half(problem, settings, follower, true)};
    from_time_ = last.time(last.size() / 2);
  } else {
    fitted_->records.pop_back();
    fitted_->whitening.pop_back();
  }
}

HeldOut HeldOutData::fit(const Point& answer) {
  HeldOut held{answer, predicted_->records.back().name, from_time_, is_half_};
  held.point.nuisance.assign(nuisance_count(*fitted_), 0.0);
  const auto nuisances = static_cast<Eigen::Index>(held.point.nuisance.size());
  FitResult result = diagnosis::fit(*fitted_, Eigen::MatrixXd::Zero(difference_count(*fitted_), nuisances), held.point);
  settle(*fitted_, result, kHeldOutRounds);
  held.point = result.point;
  return held;
}

ValidationError HeldOutData::error(const Point& point, const std::optional<controller::ControllerSettings>& controller) {
  Point there = point;
  there.nuisance.resize(predicted_->nuisances.common_count());  // without the swings of the fitted records
  there.nuisance.resize(nuisance_count(*predicted_), 0.0);
  ValidationError error;
  error.residual_ratio = mean_square(differences_from_its_beginning(*predicted_, there));
  if (controller) {
    error.closed_loop = predict(machine_at(predicted_->nominal, predicted_->nuisances, there), *controller, predicted_->records.back(), from_time_)
                            .relative_gap;
  }
  return error;
}

bool HeldOutData::is_better(const ValidationError& cause, const ValidationError& than) const {
  const double fall = predicted_->settings.independent_share * static_cast<double>(difference_count(*predicted_)) *
                      (than.residual_ratio - cause.residual_ratio);
  if (!(fall > kBetter)) return false;
  if (!cause.closed_loop || !than.closed_loop || *than.closed_loop > kDecorrelated) return true;
  return *cause.closed_loop <= kWorse * *than.closed_loop;
}

}  // namespace slewlab::diagnosis
