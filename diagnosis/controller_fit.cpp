#include "diagnosis/controller_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "controller/effects/catalogue.h"
#include "diagnosis/fit.h"
#include "diagnosis/least_squares.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kIterations = 12;
constexpr double kStep = 0.02;  // [standard deviations of the prior] difference quotient
constexpr std::array<double, 7> kDampings{0.0, 1e-3, 0.02, 0.4, 8.0, 160.0, 3200.0};
constexpr double kEnoughShare = 1e-3;      // fall of the sum of squares that is too small to go on
constexpr double kLeastCurvature = 1e-12;  // of the largest one: of parameters that change nothing
// Strides of the starts, and how far they go, in standard deviations: of an effect's size from where it is absent, and of its other
// parameters from their typical values. A ramp that turns more than a twentieth too early is not found by any descent.
struct Grid {
  double size_stride, other_stride;
};
constexpr Grid kFine{0.25, 0.5}, kCoarse{1.0, 1.5};
constexpr double kSizeReach = 4.0, kOtherReach = 3.0;
constexpr std::size_t kStartsToGoOn = 3;
constexpr double kRounding = 1e-9;  // share of a sum of squares by which another order of its additions may change it, and far more
constexpr double kFirstStride = 0.1, kLastStride = 1e-4;  // [standard deviations] of the search without slopes
constexpr double kExact = 1e-9;         // residual, as a share of the difference, below which nothing more is searched
constexpr int kSinglesToPair = 3;
// Residual that the right effect may have, as a share of the difference, where the real law differs from the catalogue's.
constexpr double kUsualShareLeft = 1e-3;
constexpr double kIndependent = 60.0;  // independent differences that the replay is worth
constexpr double kPairPrior = 0.1;     // of two effects, against one

using Effects = std::vector<common::EffectInstance>;

// Of the changes over `change_time` [s]; of the torques themselves where that is 0. `known_from` [s] of each record. Nothing where the sum of
// their squares is above `most`: of such a replay nobody asks more, and most of them are so within a part of the record.
std::optional<Eigen::VectorXd> torque_differences(std::span<const Record> records, const std::vector<std::optional<double>>& known_from,
                                                  const controller::ControllerSettings& settings, double change_time, double most) {
  std::vector<double> all;
  double left = (1.0 + kRounding) * most;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    // The groups' values stand in turns.
    const std::size_t lag =
        static_cast<std::size_t>(record.group_count) * static_cast<std::size_t>(std::lround(change_time / record.encoder_period));
    const ControllerReplay replay = replay_controller(record, settings, known_from[r], {lag, left});
    if (replay.is_given_up) return std::nullopt;
    left -= replay.change_square;
    const std::vector<double>& difference = replay.difference;
    for (std::size_t n = lag; n < difference.size(); ++n) all.push_back(difference[n] - (lag > 0 ? difference[n - lag] : 0.0));
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

// A quarter of the shortest of the controller's own times.
double change_time_of(const controller::ControllerSettings& controller) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const double time : {controller.speed_control.integral_time, controller.ramp.acceleration_time, controller.ramp.deceleration_time}) {
    if (time > 0.0) shortest = std::min(shortest, time);
  }
  return std::isfinite(shortest) ? 0.25 * shortest : 0.0;
}

// What the fits of one controller share.
struct Replays {
  std::span<const Record> records;
  const controller::ControllerSettings& nominal;
  const common::EffectCatalogue& catalogue;  // of the nominal controller
  const std::function<bool()>& is_stopped;
  std::vector<std::optional<double>> known_from;  // [s] of each record, by the nominal controller: every effect is compared over the same cycles
  double change_time;  // [s] short against ramps and integral times, long enough to see a ramp that is late
  Eigen::VectorXd operator()(const Effects& effects, double time) const {
    return std::move(*below(std::numeric_limits<double>::infinity(), effects, time));
  }
  // Nothing where the sum of squares is above `most`.
  std::optional<Eigen::VectorXd> below(double most, const Effects& effects, double time) const {
    if (is_stopped && is_stopped()) throw Interrupted{};
    return torque_differences(records, known_from, controller::with_effects(nominal, effects), time, most);
  }
};

std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about, const Grid& grid) {
  const common::EffectInstance typical = common::typical_instance(about);
  std::vector<common::EffectInstance> starts{typical};
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    const bool is_size = p == common::kSize && parameter.absent && std::isfinite(*parameter.absent);
    const double centre = to_coordinate(parameter, is_size ? *parameter.absent : typical.values[p]);
    const double stride = is_size ? grid.size_stride : grid.other_stride, reach = is_size ? kSizeReach : kOtherReach;
    std::vector<common::EffectInstance> along;
    for (common::EffectInstance start : starts) {
      double before = std::numeric_limits<double>::quiet_NaN();
      for (int n = 0; n * stride <= 2.0 * reach; ++n) {
        start.values[p] = value_at(parameter, centre + (n * stride - reach));
        if (start.values[p] != before) along.push_back(start);
        before = start.values[p];
      }
    }
    starts = std::move(along);
  }
  return starts;
}

// From `effects`, by the torques' changes over `change_time`. Gives the differences there and the curvature.
Eigen::VectorXd descend(const Replays& replays, double change_time, Effects& effects, Eigen::MatrixXd& gram) {
  Eigen::VectorXd x = effect_coordinates(replays.catalogue, effects), trial;
  Eigen::VectorXd difference = replays(effects, change_time), trial_difference;
  Eigen::MatrixXd columns;  // where the descent stands; none: not yet made
  Descending problem;
  problem.model = [&]() -> LocalModel {
    if (columns.size() == 0) {
      columns.resize(difference.size(), x.size());
      for (Eigen::Index p = 0; p < x.size(); ++p) {
        Eigen::VectorXd moved = x;
        moved(p) += kStep;
        columns.col(p) = (replays(effects_at(replays.catalogue, effects, moved), change_time) - difference) / kStep;
      }
      gram = columns.transpose() * columns;
    }
    LocalModel model{gram, columns.transpose() * difference};
    const double largest = gram.diagonal().maxCoeff();
    model.curvature.diagonal().array() += kLeastCurvature * (largest > 0.0 ? largest : 1.0);
    return model;
  };
  problem.attempt = [&](const Eigen::VectorXd& step) -> std::optional<double> {
    trial = effect_coordinates(replays.catalogue, effects_at(replays.catalogue, effects, x + step));
    if (trial == x) return std::nullopt;
    std::optional<Eigen::VectorXd> found = replays.below(difference.squaredNorm(), effects_at(replays.catalogue, effects, trial), change_time);
    if (!found) return std::numeric_limits<double>::infinity();
    trial_difference = std::move(*found);
    return trial_difference.squaredNorm();
  };
  problem.accept = [&] {
    x = trial;
    difference = trial_difference;
    columns.resize(0, 0);
  };
  slewlab::diagnosis::descend(problem, difference.squaredNorm(), {kIterations, kDampings, 0.0, kEnoughShare});
  effects = effects_at(replays.catalogue, effects, x);
  return difference;
}

// Where a ramp's changes of direction come a cycle earlier or later, slopes lead nowhere: one parameter after the other, by
// strides that are halved where none helps.
void feel_around(const Replays& replays, double change_time, Effects& effects) {
  Eigen::VectorXd x = effect_coordinates(replays.catalogue, effects);
  double least = replays(effects, change_time).squaredNorm();
  for (double stride = kFirstStride; stride > kLastStride;) {
    bool fell = false;
    for (Eigen::Index p = 0; p < x.size(); ++p) {
      for (const double direction : {1.0, -1.0}) {
        Eigen::VectorXd moved = x;
        moved(p) += direction * stride;
        moved = effect_coordinates(replays.catalogue, effects_at(replays.catalogue, effects, moved));
        const std::optional<Eigen::VectorXd> found = replays.below(least, effects_at(replays.catalogue, effects, moved), change_time);
        if (!found || found->squaredNorm() >= least) continue;
        least = found->squaredNorm();
        x = moved;
        fell = true;
        break;
      }
    }
    if (!fell) stride *= 0.5;
  }
  effects = effects_at(replays.catalogue, effects, x);
}

// The starts with the smallest residual of the changes.
std::vector<Effects> best_of(const Replays& replays, const std::vector<Effects>& starts) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const bool is_full = ranked.size() == kStartsToGoOn;
    const std::optional<Eigen::VectorXd> found = replays.below(is_full ? ranked.back().first : kInfinity, starts[i], replays.change_time);
    if (!found) continue;
    const double square = found->squaredNorm();
    ranked.emplace_back(std::isfinite(square) ? square : kInfinity, i);
    std::sort(ranked.begin(), ranked.end());
    if (is_full) ranked.pop_back();
  }
  std::vector<Effects> best;
  for (const auto& [square, i] : ranked) best.push_back(starts[i]);
  return best;
}

// A replayed integral runs away as long as the speed it wants is not quite the recorded one, and its torque leads a descent
// nowhere until everything is nearly right. So first the changes, then the torques.
ControllerCause fit_effects(const Replays& replays, double gap, const std::vector<Effects>& starts, bool without_slopes) {
  ControllerCause best;
  best.share_left = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd best_gram;
  for (Effects effects : starts) {
    if (best.share_left <= kExact) break;
    Eigen::MatrixXd gram;
    const auto consider = [&](const Eigen::VectorXd& difference) {
      const double share = gap > 0.0 ? difference.squaredNorm() / gap : 1.0;
      if (share >= best.share_left) return;
      best.share_left = share;
      best.effects = effects;
      best_gram = gram;
    };
    descend(replays, replays.change_time, effects, gram);
    if (without_slopes) feel_around(replays, replays.change_time, effects);
    consider(descend(replays, 0.0, effects, gram));
  }
  // The residual is not noise but law; it is worth kIndependent differences.
  const double variance = std::max(best.share_left, kUsualShareLeft) * gap / kIndependent;
  Eigen::MatrixXd regular = best_gram;
  regular.diagonal().array() += kLeastCurvature * std::max(1e-300, best_gram.diagonal().maxCoeff());
  const Eigen::MatrixXd inverse = regular.inverse();
  Eigen::Index i = 0;
  for (const common::EffectInstance& effect : best.effects) {
    const common::EffectAbout& about = replays.catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++i) {
      const double per_deviation = value_per_deviation(about.parameters[p], effect.values[p]);
      best.deviation.push_back(std::fabs(per_deviation) * std::sqrt(std::min(1.0, variance * inverse(i, i))));
    }
  }
  return best;
}

}  // namespace

std::vector<ControllerCause> fit_controller(std::span<const Record> records, const controller::ControllerSettings& nominal,
                                            std::span<const std::string> without, const std::function<bool()>& is_stopped, const ShareOut& share) {
  const common::EffectCatalogue all = controller::effects_for(nominal);
  std::vector<std::optional<double>> known_from;
  for (const Record& record : records) known_from.push_back(controller_known_from(record, nominal));
  const Replays replays{records, nominal, all, is_stopped, std::move(known_from), change_time_of(nominal)};
  const double gap = replays({}, 0.0).squaredNorm();
  std::vector<const common::EffectAbout*> catalogue;
  for (const common::EffectAbout& about : all.effects) {
    if (std::find(without.begin(), without.end(), about.name) == without.end()) catalogue.push_back(&about);
  }
  const auto leaves_less = [](const ControllerCause& a, const ControllerCause& b) { return a.share_left < b.share_left; };
  std::vector<std::vector<Effects>> singles(catalogue.size());  // of each effect the starts to go on from
  share(catalogue.size(), [&](std::size_t i) {
    std::vector<Effects> starts;
    for (const common::EffectInstance& start : starts_of(*catalogue[i], kFine)) starts.push_back({start});
    singles[i] = best_of(replays, starts);
  });
  std::vector<ControllerCause> causes;
  // The search without slopes takes longer and is left out where it is not needed.
  for (const bool without_slopes : {false, true}) {
    if (!causes.empty() && causes.front().share_left <= kExact) break;
    causes.assign(singles.size(), {});
    share(singles.size(), [&](std::size_t i) { causes[i] = fit_effects(replays, gap, singles[i], without_slopes); });
    std::sort(causes.begin(), causes.end(), leaves_less);
  }
  // Two effects, where one is not the whole answer.
  if (!causes.empty() && causes.front().share_left > kExact) {
    const std::size_t firsts = std::min<std::size_t>(kSinglesToPair, causes.size());
    std::set<std::set<std::string>> tried;
    std::vector<std::pair<common::EffectInstance, const common::EffectAbout*>> pairs;
    for (std::size_t i = 0; i < firsts; ++i) {
      const common::EffectInstance first = causes[i].effects.front();
      for (const common::EffectAbout* about : catalogue) {
        const std::string second(about->name);
        if (second != first.name && tried.insert({first.name, second}).second) pairs.emplace_back(first, about);
      }
    }
    const std::size_t alone = causes.size();
    causes.resize(alone + pairs.size());
    share(pairs.size(), [&](std::size_t i) {
      std::vector<Effects> starts;
      for (const common::EffectInstance& start : starts_of(*pairs[i].second, kCoarse)) starts.push_back({pairs[i].first, start});
      causes[alone + i] = fit_effects(replays, gap, best_of(replays, starts), false);
    });
    std::sort(causes.begin(), causes.end(), leaves_less);
  }
  double sum = 0.0;
  for (ControllerCause& cause : causes) {
    const double prior = cause.effects.size() > 1 ? kPairPrior : 1.0;
    cause.probability = prior * std::pow((kUsualShareLeft + cause.share_left) / kUsualShareLeft, -0.5 * kIndependent);
    sum += cause.probability;
  }
  for (ControllerCause& cause : causes) cause.probability /= sum;
  std::stable_sort(causes.begin(), causes.end(),
                   [](const ControllerCause& a, const ControllerCause& b) { return a.probability > b.probability; });
  return causes;
}

}  // namespace slewlab::diagnosis
