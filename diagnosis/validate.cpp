#include "diagnosis/validate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "diagnosis/admit.h"
#include "diagnosis/own_noise_fit.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/prediction.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kHeldOutRounds = 3;       // at most, with fresh columns
constexpr int kHeldOutSteps = 8;       // Gauss-Newton steps at most
constexpr std::array<double, 3> kHeldOutDampings{0.0, 1.0, 10.0};  // the next where the one before did not make the cost fall
constexpr double kIdleStep = 1.0;      // fall of the cost that was too small for another one: a fifth of kBetter
constexpr double kHeldOutStep = 0.1;   // [standard deviations] of a difference quotient
constexpr int kDrawRounds = 2;        // of draws and a fit under their power
// Relative deviation of a stochastic effect's size from one record to the next, each being one draw; of the logarithm of a power that nobody
// knows, which goes with what the manoeuvre does.
constexpr double kSizeDeviation = 0.3, kUnknownDeviation = 0.5;
constexpr double kMeanDeviation = 0.4;  // of the mean of its draws, as in the search (stochastic_fit.cpp)
constexpr double kBetter = 4.6;         // -2 ln of odds of one to ten: what chance takes off a residual that was not fitted
// Relative closed-loop error beyond which two runs are no longer the same motion (two independent ones differ by 1.4). A machine whose residual is
// noise alone where it was led along moves as the real one does: its free run then differs by what small differences grow to, as behind an impact,
// and may be worse by half; chosen.
constexpr double kDecorrelated = 0.7, kWorseByChance = 1.5;

// Of the first or the second half of the last record.
Whitening whitening_of_half(const Problem& problem, const WhiteningSettings& settings, const Shadow& follower, bool second) {
  const Record& last = problem.records.back();
  const std::size_t middle = last.size() / 2;
  return whitening_between(problem, last, follower, settings, second ? middle : 0, second ? last.size() : middle);
}

// From one point of a hypothesis to another: nuisances, then coordinates of the effects.
Eigen::VectorXd coordinates_between(const common::EffectCatalogue& catalogue, const Point& from, const Point& to) {
  const auto count = static_cast<Eigen::Index>(from.nuisance.size());
  const Eigen::VectorXd effects = effect_coordinates(catalogue, to.effects) - effect_coordinates(catalogue, from.effects);
  Eigen::VectorXd between(count + effects.size());
  between << Eigen::Map<const Eigen::VectorXd>(to.nuisance.data(), count) - Eigen::Map<const Eigen::VectorXd>(from.nuisance.data(), count), effects;
  return between;
}

// One record as a hypothesis predicts it that was fitted to others: with what only its beginning is like (the load's swing, where the motors stand)
// fitted there, and the rest free within what the other records leave open.
struct Predicted {
  Eigen::VectorXd difference;
  Point point;              // with the record's own beginning
  double prior_cost = 0.0;  // of how far it moved, and Occam's
};

// The descent begins where the fitted part stands or, if it is better there, where a fit of all records does (`of_all`): between the two a record may have an impact that comes or does not,
// and no slope leads from one side of it to the other.
Predicted predicted_from(Problem& problem, Point point, const Eigen::MatrixXd& open, const std::optional<Point>& of_all) {
  const auto common = static_cast<Eigen::Index>(problem.nuisances.common_count()), own = static_cast<Eigen::Index>(problem.nuisances.per_record());
  const auto nuisances = static_cast<Eigen::Index>(point.nuisance.size());
  const Eigen::Index effects = effect_coordinates(problem.catalogue, point.effects).size();
  // Directions of the coordinates in which the prior is the unit ball.
  const Eigen::Index free = open.cols();
  Eigen::MatrixXd axes = Eigen::MatrixXd::Zero(nuisances + effects, own + free);
  axes.block(common, 0, own, own).setIdentity();
  if (free > 0) {
    const Eigen::MatrixXd root = open.llt().matrixL();
    axes.block(0, own, common, free) = root.topRows(common);
    axes.block(nuisances, own, effects, free) = root.bottomRows(effects);
  }
  Eigen::VectorXd amount = Eigen::VectorXd::Zero(axes.cols());
  for (Eigen::Index k = 0; k < own; ++k) amount(k) = point.nuisance[static_cast<std::size_t>(common + k)];
  const auto cost = [&](const Eigen::VectorXd& difference, const Eigen::VectorXd& at) {
    return discounted(residual_power(difference, problem.settings), problem.settings.law_freedom) + at.squaredNorm();
  };
  Predicted result{differences(problem, point), point, 0.0};
  if (axes.cols() == 0) return result;
  if (of_all) {
    const Eigen::VectorXd change = axes.partialPivLu().solve(coordinates_between(problem.catalogue, point, *of_all));
    Eigen::VectorXd difference = differences(problem, *of_all);
    if (cost(difference, amount + change) < cost(result.difference, amount)) {
      point = *of_all;
      result.difference = std::move(difference);
      amount += change;
    }
  }
  std::optional<LocalModel> here;  // where the descent stands; none: not yet made
  double occam = 0.0;
  Eigen::VectorXd trial_amount, trial_difference;
  Point trial;
  Descending problem_here;
  problem_here.model = [&]() -> LocalModel {
    if (here) return *here;
    std::vector<Point> points;
    for (Eigen::Index k = 0; k < axes.cols(); ++k) points.push_back(moved(problem.catalogue, point, kHeldOutStep * axes.col(k)));
    const std::vector<Eigen::VectorXd> there = differences(problem, points);
    Eigen::MatrixXd columns(result.difference.size(), axes.cols());
    for (Eigen::Index k = 0; k < axes.cols(); ++k) columns.col(k) = (there[static_cast<std::size_t>(k)] - result.difference) / kHeldOutStep;
    const double weight = data_weight(result.difference, problem.settings);
    here = {weight * columns.transpose() * columns, weight * columns.transpose() * result.difference + amount};
    here->curvature.diagonal().array() += 1.0;  // the prior's
    occam = Eigen::LDLT<Eigen::MatrixXd>(here->curvature).vectorD().array().max(1.0).log().sum();
    return *here;
  };
  problem_here.attempt = [&](const Eigen::VectorXd& change) -> std::optional<double> {
    trial = moved(problem.catalogue, point, axes * change);
    trial_difference = differences(problem, trial);
    trial_amount = amount + change;
    return cost(trial_difference, trial_amount);
  };
  problem_here.accept = [&] {
    point = trial;
    result.difference = trial_difference;
    amount = trial_amount;
    here.reset();
  };
  descend(problem_here, cost(result.difference, amount), {kHeldOutSteps, kHeldOutDampings, kIdleStep, 0.0});
  result.prior_cost = amount.squaredNorm() + occam;
  result.point = std::move(point);
  return result;
}

// What a fit leaves open of the parameters of all records together, and of its effects.
Eigen::MatrixXd open_part(const Problem& problem, const FitResult& result) {
  const Eigen::MatrixXd all = covariance(problem, result);
  std::vector<Eigen::Index> kept(problem.nuisances.common_count());
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  for (auto k = static_cast<Eigen::Index>(result.point.nuisance.size()); k < all.cols(); ++k) kept.push_back(k);
  return all(kept, kept);
}

}  // namespace

bool has_fit(const common::EffectAbout& effect) { return effect.read_off == common::ReadOff::none && !is_stochastic(effect); }

HeldOutData::HeldOutData(const Problem& problem, const WhiteningSettings& settings, HeldOutPart part)
    : fitted_(same_machine(problem)), predicted_(same_machine(problem)), is_half_(problem.records.size() == 1) {
  const bool is_last = part == HeldOutPart::last;
  const std::size_t held = is_last ? problem.records.size() - 1 : 0;
  const Record& record = problem.records[held];
  from_time_ = record.start_time;
  free_of_impacts_ = judged_share(problem.whitening[held]);
  const std::span<const Record> records(problem.records);
  fitted_->records.look_at(is_half_ ? records : records.subspan(is_last ? 0 : 1, records.size() - 1));
  fitted_->whitening = problem.whitening;
  predicted_->records.look_at(records.subspan(held, 1));
  predicted_->whitening = {problem.whitening[held]};
  predicted_->nuisances.begins = {begin_of(record)};
  if (is_half_) {
    const Shadow follower = shadow_at(problem, {}, held);
    fitted_->whitening = {whitening_of_half(problem, settings, follower, !is_last)};
    predicted_->whitening = {whitening_of_half(problem, settings, follower, is_last)};
    if (is_last) from_time_ = record.time(record.size() / 2);
  } else {
    const auto place = static_cast<std::ptrdiff_t>(held);
    fitted_->whitening.erase(fitted_->whitening.begin() + place);
    fitted_->nuisances.begins.resize(problem.records.size(), RecordBegins::unmoved);
    fitted_->nuisances.begins.erase(fitted_->nuisances.begins.begin() + place);
  }
  const auto common = static_cast<std::ptrdiff_t>(problem.nuisances.common_count()), own = static_cast<std::ptrdiff_t>(problem.nuisances.per_record());
  beginning_ = {common + own * static_cast<std::ptrdiff_t>(held), common + own * static_cast<std::ptrdiff_t>(held + 1)};
}

HeldOutData::HeldOutData(const Problem& problem, const WhiteningSettings& settings, Record unseen, std::vector<std::string>& remarks)
    : fitted_(same_machine(problem)), predicted_(same_machine(problem)) {
  fitted_->records.look_at({problem.records.data(), problem.records.size()});
  fitted_->whitening = problem.whitening;
  predicted_->nuisances.begins.clear();
  std::vector<Record> records;
  records.push_back(std::move(unseen));
  admit(std::move(records), settings, *predicted_, remarks);
  from_time_ = predicted_->records.front().start_time;
  free_of_impacts_ = judged_share(predicted_->whitening.front());
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
  HeldOut held{answer, {}, of_all(answer), predicted_->records.front().name, from_time_, is_half_};
  Point rest = without_stochastic(fitted_->catalogue, answer);
  // From where a fit of all records has led, as fit() does.
  if (rest.nuisance.empty()) rest.nuisance.assign(nuisance_count(*fitted_), 0.0);
  else rest.nuisance = without_held_out(std::move(rest.nuisance));
  held.point.nuisance = rest.nuisance;
  for (int round = 0; round < kDrawRounds; ++round) {
    Drawn drawn = draw(*fitted_, held.point);
    const Eigen::VectorXd mean = drawn.mean - differences(*fitted_, rest);
    const AddedPower added{std::move(drawn.power), 1.0, mean};
    Point start = rest;
    Eigen::VectorXd left;
    {
      const UnderPower under_power(*fitted_, added);
      const auto nuisances = static_cast<Eigen::Index>(start.nuisance.size());
      FitResult result = diagnosis::fit(*fitted_, Eigen::MatrixXd::Zero(difference_count(*fitted_), nuisances), start);
      settle(*fitted_, result, kHeldOutRounds);
      rest = result.point;
      held.open = open_part(*fitted_, result);
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
  HeldOut held{answer, {}, of_all(answer), predicted_->records.front().name, from_time_, is_half_};
  // From where a fit of all records has led, so that a valley that is hard to find from afar is not missed.
  Point start = answer;
  if (start.nuisance.empty()) start.nuisance.assign(nuisance_count(*fitted_), 0.0);
  else start.nuisance = without_held_out(std::move(start.nuisance));
  const UnderOwnNoise under_own_noise(*fitted_, makes_other_noise(*fitted_, start));
  FitResult result = diagnosis::fit(*fitted_, Eigen::MatrixXd::Zero(difference_count(*fitted_), static_cast<Eigen::Index>(start.nuisance.size())), start);
  settle(*fitted_, result, kHeldOutRounds);
  held.point = result.point;
  held.open = open_part(*fitted_, result);
  return held;
}

std::vector<double> HeldOutData::without_held_out(std::vector<double> amounts) const {
  if (!is_half_) amounts.erase(amounts.begin() + beginning_.first, amounts.begin() + beginning_.second);
  return amounts;
}

Point HeldOutData::at_held_out(const Point& point) const {
  Point there = point;
  there.nuisance.resize(predicted_->nuisances.common_count());  // without the swings of the fitted records
  there.nuisance.resize(nuisance_count(*predicted_), 0.0);
  return there;
}

std::optional<Point> HeldOutData::of_all(const Point& answer) const {
  if (answer.nuisance.empty() || beginning_.second == 0) return {};
  const auto common = static_cast<std::ptrdiff_t>(predicted_->nuisances.common_count());
  Point there = without_stochastic(predicted_->catalogue, answer);
  there.nuisance.assign(answer.nuisance.begin(), answer.nuisance.begin() + common);
  there.nuisance.insert(there.nuisance.end(), answer.nuisance.begin() + beginning_.first, answer.nuisance.begin() + beginning_.second);
  return there;
}

ValidationError HeldOutData::error(const HeldOut& fitted, const std::optional<controller::ControllerSettings>& controller) {
  const Point there = at_held_out(fitted.point);
  const std::vector<common::EffectInstance> stochastic = stochastic_part(predicted_->catalogue, there);
  const double share = predicted_->settings.independent_share;
  ValidationError error;
  error.differences = static_cast<double>(difference_count(*predicted_));
  if (stochastic.empty()) {
    const UnderOwnNoise under_own_noise(*predicted_, makes_other_noise(*predicted_, there));
    const Predicted predicted = predicted_from(*predicted_, there, fitted.open, fitted.of_all);
    error.residual_ratio = mean_square(predicted.difference);
    error.cost = share * predicted.difference.squaredNorm() + predicted.prior_cost;
    if (controller && !predicted_->records.front().begins_bent && free_of_impacts_ >= kFreeOfImpacts) {
      error.closed_loop =
          predict(machine_at(predicted_->nominal, predicted_->nuisances, there), *controller, predicted_->records.front(), from_time_).relative_gap;
    }
    return error;
  }
  const Point rest = without_stochastic(predicted_->catalogue, there);
  Drawn drawn = draw(*predicted_, there);
  const Eigen::VectorXd mean = drawn.mean - differences(*predicted_, rest);
  const AddedPower added{std::move(drawn.power), 1.0, mean};
  const UnderPower under_power(*predicted_, added);
  const Predicted predicted = predicted_from(*predicted_, rest, fitted.open, fitted.of_all);
  // What the draws do on the average goes with a law's shape, which is known less well than its size.
  const Eigen::VectorXd average = divided(added, mean);
  const double curvature = 1.0 + share * kMeanDeviation * kMeanDeviation * average.squaredNorm();
  const double more = -share * kMeanDeviation * average.dot(predicted.difference) / curvature;  // [standard deviations]
  const Eigen::VectorXd difference = predicted.difference + more * kMeanDeviation * average;
  error.residual_ratio = mean_square(difference);
  double deviation = 0.0;  // of the logarithm of the power
  for (const common::EffectInstance& effect : stochastic) {
    deviation = std::hypot(deviation, kSizeDeviation * predicted_->catalogue.at(effect.name).stochastic->power_exponent);
  }
  error.cost = share * predictive_cost(undivided(added, difference), added.power, deviation) + predicted.prior_cost + more * more + std::log(curvature);
  return error;
}

double HeldOutData::missing_torque(const HeldOut& fitted) const {
  const Point begun = without_stochastic(predicted_->catalogue, at_held_out(fitted.point));
  const UnderOwnNoise under_own_noise(*predicted_, makes_other_noise(*predicted_, begun));
  const Point there = predicted_from(*predicted_, begun, fitted.open, fitted.of_all).point;
  const Shadow follower = shadow_at(*predicted_, there, 0);
  const std::vector<double>& window = predicted_->whitening.front().window;
  const int groups = predicted_->records.front().group_count;
  double square = 0.0, weight = 0.0;
  for (std::size_t n = 0; n < window.size(); ++n) {
    for (int g = 0; g < groups; ++g) square += std::pow(window[n] * follower.missing_torque[static_cast<std::size_t>(g)][n], 2) / groups;
    weight += window[n] * window[n];
  }
  return std::sqrt(square / weight);
}

double HeldOutData::unknown_cost(const Point& point) {
  const Point there = at_held_out(point);
  const Predicted beginning = predicted_from(*predicted_, there, {}, {});
  const Eigen::VectorXd seen = differences(*fitted_, point), unseen = beginning.difference;
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
  return predicted_->settings.independent_share * least + beginning.prior_cost;
}

ValidationError together(const ValidationError& one, const ValidationError& other) {
  ValidationError both;
  both.differences = one.differences + other.differences;
  both.residual_ratio = (one.residual_ratio * one.differences + other.residual_ratio * other.differences) / both.differences;
  both.cost = one.cost + other.cost;
  both.closed_loop = one.closed_loop ? one.closed_loop : other.closed_loop;
  if (one.closed_loop && other.closed_loop) both.closed_loop = std::hypot(*one.closed_loop, *other.closed_loop) / std::numbers::sqrt2;
  return both;
}

std::optional<Point> fitted_part(const common::EffectCatalogue& catalogue, const Point& answer) {
  Point part = answer;
  std::erase_if(part.effects, [&](const common::EffectInstance& effect) { return catalogue.at(effect.name).read_off != common::ReadOff::none; });
  if (part.effects.empty()) return {};
  return part;
}

bool is_better(const ValidationError& cause, const ValidationError& than) {
  if (!(than.cost - cause.cost > kBetter)) return false;
  if (!cause.closed_loop || !than.closed_loop || *than.closed_loop > kDecorrelated) return true;
  const bool is_noise = cause.residual_ratio <= kNoiseAlone && than.residual_ratio > kNoiseAlone;
  return *cause.closed_loop <= (is_noise ? kWorseByChance : kWorse) * *than.closed_loop;
}

bool holds(const Validation& validation, bool is_said_by_parameters) {
  return is_better(validation.cause, validation.nominal) && (is_said_by_parameters || is_better(validation.cause, validation.parameters)) &&
         (!validation.unknown_cost || *validation.unknown_cost - validation.cause.cost > kBetter);
}

}  // namespace slewlab::diagnosis
