#include "diagnosis/fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "diagnosis/column_directions.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNuisanceStep = 0.3;  // [standard deviations] difference quotient: small against the prior
constexpr double kFarthest = 6.0;      // [standard deviations] that a nuisance is let go
constexpr std::array<double, 4> kDampings{0.0, 0.1, 1.0, 10.0};  // of a step: the next where the one before did not make the cost fall
constexpr int kRelaxations = 8;
constexpr double kFirstDamping = 1e-3;  // of a descent along a valley, chosen
constexpr int kIdleRounds = 2;         // in a row, that end a fit of the nuisances alone, and behind which no fit is gone on with
constexpr std::array<double, 4> kShortenings{0.0, 1.0, 3.0, 7.0};  // dampings that halve a step along an axis of the curvature, and again
constexpr double kEffectStep = 0.05;   // [standard deviations] the same for effects, around a fitted size
constexpr double kSpellStep = 0.05;    // of the time in which a spell fades: its beginning and end are as sharp as that
constexpr double kStepDeviations = 2.0;  // the step where it is known how well the records tell the parameter, in what they leave open
constexpr double kMuchTooLong = 0.3;     // open over step, below which a column is taken again
constexpr int kMostLooks = 4;
// Share of the first step: large against what contacts and rounding make of a change; an order of a ripple that turns hundreds of times asks for less.
constexpr double kSmallestNuisanceStep = 0.2, kSmallestEffectStep = 1e-3;
constexpr double kFiner = 0.1;  // of the steps, where a descent by them promised much and led nowhere
constexpr double kDirectionDeviations = 1.0;  // that the records leave open along a direction: how far its quotient goes
constexpr int kMostFailures = 3;  // in a row, behind which columns that have led on are taken anew

}  // namespace

Point moved(const common::EffectCatalogue& catalogue, const Point& point, const Eigen::VectorXd& change) {
  Point result = point;
  const auto nuisances = static_cast<Eigen::Index>(point.nuisance.size());
  for (Eigen::Index i = 0; i < nuisances; ++i) {
    double& z = result.nuisance[static_cast<std::size_t>(i)];
    z = std::clamp(z + change(i), -kFarthest, kFarthest);
  }
  result.effects = effects_moved(catalogue, point.effects, change.tail(change.size() - nuisances));
  return result;
}

// In coordinates, of effects as effects_step() has it.
Eigen::VectorXd step_between(const common::EffectCatalogue& catalogue, const Point& from, const Point& to) {
  const auto nuisances = static_cast<Eigen::Index>(from.nuisance.size());
  const auto nuisance = [&](const Point& point) { return Eigen::Map<const Eigen::VectorXd>(point.nuisance.data(), nuisances); };
  const Eigen::VectorXd of_effects = effects_step(catalogue, from.effects, to.effects);
  Eigen::VectorXd step(nuisances + of_effects.size());
  step << nuisance(to) - nuisance(from), of_effects;
  return step;
}

Eigen::MatrixXd gram_of(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

double prior_cost(const Problem& problem, const Point& point) {
  double cost = 0.0;
  for (std::size_t k = 0; k < point.nuisance.size(); ++k) cost += nuisance_prior(problem.nuisances, k, point.nuisance[k]).cost;
  for (const double x : effect_coordinates(problem.catalogue, point.effects)) cost += effect_prior(x).cost;
  return cost;
}

namespace {

double cost_of(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, double law_freedom) {
  return discounted(residual_power(difference, problem.settings), law_freedom) + prior_cost(problem, point);
}
double cost_of(const Problem& problem, const Point& point, const Eigen::VectorXd& difference) {
  return cost_of(problem, point, difference, problem.settings.law_freedom);
}

// What a squared difference counts where misfits are discounted with so many degrees of freedom.
double weight_of(const Problem& problem, const Eigen::VectorXd& difference, double law_freedom) {
  return problem.settings.independent_share * discounted_weight(residual_power(difference, problem.settings), law_freedom);
}

// The cost's, for Gauss-Newton steps.
Eigen::MatrixXd curvature(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::MatrixXd& gram, double law_freedom) {
  Eigen::MatrixXd system = weight_of(problem, difference, law_freedom) * gram;
  system.diagonal().array() += prior_rows(problem, point).slope.array().square();
  return system;
}

Eigen::VectorXd information_of(const Eigen::MatrixXd& columns) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram_of(columns), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseMax(0.0);
}

// Whether an effect at the point stands for nuisance `k`.
bool is_held(const Problem& problem, const Point& point, std::size_t k) {
  return std::any_of(point.effects.begin(), point.effects.end(),
                     [&](const common::EffectInstance& effect) { return is_said_by(problem.nuisances, problem.catalogue.at(effect.name), k); });
}

Eigen::VectorXd first_steps(const common::EffectCatalogue& catalogue, const Point& point) {
  const auto nuisances = static_cast<Eigen::Index>(point.nuisance.size());
  Eigen::VectorXd steps = Eigen::VectorXd::Constant(nuisances + effect_coordinates(catalogue, point.effects).size(), kEffectStep);
  steps.head(nuisances).setConstant(kNuisanceStep);
  Eigen::Index first = nuisances;
  for (const common::EffectInstance& effect : point.effects) {
    const common::EffectAbout& about = catalogue.at(effect.name);
    if (about.spell) {
      const double step = kSpellStep * effect.values[index_of(about, about.spell->fade)];
      for (const std::size_t p : {index_of(about, about.spell->begin), index_of(about, about.spell->duration)}) {
        steps(first + static_cast<Eigen::Index>(p)) = step / value_per_deviation(about.parameters[p], effect.values[p]);
      }
    }
    first += static_cast<Eigen::Index>(effect.values.size());
  }
  return steps;
}

// Of what the records and the priors leave open, in coordinates.
Eigen::MatrixXd covariance(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns) {
  const Eigen::MatrixXd system = curvature(problem, point, difference, gram_of(columns), problem.settings.law_freedom);
  return system.ldlt().solve(Eigen::MatrixXd::Identity(system.rows(), system.cols()));
}

}  // namespace

Eigen::MatrixXd covariance(const Problem& problem, const FitResult& result) {
  return covariance(problem, result.point, result.difference, result.columns);
}

namespace {

// Whether coordinate `i` is where a motor stands at the beginning of a record on a machine that has moved: moved as far as a parameter is, it leaves
// the flank on which it runs, and the column is that of a machine that strikes.
bool is_place_in_motion(const Nuisances& nuisances, std::size_t i, std::size_t nuisance_count) {
  const std::size_t common = nuisances.common_count(), own = nuisances.per_record();
  if (i < common || i >= nuisance_count || own == 0) return false;
  const std::size_t part = (i - common) % own;
  return part >= nuisances.swing_amounts() && part < nuisances.swing_amounts() + nuisances.offset_groups && nuisances.begin_of((i - common) / own) != RecordBegins::unmoved;
}

// Steps of difference quotients where columns are known: no longer than what the records leave open, or a law's curvature is
// taken for its slope.
Eigen::VectorXd steps_at(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns) {
  const Eigen::VectorXd variance = covariance(problem, point, difference, columns).diagonal();
  Eigen::VectorXd steps = first_steps(problem.catalogue, point);
  for (Eigen::Index i = 0; i < steps.size(); ++i) {
    const double open = kStepDeviations * std::sqrt(variance(i));
    const double smallest = i < static_cast<Eigen::Index>(point.nuisance.size()) ? kSmallestNuisanceStep : kSmallestEffectStep;
    if (std::isfinite(open)) steps(i) *= std::clamp(open / steps(i), smallest, 1.0);
    if (is_place_in_motion(problem.nuisances, static_cast<std::size_t>(i), point.nuisance.size())) steps(i) *= kFiner;
  }
  return steps;
}

using Moves = std::vector<std::vector<std::size_t>>;  // nuisances that are moved together

// Of what the records' beginnings are like and some machine at the point knows of: a record's own change no other record, so each of them goes with its likes.
Moves moves_of_beginnings(const Problem& problem, const Point& point) {
  const std::size_t common = problem.nuisances.common_count(), own = problem.nuisances.per_record(), all = nuisance_count(problem);
  const bool swings_outwards = std::any_of(point.effects.begin(), point.effects.end(),
                                           [&](const common::EffectInstance& effect) { return problem.catalogue.at(effect.name).swings_outwards; });
  Moves moves;
  for (std::size_t part = 0; part < own; ++part) {
    if (problem.nuisances.is_outward(part) && !swings_outwards) continue;
    std::vector<std::size_t>& move = moves.emplace_back();
    for (std::size_t k = common + part; k < all; k += own) move.push_back(k);
  }
  return moves;
}

// The columns d difference / d z of some nuisances where it stands.
void renew_columns(Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::VectorXd& steps, const Moves& moves, Eigen::MatrixXd& columns) {
  const std::size_t common = problem.nuisances.common_count(), own = problem.nuisances.per_record();
  std::vector<Point> points(moves.size(), point);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    for (const std::size_t k : moves[i]) points[i].nuisance[k] += steps(static_cast<Eigen::Index>(k));
  }
  const std::vector<Eigen::VectorXd> changed = changes(problem, column_base(problem, point, difference), points);
  const std::vector<Eigen::Index> first_row = first_rows(problem);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    for (const std::size_t k : moves[i]) {
      const bool is_of_all = k < common;
      const std::size_t record = is_of_all ? 0 : (k - common) / own;
      const Eigen::Index from = first_row[record], to = is_of_all ? first_row.back() : first_row[record + 1];
      const auto column = static_cast<Eigen::Index>(k);
      columns.col(column).setZero();
      columns.col(column).segment(from, to - from) = changed[i].segment(from, to - from) / steps(column);
    }
  }
}

// Of all of them; of nuisances that an effect holds, and of beginnings that no machine at the point knows of: zero.
void renew_nuisance_columns(Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::VectorXd& steps, Eigen::MatrixXd& columns) {
  Moves moves;
  for (std::size_t k = 0; k < problem.nuisances.common_count(); ++k) {
    if (is_held(problem, point, k)) columns.col(static_cast<Eigen::Index>(k)).setZero();
    else moves.push_back({k});
  }
  const auto common = static_cast<Eigen::Index>(problem.nuisances.common_count());
  columns.middleCols(common, static_cast<Eigen::Index>(nuisance_count(problem)) - common).setZero();
  const Moves beginnings = moves_of_beginnings(problem, point);
  moves.insert(moves.end(), beginnings.begin(), beginnings.end());
  renew_columns(problem, point, difference, steps, moves, columns);
}

// Those of all records that are free at the point, and of each record's own those that some machine at the point knows of.
CoordinateBlocks free_nuisances(const Problem& problem, const Point& point) {
  CoordinateBlocks blocks;
  for (std::size_t k = 0; k < problem.nuisances.common_count(); ++k) {
    if (!is_held(problem, point, k)) blocks.common.push_back(static_cast<Eigen::Index>(k));
  }
  for (const std::vector<std::size_t>& move : moves_of_beginnings(problem, point)) {
    blocks.own.resize(move.size());
    for (std::size_t r = 0; r < move.size(); ++r) blocks.own[r].push_back(static_cast<Eigen::Index>(move[r]));
  }
  return blocks;
}

// The columns of free nuisances along the axes of what the records leave open.
void renew_columns_along_axes(Problem& problem, const Point& point, const Eigen::VectorXd& difference, Eigen::MatrixXd& columns) {
  const auto nuisances = static_cast<Eigen::Index>(point.nuisance.size());
  const CoordinateBlocks blocks = free_nuisances(problem, point);
  std::vector<bool> is_free(point.nuisance.size(), false);
  const auto are_free = [&](const std::vector<Eigen::Index>& some) {
    for (const Eigen::Index k : some) is_free[static_cast<std::size_t>(k)] = true;
  };
  are_free(blocks.common);
  for (const std::vector<Eigen::Index>& own : blocks.own) are_free(own);
  for (Eigen::Index k = 0; k < nuisances; ++k) {
    if (!is_free[static_cast<std::size_t>(k)]) columns.col(k).setZero();
  }
  Eigen::VectorXd longest = Eigen::VectorXd::Constant(nuisances, kNuisanceStep);
  for (Eigen::Index i = 0; i < nuisances; ++i) {
    if (is_place_in_motion(problem.nuisances, static_cast<std::size_t>(i), point.nuisance.size())) longest(i) *= kFiner;
  }
  const Eigen::MatrixXd curvature_here = curvature(problem, point, difference, gram_of(columns), problem.settings.law_freedom).topLeftCorner(nuisances, nuisances);
  const ColumnDirections directions = column_directions(curvature_here, blocks, longest, kDirectionDeviations);
  std::vector<Point> points;
  const auto move_along = [&](const Eigen::MatrixXd& changes_of_point) {
    for (Eigen::Index i = 0; i < changes_of_point.cols(); ++i) {
      Point& moved = points.emplace_back(point);
      for (Eigen::Index k = 0; k < nuisances; ++k) moved.nuisance[static_cast<std::size_t>(k)] += changes_of_point(k, i);
    }
  };
  move_along(directions.own);
  move_along(directions.common);
  columns_along(directions, blocks, changes(problem, column_base(problem, point, difference), points), first_rows(problem), columns);
}

// Nuisances that an effect holds go back to the nominal machine, and what they were becomes the effect's.
void hand_over(const Problem& problem, Point& point) {
  const std::vector<sim::Parameter>& parameters = problem.nuisances.parameters;
  for (common::EffectInstance& effect : point.effects) {
    const common::EffectAbout& about = problem.catalogue.at(effect.name);
    bool is_first = true;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (!is_said_by(problem.nuisances, about, k)) continue;
      const common::EffectParameter& factor = about.parameters[common::kSize];
      if (is_first) {
        double& size = effect.values[common::kSize];
        size = std::clamp(size * (1.0 + parameters[k].spread * point.nuisance[k]), factor.lower,
                                      factor.upper);
      }
      is_first = false;
      point.nuisance[k] = 0.0;
    }
  }
}

// The columns d difference / d x of some of the effects' parameters, by difference quotients.
void take_effect_columns(Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::VectorXd& asked,
                         const std::vector<Eigen::Index>& parameters, Eigen::MatrixXd& columns) {
  std::vector<Point> points;
  std::vector<double> steps;
  for (const Eigen::Index i : parameters) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(asked.size());
    change(i) = asked(i);
    points.push_back(moved(problem.catalogue, point, change));
    steps.push_back(step_between(problem.catalogue, point, points.back())(i));
    if (std::fabs(steps.back()) < 0.5 * asked(i)) {  // at its upper bound: look the other way
      points.back() = moved(problem.catalogue, point, -change);
      steps.back() = step_between(problem.catalogue, point, points.back())(i);
    }
  }
  const std::vector<Eigen::VectorXd> moved_differences = differences(problem, points);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    auto column = columns.col(parameters[k]);
    column.setZero();
    if (steps[k] != 0.0) column = (moved_differences[k] - difference) / steps[k];
  }
}

// All of them. What the records leave open of a parameter is known when its column is: one whose step turns out to be much longer, as that of
// a ripple's order, by which angles of hundreds of turns are multiplied, is taken again.
void take_effect_columns(Problem& problem, const Point& point, const Eigen::VectorXd& difference, Eigen::VectorXd steps, Eigen::MatrixXd& columns) {
  const auto nuisance_count = static_cast<Eigen::Index>(point.nuisance.size());
  std::vector<Eigen::Index> parameters;
  for (Eigen::Index i = nuisance_count; i < steps.size(); ++i) parameters.push_back(i);
  for (int looks = 1; !parameters.empty(); ++looks) {
    take_effect_columns(problem, point, difference, steps, parameters, columns);
    if (looks == kMostLooks) return;
    const Eigen::VectorXd open = steps_at(problem, point, difference, columns);
    std::erase_if(parameters, [&](Eigen::Index i) { return open(i) > kMuchTooLong * steps(i); });
    for (const Eigen::Index i : parameters) steps(i) = open(i);
  }
}

// Products of columns of which the effects' turn so.
Eigen::MatrixXd turned(Eigen::MatrixXd gram, const Eigen::MatrixXd& effect_axes) {
  gram.rightCols(effect_axes.cols()) *= effect_axes;
  gram.bottomRows(effect_axes.rows()) = (effect_axes.transpose() * gram.bottomRows(effect_axes.rows())).eval();
  return gram;
}

// Steps from where `result` stands with its columns, corrected after each step by what it showed (Broyden 1965), also after one that was
// too bold.
Descent descend(Problem& problem, FitResult& result, double law_freedom, const std::function<Descent(const Descending&)>& by) {
  Point trial;
  Eigen::VectorXd trial_difference;
  double trial_cost = 0.0;
  Eigen::MatrixXd gram = gram_of(result.columns);
  Descending problem_here;
  problem_here.model = [&]() -> LocalModel {
    const PriorRows prior = prior_rows(problem, result.point);
    const double weight = weight_of(problem, result.difference, law_freedom);
    return {curvature(problem, result.point, result.difference, gram, law_freedom),
            weight * result.columns.transpose() * result.difference + prior.value.cwiseProduct(prior.slope)};
  };
  problem_here.attempt = [&](const Eigen::VectorXd& asked) -> std::optional<double> {
    trial = moved(problem.catalogue, result.point, asked);
    const Eigen::VectorXd step = step_between(problem.catalogue, result.point, trial);
    const double length = step.squaredNorm();
    if (length == 0.0) return std::nullopt;
    trial_difference = differences(problem, trial);
    trial_cost = cost_of(problem, trial, trial_difference, law_freedom);
    const Eigen::VectorXd missed = (trial_difference - result.difference - result.columns * step) / length;
    const Eigen::VectorXd along = result.columns.transpose() * missed;
    gram += along * step.transpose() + step * along.transpose() + missed.squaredNorm() * step * step.transpose();
    result.columns += missed * step.transpose();
    return trial_cost;
  };
  problem_here.accept = [&] {
    const Eigen::MatrixXd axes = step_axes(problem.catalogue, result.point.effects, trial.effects);
    result.columns.rightCols(axes.cols()) *= axes;
    gram = turned(std::move(gram), axes);
    result.point = trial;
    result.difference = trial_difference;
    result.cost = trial_cost;
  };
  const Descent descent = by(problem_here);
  result.ending = descent.ending;
  return descent;
}

// By a few dampings, far apart.
Descent descend(Problem& problem, FitResult& result, double law_freedom) {
  const FitSettings& settings = problem.settings;
  return descend(problem, result, law_freedom, [&](const Descending& here) { return descend(here, result.cost, {settings.iterations, kDampings, settings.enough, settings.enough_share}); });
}

// By a damping that adapts.
void descend_along(Problem& problem, FitResult& result, double& damping) {
  const FitSettings& settings = problem.settings;
  descend(problem, result, settings.law_freedom, [&](const Descending& here) { return descend(here, result.cost, AdaptingSettings{settings.attempts, kMostFailures, settings.enough}, damping); });
}

}  // namespace

double mean_square(const Eigen::VectorXd& difference) {
  return difference.squaredNorm() / static_cast<double>(difference.size());
}

double residual_power(const Eigen::VectorXd& difference, const FitSettings& settings) {
  return settings.independent_share * (difference.squaredNorm() - static_cast<double>(difference.size()));
}

double discounted(double residual_power, double law_freedom) {
  return residual_power > 0.0 ? law_freedom * std::log1p(residual_power / law_freedom) : residual_power;
}

double discounted_weight(double residual_power, double law_freedom) {
  return residual_power > 0.0 ? 1.0 / (1.0 + residual_power / law_freedom) : 1.0;
}

PriorRows prior_rows(const Problem& problem, const Point& point) {
  std::vector<PriorTerm> terms;
  for (std::size_t k = 0; k < point.nuisance.size(); ++k) terms.push_back(nuisance_prior(problem.nuisances, k, point.nuisance[k]));
  for (const double x : effect_coordinates(problem.catalogue, point.effects)) terms.push_back(effect_prior(x));
  const auto count = static_cast<Eigen::Index>(terms.size());
  PriorRows rows{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const PriorTerm& term = terms[static_cast<std::size_t>(i)];
    rows.slope(i) = std::sqrt(term.curvature);
    rows.value(i) = term.slope / rows.slope(i);
  }
  return rows;
}

double data_weight(const Eigen::VectorXd& difference, const FitSettings& settings) {
  return settings.independent_share * discounted_weight(residual_power(difference, settings), settings.law_freedom);
}

namespace {

bool improve(Problem& problem, FitResult& result, bool fresh_nuisances, double law_freedom) {
  Eigen::VectorXd steps = steps_at(problem, result.point, result.difference, result.columns);
  const auto take_columns = [&] {
    if (fresh_nuisances) renew_nuisance_columns(problem, result.point, result.difference, steps, result.columns);
    take_effect_columns(problem, result.point, result.difference, steps, result.columns);
  };
  const auto worth = [&] { return problem.settings.settled + problem.settings.settled_share * std::max(0.0, result.cost); };
  const double first_cost = result.cost;
  take_columns();
  const Descent descent = descend(problem, result, law_freedom);
  // Difference quotients over steps that are long against what quiet sensors leave open lead nowhere.
  if (fresh_nuisances && descent.ending == Ending::no_descent && first_cost - result.cost <= worth() && descent.promised > worth()) {
    steps *= kFiner;
    take_columns();
    descend(problem, result, law_freedom);
  }
  const bool was_worth_it = first_cost - result.cost > worth();
  if (was_worth_it) result.idle_rounds = 0;
  else if (fresh_nuisances) ++result.idle_rounds;
  return was_worth_it;
}

// A round that was worth little may have stood in a narrow valley of two parameters, along which the next one goes on with fresh columns.
void improve_until_idle(Problem& problem, FitResult& result, int rounds, double law_freedom) {
  for (int round = 0, idle = 0; round < rounds && idle < kIdleRounds; ++round) {
    idle = improve(problem, result, true, law_freedom) ? 0 : idle + 1;
  }
}

}  // namespace

FitResult fit_at(Problem& problem, Point point) {
  FitResult result;
  result.difference = differences(problem, point);
  result.mean_square = mean_square(result.difference);
  result.point = std::move(point);
  return result;
}

FitResult nominal_fit(Problem& problem) {
  Point nominal;
  nominal.nuisance.assign(nuisance_count(problem), 0.0);
  return fit_at(problem, std::move(nominal));
}

void begin_anew(const Problem& problem, FitResult& result) {
  result.columns = Eigen::MatrixXd::Zero(result.difference.size(), static_cast<Eigen::Index>(result.point.nuisance.size()) + effect_coordinates(problem.catalogue, result.point.effects).size());
  result.cost = cost_of(problem, result.point, result.difference);
}

void fit_beginnings(Problem& problem, FitResult& result) {
  begin_anew(problem, result);
  const Moves moves = moves_of_beginnings(problem, result.point);
  for (int round = 0; round < problem.settings.rounds; ++round) {
    const double before = result.cost;
    // Boom and load answer linearly to how they begin until teeth leave their flank, which a motor does that is moved as far as a parameter is.
    Eigen::VectorXd steps = steps_at(problem, result.point, result.difference, result.columns);
    for (Eigen::Index i = 0; i < steps.size(); ++i) {
      if (!is_place_in_motion(problem.nuisances, static_cast<std::size_t>(i), result.point.nuisance.size())) steps(i) *= kFiner;
    }
    renew_columns(problem, result.point, result.difference, steps, moves, result.columns);
    descend(problem, result, problem.settings.law_freedom);
    if (before - result.cost <= problem.settings.settled) break;
  }
  result.mean_square = mean_square(result.difference);
}

FitResult fit(Problem& problem, const Eigen::MatrixXd& nuisance_columns, const Point& start) {
  Point begun = start;
  hand_over(problem, begun);
  FitResult result = fit_at(problem, std::move(begun));
  result.cost = cost_of(problem, result.point, result.difference);
  const auto effect_count = effect_coordinates(problem.catalogue, start.effects).size();
  result.columns.resize(result.difference.size(), nuisance_columns.cols() + effect_count);
  result.columns.leftCols(nuisance_columns.cols()) = nuisance_columns;
  result.columns.rightCols(effect_count).setZero();  // nothing is known of them: the first steps
  for (std::size_t k = 0; k < result.point.nuisance.size(); ++k) {
    if (is_held(problem, result.point, k)) result.columns.col(static_cast<Eigen::Index>(k)).setZero();
  }
  improve(problem, result, false);
  return result;
}

FitResult fit_from(Problem& problem, Point start, int rounds) {
  FitResult result = fit_at(problem, std::move(start));
  begin_anew(problem, result);
  settle(problem, result, rounds);
  return result;
}

FitResult fit_again(Problem& problem, const FitResult& fitted) {
  return fit(problem, fitted.columns.leftCols(static_cast<Eigen::Index>(fitted.point.nuisance.size())), fitted.point);
}

void renew_columns(Problem& problem, FitResult& result) {
  const Eigen::VectorXd steps = steps_at(problem, result.point, result.difference, result.columns);
  renew_nuisance_columns(problem, result.point, result.difference, steps, result.columns);
  take_effect_columns(problem, result.point, result.difference, steps, result.columns);
}

void take_nuisance_columns(const Problem& problem, const Eigen::MatrixXd& columns, FitResult& result) {
  for (std::size_t k = 0; k < result.point.nuisance.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    if (!is_held(problem, result.point, k) && !columns.col(column).isZero(0.0)) result.columns.col(column) = columns.col(column);
  }
}

bool improve(Problem& problem, FitResult& result, bool fresh_nuisances) {
  return improve(problem, result, fresh_nuisances, problem.settings.law_freedom);
}

void settle_from_afar(Problem& problem, FitResult& result, double times, int rounds) {
  const double law_freedom = times * problem.settings.independent_share * static_cast<double>(result.difference.size());
  if (law_freedom <= problem.settings.law_freedom) return;
  result.cost = cost_of(problem, result.point, result.difference, law_freedom);
  improve_until_idle(problem, result, rounds, law_freedom);
  result.cost = cost_of(problem, result.point, result.difference);
  result.idle_rounds = 0;
}

void settle_until_idle(Problem& problem, FitResult& result) { improve_until_idle(problem, result, problem.settings.rounds, problem.settings.law_freedom); }

bool would_come_down(double from, double to, int rounds, double reach) { return to - rounds * (from - to) <= reach; }

void settle(Problem& problem, FitResult& result, int rounds, double reach) {
  for (int left = rounds; left > 0 && result.idle_rounds < kIdleRounds; --left) {
    const double before = result.cost;
    if (!improve(problem, result, true) || !would_come_down(before, result.cost, left - 1, reach)) return;
  }
}

void settle_to_the_floor(Problem& problem, FitResult& result, int rounds, double reach) {
  constexpr double kFloor = 0.3;  // fall of the cost by a round, chosen: little beside what two causes must differ by for one of them to be twice as likely
  if (result.columns.size() == 0) begin_anew(problem, result);
  double damping = kFirstDamping;
  for (int left = rounds; left > 0; --left) {
    const double before = result.cost;
    const Eigen::VectorXd steps = steps_at(problem, result.point, result.difference, result.columns);
    const bool is_first_look = result.columns.leftCols(static_cast<Eigen::Index>(nuisance_count(problem))).isZero(0.0);
    if (is_first_look) renew_nuisance_columns(problem, result.point, result.difference, steps, result.columns);
    else renew_columns_along_axes(problem, result.point, result.difference, result.columns);
    take_effect_columns(problem, result.point, result.difference, steps, result.columns);
    descend_along(problem, result, damping);
    if (is_first_look) continue;  // over steps that are long
    if (before - result.cost <= kFloor || !would_come_down(before, result.cost, left - 1, reach)) break;
  }
}

Relaxed relax(const Problem& problem, const FitResult& result, const PowerAbout& power, const MisfitCost& misfit_cost, double floor) {
  if (power.gram.size() == 0) return {power.residual_power, result.prior};
  const double share = problem.settings.independent_share;
  // The columns of a fit that has not settled promise what is not there: the residual power falls no lower than where it stands.
  const auto residual_power_at = [&](const Eigen::VectorXd& step) {
    return power.residual_power + std::max(0.0, share * (2.0 * power.slope.dot(step) + step.dot(power.gram * step)));
  };
  const auto cost_at = [&](const Relaxed& relaxed) {
    return misfit_cost(std::max(0.0, relaxed.residual_power - floor)) + relaxed.prior;
  };
  Relaxed best{power.residual_power, result.prior};
  const double besides = result.prior - prior_cost(problem, result.point);  // what does not go with where the parameters stand
  Point point = result.point, trial;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(power.gram.cols()), trial_step;
  Relaxed relaxed;
  Descending problem_here;
  problem_here.model = [&]() -> LocalModel {
    const double weight = share * misfit_cost.slope(std::max(0.0, best.residual_power - floor));
    const PriorRows prior = prior_rows(problem, point);
    const Eigen::MatrixXd axes = step_axes(problem.catalogue, result.point.effects, point.effects);
    Eigen::VectorXd slope_here = power.slope + power.gram * step;
    slope_here.tail(axes.rows()) = (axes.transpose() * slope_here.tail(axes.rows())).eval();
    LocalModel model{weight * turned(power.gram, axes), weight * slope_here + prior.value.cwiseProduct(prior.slope)};
    model.curvature.diagonal() += prior.slope.cwiseProduct(prior.slope);
    return model;
  };
  problem_here.attempt = [&](const Eigen::VectorXd& change) -> std::optional<double> {
    trial = moved(problem.catalogue, point, change);
    trial_step = step_between(problem.catalogue, result.point, trial);
    relaxed = {residual_power_at(trial_step), prior_cost(problem, trial) + besides};
    return cost_at(relaxed);
  };
  problem_here.accept = [&] {
    best = relaxed;
    point = trial;
    step = trial_step;
  };
  descend(problem_here, cost_at(best), {kRelaxations, kShortenings, 0.0, 0.0});
  return best;
}

void conclude(const Problem& problem, FitResult& result) {
  result.mean_square = mean_square(result.difference);
  result.residual_power = residual_power(result.difference, problem.settings);
  result.prior = prior_cost(problem, result.point);
  result.information = information_of(result.columns);
  const Eigen::VectorXd variance = covariance(problem, result.point, result.difference, result.columns).diagonal();
  auto e = static_cast<Eigen::Index>(result.point.nuisance.size());
  result.nuisance_deviation.clear();
  for (Eigen::Index k = 0; k < e; ++k) result.nuisance_deviation.push_back(std::sqrt(variance(k)));
  result.deviation.clear();
  for (const common::EffectInstance& effect : result.point.effects) {
    const common::EffectAbout& about = problem.catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++e) {
      const common::EffectParameter& parameter = about.parameters[p];
      result.deviation.push_back(std::fabs(value_per_deviation(parameter, effect.values[p])) *
                                 std::sqrt(variance(e)));
    }
  }
}

}  // namespace slewlab::diagnosis
