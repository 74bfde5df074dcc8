#include "diagnosis/unknown_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "diagnosis/own_noise.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kRounds = 8;                             // in which the misfit's weight settles; chosen: it falls by ratios
constexpr double kSameWeight = 1e-9;                   // of it, by which it has settled
constexpr int kSteps = 6;                              // of a descent, at most; chosen: the fit has settled, and the function is nearly linear
constexpr int kFresh = 4;                             // times that columns are taken anew, at most
constexpr double kSettled = 2.0, kSettledShare = 0.01;  // of the cost, that such a round must be worth for another one
constexpr double kNear = 30.0;                        // cost above the least one that is known, within which a law may still lead: what the densities' widths differ by; chosen
constexpr double kOpen = 2.0;                         // step of a difference quotient over what the records leave open
constexpr double kSmallestStep = 0.06, kLargestStep = 0.3;  // of a fit's coordinate [standard deviations]
constexpr std::array<double, 3> kDampings{0.0, 1.0, 10.0};
constexpr double kEnough = 0.5, kEnoughShare = 1e-3;  // of the cost, that a step must be worth

// What a step in the coordinates of all columns makes of the prior, the function's in standard deviations for one rho.
PriorRows prior_of(const Problem& problem, const FittedLaw& at, double rho) {
  const PriorRows own = prior_rows(problem, at.point);
  const Eigen::Index count = at.columns.cols();
  PriorRows rows{Eigen::VectorXd(count), Eigen::VectorXd::Ones(count)};
  rows.value << own.value, at.coefficients / std::sqrt(rho);
  rows.slope.head(own.slope.size()) = own.slope;
  return rows;
}

// 1 for the fit's columns, the root of rho for the function's.
Eigen::VectorXd scale_of(const FittedLaw& at, double rho) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(at.columns.cols());
  scale.tail(at.coefficients.size()).setConstant(std::sqrt(rho));
  return scale;
}

Eigen::VectorXd difference_under(Problem& problem, const SmoothTorques& smooth, const FittedLaw& law) {
  const std::vector<MoreTorques> torques = smooth.torques(problem, law.function, law.coefficients);
  return std::move(differences(problem, {&law.point, 1}, {&torques, 1}).front());
}

// By how much the differences of other places of a law are others than where it stands.
std::vector<Eigen::VectorXd> changes_to(Problem& problem, const SmoothTorques& smooth, const FittedLaw& at, std::span<const FittedLaw> places) {
  std::vector<Point> points;
  for (const FittedLaw& place : places) points.push_back(place.point);
  std::vector<std::vector<MoreTorques>> torques(places.size());
  share_out(problem, places.size(), [&](std::size_t i) { torques[i] = smooth.torques(problem, at.function, places[i].coefficients); });
  return changes(problem, column_base(problem, at.point, at.difference, smooth.torques(problem, at.function, at.coefficients)), points, torques);
}

double cost_of(const Problem& problem, const FittedLaw& law) {
  return discounted(residual_power(law.difference, problem.settings), problem.settings.law_freedom) + prior_cost(problem, law.point) + law.coefficients.squaredNorm() / law.rho;
}

void descend_from(Problem& problem, const SmoothTorques& smooth, FittedLaw& at) {
  const double rho = at.rho;
  const Eigen::VectorXd scale = scale_of(at, rho);
  const Eigen::Index function = at.coefficients.size(), own = at.columns.cols() - function;
  FittedLaw trial{at.function, rho, {}, {}, {}, {}};
  Descending problem_here;
  problem_here.model = [&]() -> LocalModel {
    const double weight = data_weight(at.difference, problem.settings);
    const Eigen::MatrixXd columns = at.columns * scale.asDiagonal();
    const PriorRows prior = prior_of(problem, at, rho);
    LocalModel model{weight * gram_of(columns), weight * columns.transpose() * at.difference + prior.value.cwiseProduct(prior.slope)};
    model.curvature.diagonal() += prior.slope.cwiseProduct(prior.slope);
    return model;
  };
  problem_here.attempt = [&](const Eigen::VectorXd& asked) -> std::optional<double> {
    trial.point = moved(problem.catalogue, at.point, asked.head(own));
    Eigen::VectorXd step(own + function);
    step << step_between(problem.catalogue, at.point, trial.point), std::sqrt(rho) * asked.tail(function);
    const double length = step.squaredNorm();
    if (length == 0.0) return std::nullopt;
    trial.coefficients = at.coefficients + step.tail(function);
    trial.difference = difference_under(problem, smooth, trial);
    at.columns += (trial.difference - at.difference - at.columns * step) / length * step.transpose();
    return cost_of(problem, trial);
  };
  problem_here.accept = [&] {
    const Eigen::MatrixXd axes = step_axes(problem.catalogue, at.point.effects, trial.point.effects);
    const Eigen::Index effects = axes.cols();
    at.columns.middleCols(own - effects, effects) = (at.columns.middleCols(own - effects, effects) * axes).eval();
    at.point = trial.point;
    at.coefficients = trial.coefficients;
    at.difference = trial.difference;
  };
  descend(problem_here, cost_of(problem, at), {kSteps, kDampings, kEnough, kEnoughShare});
}

// Columns in groups of which no two change the same record, as those of how two records begin: each group is one simulation. Those that change nothing are in none.
std::vector<std::vector<Eigen::Index>> taken_together(const Problem& problem, const Eigen::MatrixXd& columns) {
  const std::vector<Eigen::Index> rows = first_rows(problem);
  std::vector<std::vector<Eigen::Index>> groups;
  std::vector<std::vector<bool>> changed;  // records, by each group
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    std::vector<bool> changes;
    for (std::size_t r = 0; r + 1 < rows.size(); ++r) changes.push_back(columns.col(i).segment(rows[r], rows[r + 1] - rows[r]).any());
    if (std::none_of(changes.begin(), changes.end(), std::identity())) continue;
    const auto overlaps = [&](const std::vector<bool>& with) { return std::inner_product(with.begin(), with.end(), changes.begin(), false, std::logical_or(), std::logical_and()); };
    const auto free = std::find_if_not(changed.begin(), changed.end(), overlaps);
    if (free == changed.end()) {
      groups.push_back({i});
      changed.push_back(std::move(changes));
      continue;
    }
    groups[static_cast<std::size_t>(free - changed.begin())].push_back(i);
    std::transform(changes.begin(), changes.end(), free->begin(), free->begin(), std::logical_or());
  }
  return groups;
}

// Difference quotients where the law stands, of the fit's coordinates and of the function's; those that change nothing stay as they are.
void renew_columns(Problem& problem, const SmoothTorques& smooth, FittedLaw& at) {
  const Eigen::Index function = at.coefficients.size(), count = at.columns.cols(), own = count - function;
  const Eigen::VectorXd scale = scale_of(at, at.rho);
  const PriorRows prior = prior_of(problem, at, at.rho);
  Eigen::MatrixXd curvature = data_weight(at.difference, problem.settings) * (scale.asDiagonal() * gram_of(at.columns) * scale.asDiagonal());
  curvature.diagonal() += prior.slope.cwiseProduct(prior.slope);
  const Eigen::VectorXd open = scale.cwiseProduct(curvature.ldlt().solve(Eigen::MatrixXd::Identity(count, count)).diagonal().cwiseSqrt());
  const std::vector<std::vector<Eigen::Index>> groups = taken_together(problem, at.columns);
  std::vector<Eigen::VectorXd> changes;
  std::vector<FittedLaw> laws;
  for (const std::vector<Eigen::Index>& group : groups) {
    Eigen::VectorXd& change = changes.emplace_back(Eigen::VectorXd::Zero(count));
    for (const Eigen::Index i : group) change(i) = i < own ? std::clamp(kOpen * open(i), kSmallestStep, kLargestStep) : kOpen * open(i);
    laws.push_back({at.function, at.rho, moved(problem.catalogue, at.point, change.head(own)), at.coefficients + change.tail(function), {}, {}});
    change.head(own) = step_between(problem.catalogue, at.point, laws.back().point);
  }
  const std::vector<Eigen::VectorXd> changed = changes_to(problem, smooth, at, laws);
  const std::vector<Eigen::Index> rows = first_rows(problem);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    for (const Eigen::Index i : groups[k]) {
      if (changes[k](i) == 0.0) continue;  // at its bound
      for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
        auto of_record = at.columns.col(i).segment(rows[r], rows[r + 1] - rows[r]);
        if (of_record.any()) of_record = changed[k].segment(rows[r], rows[r + 1] - rows[r]) / changes[k](i);
      }
    }
  }
}

// From where it stands, and on with fresh columns as long as they are worth it. Not where it would not come down to `reach` if they gave as much again as the columns that it
// has: most laws are not what is missing. Nor where there is noise alone and they take nothing away from it.
void settle(Problem& problem, const SmoothTorques& smooth, FittedLaw& law, double reach) {
  const double begun = cost_of(problem, law);
  descend_from(problem, smooth, law);
  const double come_to = cost_of(problem, law);
  if (!would_come_down(begun, come_to, 1, reach) || (begun - come_to < kEnough && mean_square(law.difference) <= 1.0)) return;
  for (int fresh = 0; fresh < kFresh; ++fresh) {
    const double before = cost_of(problem, law);
    renew_columns(problem, smooth, law);
    descend_from(problem, smooth, law);
    if (before - cost_of(problem, law) < std::max(kSettled, kSettledShare * std::fabs(before))) return;
  }
}

// A law that was fitted beside an effect, without it.
FittedLaw alone(Problem& problem, const SmoothTorques& smooth, const FittedLaw& law) {
  FittedLaw alone{law.function, law.rho, law.point, law.coefficients, {}, {}};
  alone.point.effects.clear();
  alone.difference = difference_under(problem, smooth, alone);
  alone.columns.resize(law.columns.rows(), static_cast<Eigen::Index>(law.point.nuisance.size()) + law.coefficients.size());
  alone.columns << law.columns.leftCols(static_cast<Eigen::Index>(law.point.nuisance.size())), law.columns.rightCols(law.coefficients.size());
  return alone;
}

// By the noise of the nominal machine.
ByOwnNoise by_nominal_noise(const FittedLaw& at) { return {at.difference.squaredNorm(), gram_of(at.columns), at.columns.transpose() * at.difference}; }

// What a law is counted by: the products of its columns with each other and with the differences, by the noise that the residual power is counted by, and that power where the law
// stands. It falls no lower than that, as in relax(), unless it `may_leave_less`.
struct Counted {
  const ByOwnNoise& by_noise;
  double residual_power = 0.0;
  bool may_leave_less = false;
  double prior_besides = 0.0;
  const MisfitCost& misfit_cost;
  double floor = 0.0;
};

// The law for one rho from where it stands: z and a move to where the sum of M(residual power - floor) and prior is least for it.
UnknownLaw for_scale(const Problem& problem, const FittedLaw& at, double rho, const Counted& counted) {
  const double share = problem.settings.independent_share;
  const Eigen::VectorXd scale = scale_of(at, rho);
  const Eigen::MatrixXd gram = scale.asDiagonal() * counted.by_noise.gram * scale.asDiagonal();
  const Eigen::VectorXd slope = scale.cwiseProduct(counted.by_noise.slope);
  const PriorRows prior = prior_of(problem, at, rho);
  UnknownLaw law;
  law.residual_power = counted.residual_power;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(slope.size());
  double weight = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double weight_before = weight;
    weight = share * counted.misfit_cost.slope(std::max(0.0, law.residual_power - counted.floor));
    if (round > 0 && std::fabs(weight - weight_before) <= kSameWeight * weight) break;
    Eigen::MatrixXd curvature = weight * gram;
    curvature.diagonal() += prior.slope.cwiseProduct(prior.slope);
    step = curvature.ldlt().solve(-(weight * slope + prior.value.cwiseProduct(prior.slope)));
    const double change = share * (2.0 * slope.dot(step) + step.dot(gram * step));
    law.residual_power = counted.residual_power + (counted.may_leave_less ? change : std::max(0.0, change));
  }
  law.prior = counted.prior_besides + prior_cost(problem, at.point) + at.coefficients.squaredNorm() / rho + (prior.value + prior.slope.cwiseProduct(step)).squaredNorm() - prior.value.squaredNorm();
  return law;
}

// The law for every rho. `plain_gram` are the columns' products with the nominal machine's noise, by which information is told.
std::vector<UnknownLaw> for_every_scale(const Problem& problem, const FittedLaw& at, const Eigen::MatrixXd& plain_gram, const Counted& counted) {
  std::vector<UnknownLaw> laws;
  for (const double rho : SmoothTorques::scales()) {
    UnknownLaw& law = laws.emplace_back(for_scale(problem, at, rho, counted));
    const Eigen::VectorXd scale = scale_of(at, rho);
    law.information = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * plain_gram * scale.asDiagonal(), Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0.0);
  }
  return laws;
}

// For which rho a law promises most, by what evidence.h makes of a hypothesis, and how much: -2 ln of its density.
struct Promise {
  double rho = 0.0;
  double cost = std::numeric_limits<double>::infinity();
};
Promise best_of(const Problem& problem, const FittedLaw& at, const EvidenceSettings& evidence, const Counted& counted) {
  Promise best;
  for (const double rho : SmoothTorques::scales()) {
    const UnknownLaw law = for_scale(problem, at, rho, counted);
    const double above = law.residual_power - counted.floor, left = std::max(0.0, above), weight = evidence.independent_share * counted.misfit_cost.law_slope(left);
    const double misfit = above > 0.0 ? counted.misfit_cost(above) : counted.misfit_cost.slope(0.0) * above;  // below the floor of the known ones, which it may lower
    const Eigen::VectorXd scale = scale_of(at, rho);
    Eigen::MatrixXd told = weight * (scale.asDiagonal() * counted.by_noise.gram * scale.asDiagonal());
    told.diagonal().array() += 1.0;
    const double cost = misfit + law.prior + 2.0 * Eigen::LLT<Eigen::MatrixXd>(told).matrixLLT().diagonal().array().log().sum();  // ln of its determinant
    if (cost < best.cost) best = {rho, cost};
  }
  return best;
}

}  // namespace

UnknownLaws unknown_laws(Problem& problem, const FitResult& fit, double residual_power, const SmoothTorques& smooth, const std::vector<Discrepancy>& discrepancies, const EvidenceSettings& evidence,
                         const MisfitCost& misfit_cost, double floor, double least_cost, const FittedLaw* elsewhere) {
  UnknownLaws laws;
  const double prior_besides = fit.prior - prior_cost(problem, fit.point), share = problem.settings.independent_share;
  std::optional<double> square_before;
  for (const Discrepancy& discrepancy : discrepancies) {
    if (discrepancy.curves.empty() || discrepancy.evidence <= 0.0) continue;
    // Which of the variable's functions, and how large it may be, by the columns; that one is fitted.
    Promise least;
    FittedLaw law;
    for (SmoothFunction& function : smooth.functions_of(discrepancy.variable)) {
      const Eigen::MatrixXd columns = smooth.columns(problem, function);
      FittedLaw begun{std::move(function), 0.0, fit.point, Eigen::VectorXd::Zero(columns.cols()), fit.difference, Eigen::MatrixXd(fit.difference.size(), fit.columns.cols() + columns.cols())};
      begun.columns << fit.columns, columns;
      const ByOwnNoise plain = by_nominal_noise(begun);
      const Promise promise = best_of(problem, begun, evidence, {plain, residual_power, true, prior_besides, misfit_cost, floor});
      if (promise.cost >= least.cost) continue;
      least = promise;
      law = std::move(begun);
      law.rho = promise.rho;
    }
    if (law.function.blocks.empty()) continue;  // none has a finite promise
    settle(problem, smooth, law, least_cost + kNear);
    if (elsewhere != nullptr && elsewhere->function.variable == discrepancy.variable && fit.point.effects.empty()) {
      FittedLaw other = alone(problem, smooth, *elsewhere);
      settle(problem, smooth, other, std::min(least_cost, cost_of(problem, law)) + kNear);
      if (cost_of(problem, other) < cost_of(problem, law)) law = std::move(other);
    }
    const double cost = cost_of(problem, law);
    least_cost = std::min(least_cost, cost);
    if (!square_before) square_before = by_own_noise(problem, fit.point, fit.difference, Eigen::MatrixXd(), evidence.discrepancy_count).square;
    const ByOwnNoise by_noise = by_own_noise(problem, law.point, law.difference, law.columns, evidence.discrepancy_count);
    for (UnknownLaw& one : for_every_scale(problem, law, by_nominal_noise(law).gram, {by_noise, residual_power + share * (by_noise.square - *square_before), false, prior_besides, misfit_cost, floor})) {
      one.variable = discrepancy.variable;
      laws.of_every_size.push_back(std::move(one));
    }
    if (cost >= laws.least_cost) continue;
    laws.least_cost = cost;
    laws.best = std::move(law);
  }
  return laws;
}

}  // namespace slewlab::diagnosis
