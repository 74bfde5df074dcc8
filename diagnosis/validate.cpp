#include "diagnosis/validate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "diagnosis/stochastic.h"
#include "diagnosis/prediction.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kHeldOutRounds = 3;       // at most, with fresh columns
constexpr int kBeginningSteps = 2;      // Gauss-Newton steps; what begins differently is small, and linear nearly
constexpr double kBeginningStep = 0.1;  // [standard deviations] of a difference quotient
constexpr int kDrawRounds = 2;        // of draws and a fit under their power
// Relative deviation of a stochastic effect's size from one record to the next, each being one draw; of the logarithm of a power that nobody
// knows, which goes with what the manoeuvre does.
constexpr double kSizeDeviation = 0.3, kUnknownDeviation = 0.5;
constexpr double kBetter = 4.6;         // -2 ln of odds of one to ten: what chance takes off a residual that was not fitted
// Relative closed-loop error beyond which two runs are no longer the same motion (two independent ones differ by 1.4), and the share
// by which one may be worse though it is the truth.
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

bool has_fit(const common::EffectAbout& effect) { return effect.read_off == common::ReadOff::none && !is_stochastic(effect); }

HeldOutData::HeldOutData(const Problem& problem, const WhiteningSettings& settings, const Shadow& follower)
    : fitted_(same_machine(problem)), predicted_(same_machine(problem)), is_half_(problem.records.size() == 1) {
  const Record& last = problem.records.back();
  from_time_ = last.start_time;
  fitted_->records = problem.records;
  fitted_->whitening = problem.whitening;
  predicted_->records = {last};
  predicted_->whitening = {problem.whitening.back()};
  predicted_->nuisances.in_motion = {last.begins_in_motion};
  if (is_half_) {
    fitted_->whitening = {whitening_of_half(problem, settings, follower, false)};
    predicted_->whitening = {whitening_of_half(problem, settings, follower, true)};
    from_time_ = last.time(last.size() / 2);
  } else {
    fitted_->records.pop_back();
    fitted_->whitening.pop_back();
    fitted_->nuisances.in_motion.resize(fitted_->records.size());
  }
}

std::vector<common::EffectInstance> stochastic_part(const common::EffectCatalogue& catalogue, const Point& point) {
  std::vector<common::EffectInstance> part;
  std::copy_if(point.effects.begin(), point.effects.end(), std::back_inserter(part),
               [&](const common::EffectInstance& effect) { return is_stochastic(catalogue.at(effect.name)); });
  return part;
}

Point without_stochastic(const common::EffectCatalogue& catalogue, Point point) {
  std::erase_if(point.effects, [&](const common::EffectInstance& effect) { return is_stochastic(catalogue.at(effect.name)); });
  return point;
}

HeldOut HeldOutData::fit_with_stochastic(const Point& answer) {
  const std::vector<common::EffectInstance> stochastic = stochastic_part(fitted_->catalogue, answer);
  HeldOut held{answer, predicted_->records.back().name, from_time_, is_half_};
  Point rest = without_stochastic(fitted_->catalogue, answer);
  rest.nuisance.resize(nuisance_count(*fitted_), 0.0);
  held.point.nuisance = rest.nuisance;
  for (int round = 0; round < kDrawRounds; ++round) {
    Drawn drawn = draw(*fitted_, held.point);
    const Eigen::VectorXd mean = drawn.mean - differences(*fitted_, rest);
    const AddedPower added{std::move(drawn.power), 1.0, mean};
    Point start = rest;
    if (round == 0) std::fill(start.nuisance.begin(), start.nuisance.end(), 0.0);
    Eigen::VectorXd left;
    {
      const UnderPower under_power(*fitted_, added);
      const auto nuisances = static_cast<Eigen::Index>(start.nuisance.size());
      FitResult result = diagnosis::fit(*fitted_, Eigen::MatrixXd::Zero(difference_count(*fitted_), nuisances), start);
      settle(*fitted_, result, kHeldOutRounds);
      rest = result.point;
      left = undivided(added, result.difference);
    }
    const PowerFit found = fit_power(left, added.power);
    held.point = rest;
    held.point.effects.insert(held.point.effects.end(), stochastic.begin(), stochastic.end());
    if (found.scale == 0.0) continue;
    for (common::EffectInstance& effect : held.point.effects) {
      const common::EffectAbout& about = fitted_->catalogue.at(effect.name);
      if (is_stochastic(about)) effect = with_power(about, effect, found.scale);
    }
  }
  return held;
}

HeldOut HeldOutData::fit(const Point& answer) {
  if (!stochastic_part(fitted_->catalogue, answer).empty()) return fit_with_stochastic(answer);
  HeldOut held{answer, predicted_->records.back().name, from_time_, is_half_};
  held.point.nuisance.assign(nuisance_count(*fitted_), 0.0);
  const auto nuisances = static_cast<Eigen::Index>(held.point.nuisance.size());
  FitResult result = diagnosis::fit(*fitted_, Eigen::MatrixXd::Zero(difference_count(*fitted_), nuisances), held.point);
  settle(*fitted_, result, kHeldOutRounds);
  held.point = result.point;
  return held;
}

Point HeldOutData::at_held_out(const Point& point) const {
  Point there = point;
  there.nuisance.resize(predicted_->nuisances.common_count());  // without the swings of the fitted records
  there.nuisance.resize(nuisance_count(*predicted_), 0.0);
  return there;
}

ValidationError HeldOutData::error(const Point& point, const std::optional<controller::ControllerSettings>& controller) {
  const Point there = at_held_out(point);
  const std::vector<common::EffectInstance> stochastic = stochastic_part(predicted_->catalogue, there);
  const double share = predicted_->settings.independent_share;
  ValidationError error;
  if (stochastic.empty()) {
    const Eigen::VectorXd difference = differences_from_its_beginning(*predicted_, there);
    error.residual_ratio = mean_square(difference);
    error.cost = share * difference.squaredNorm();
    if (controller && !predicted_->records.back().begins_in_motion) {
      error.closed_loop =
          predict(machine_at(predicted_->nominal, predicted_->nuisances, there), *controller, predicted_->records.back(), from_time_).relative_gap;
    }
    return error;
  }
  const Point rest = without_stochastic(predicted_->catalogue, there);
  Drawn drawn = draw(*predicted_, there);
  const Eigen::VectorXd mean = drawn.mean - differences(*predicted_, rest);
  const AddedPower added{std::move(drawn.power), 1.0, mean};
  const UnderPower under_power(*predicted_, added);
  const Eigen::VectorXd difference = differences_from_its_beginning(*predicted_, rest);
  error.residual_ratio = mean_square(difference);
  double deviation = 0.0;  // of the logarithm of the power
  for (const common::EffectInstance& effect : stochastic) {
    deviation = std::hypot(deviation, kSizeDeviation * predicted_->catalogue.at(effect.name).stochastic->power_exponent);
  }
  error.cost = share * predictive_cost(undivided(added, difference), added.power, deviation);
  return error;
}

double HeldOutData::unknown_cost(const Point& point) {
  const Point there = at_held_out(point);
  const Eigen::VectorXd seen = differences(*fitted_, point), unseen = differences_from_its_beginning(*predicted_, there);
  const auto cost_along = [&](const std::vector<ChannelAxes>& seen_axes, std::vector<ChannelAxes> unseen_axes) {
    return predictive_cost(unseen, unknown_power(*fitted_, seen_axes, seen, *predicted_, std::move(unseen_axes)), kUnknownDeviation);
  };
  const auto axes_without = [](Problem& problem, const Point& with, std::size_t effect, const Eigen::VectorXd& difference) {
    Point without = with;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(effect));
    return axes_of(problem, std::vector<Eigen::VectorXd>{difference - differences(problem, without)});
  };
  double least = cost_along({}, {});
  for (std::size_t e = 0; e < point.effects.size(); ++e) {
    least = std::min(least, cost_along(axes_without(*fitted_, point, e, seen), axes_without(*predicted_, there, e, unseen)));
  }
  return predicted_->settings.independent_share * least;
}

bool is_better(const ValidationError& cause, const ValidationError& than) {
  if (!(than.cost - cause.cost > kBetter)) return false;
  if (!cause.closed_loop || !than.closed_loop || *than.closed_loop > kDecorrelated) return true;
  return *cause.closed_loop <= kWorse * *than.closed_loop;
}

bool holds(const Validation& validation) {
  return is_better(validation.cause, validation.nominal) && is_better(validation.cause, validation.parameters) &&
         (!validation.unknown_cost || *validation.unknown_cost - validation.cause.cost > kBetter);
}

}  // namespace slewlab::diagnosis
