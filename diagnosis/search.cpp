#include "diagnosis/search.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>

#include "diagnosis/own_noise_fit.h"
#include "diagnosis/recurrence.h"
#include "diagnosis/spell_times.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/stochastic_fit.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastPairGain = 25.0;         // fall of the residual power below the best single effect's, forecast, to try a pair
constexpr double kSameMotion = 1e-6;            // relative difference of two signatures below which two effects are indistinguishable
constexpr double kNearRival = 30.0;              // cost above the best fit's, below which the order may be that of convergence
constexpr std::size_t kMostRivals = 2;
constexpr int kFreshRounds = 10;                // at most, for a leader
constexpr std::size_t kPairLeaders = 3;         // single effects beside which a second one is looked for
constexpr int kMoreLooks = 2;                   // beside single effects that came on
constexpr int kPairsPerLeader = 2;              // that are refined beside each of them but the best
constexpr double kLargeResidual = 2.0;              // residual variance ratio of the nominal machine, above which an effect may be hidden by where the parameters went
constexpr double kNotFar = 0.1;                   // chance of machines that lie as far from nominal, above which parameters hide no effect where they leave noise alone; chosen
constexpr double kFarBehind = 4.0;               // times what the best law leaves, beyond which a law for a spell is not looked for at other times; chosen
constexpr double kRival = 20.0;                // of the cost: the odds are beyond doubt
constexpr double kDoubtful = 1000.0;            // residual power of parameters alone below which they may be the answer
constexpr std::size_t kFromBest = 4;             // fits that try the best one's machine
constexpr std::size_t kFewSingles = 5;          // starts that are refined, up to which a search is short
constexpr std::size_t kRecurringStarts = 3;      // of a law that recurs: linearly its angles are not told for sure
constexpr Stage kStartOver{0.0, 0.4};            // of converging
constexpr Stage kLookAgain{0.5, 0.8};            // of going back
constexpr std::size_t kExchanges = 2;            // that are tried for each effect of the best pair
constexpr double kParallel = 0.02;              // 1 - cosine^2 of two signatures below which they are not tried as a pair

constexpr double kAnywhere = std::numeric_limits<double>::infinity();  // a cost to which every fit comes down

bool cheaper(const FitResult& a, const FitResult& b) { return a.cost < b.cost; }

// The cost to which other fits are to come down: that of one whose residual is noise alone, and no more than `reach`. A hypothesis that holds its effects and
// more stands no higher where it has settled, for those may be absent; a rival that stays above it is no answer beside it.
double reach_of(const FitResult& best, double reach = kAnywhere) {
  return mean_square(best.difference) <= 1.0 ? std::min(best.cost, reach) : reach;
}

std::string effects_of(const Point& point) {
  std::string names;
  for (const common::EffectInstance& effect : point.effects) names += (names.empty() ? "" : " with ") + effect.name;
  return names;
}

// Goes on until it settles. Parameters of effects that end at their bounds may have gone there on the way and not come back: once more with these at their typical values.
void settle_rival(Problem& problem, FitResult& fitted, double reach) {
  settle(problem, fitted, kFreshRounds, reach);
  if (fitted.cost > fitted.cost_elsewhere - kNearRival) return;
  Point start = fitted.point;
  bool is_elsewhere = false;
  for (common::EffectInstance& effect : start.effects) {
    const common::EffectAbout& about = problem.catalogue.at(effect.name);
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const common::EffectParameter& parameter = about.parameters[p];
      if (p == common::kSize || !is_at_a_bound(parameter, effect.values[p]) || effect.values[p] == parameter.typical) continue;
      effect.values[p] = parameter.typical;
      is_elsewhere = true;
    }
  }
  if (!is_elsewhere) return;
  FitResult other = fit(problem, fitted.columns.leftCols(static_cast<Eigen::Index>(start.nuisance.size())), start);
  settle(problem, other, kFreshRounds, reach);
  if (other.cost < fitted.cost) fitted = std::move(other);
  fitted.cost_elsewhere = fitted.cost;
}

// Goes on until it settles. A fit whose residual is more than noise does so from afar as well, but from one place once.
void settle_leader(Problem& problem, FitResult& leader, double reach) {
  settle_rival(problem, leader, reach);
  if (mean_square(leader.difference) <= 1.0 || leader.cost > leader.cost_from_afar - kNearRival) return;
  FitResult other = leader;
  settle_from_afar(problem, other, 1.0, kFreshRounds);
  settle(problem, other, kFreshRounds);
  if (other.cost < leader.cost) leader = std::move(other);
  leader.cost_from_afar = leader.cost;
}

// Rounds with fresh columns for the best `count`, each time for the better half of them: none loses for want of convergence, and few go all the way.
// Where there is a cost to reach, because a fit's residual is noise alone, those go on that would come down to it at the pace of their last round.
void converge(Problem& problem, std::vector<FitResult>& fits, std::size_t count, double reach) {
  for (; count > 1 && !fits.empty(); count = (count + 1) / 2) {
    std::stable_sort(fits.begin(), fits.end(), cheaper);
    const std::size_t now = std::min(count, fits.size());
    const double to_reach = reach_of(fits.front(), reach);
    std::atomic<bool> comes_on{false};
    share_out(problem, now, [&](std::size_t i) {
      const bool is_there = fits[i].cost <= to_reach, stands_still_far_off = fits[i].idle_rounds > 0 && fits[i].cost > to_reach + kNearRival;
      if ((is_there || stands_still_far_off) && to_reach < kAnywhere) return;
      const double before = fits[i].cost;
      settle(problem, fits[i], 1);
      if (would_come_down(before, fits[i].cost, kFreshRounds, to_reach)) comes_on = true;
    });
    if (count == 2 || !comes_on) break;
  }
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// The best `count` get another round, and one from the nominal machine with their effects: where parameters had gone far to
// stand for what an effect says now, a descent does not bring them back.
void start_over(Problem& problem, const Eigen::MatrixXd& nuisance_columns, std::vector<FitResult>& fits, std::size_t count, const Progress& tell) {
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  share_out(problem, std::min(fits.size(), count), [&](std::size_t i) {
    tell(static_cast<double>(i) / static_cast<double>(count), "converging " + effects_of(fits[i].point));
    improve(problem, fits[i], false);
    Point start = fits[i].point;
    std::fill(start.nuisance.begin(), start.nuisance.end(), 0.0);
    FitResult again = fit(problem, nuisance_columns, start);
    if (again.cost < fits[i].cost) fits[i] = std::move(again);
  });
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// Of fits in their order the best one and those that are near it.
std::size_t count_near_best(const std::vector<FitResult>& fits) {
  const auto is_far = [&](const FitResult& one) {
    return one.cost > fits.front().cost + kNearRival && mean_square(one.difference) > (one.ending == Ending::most_iterations ? kNoiseAlone : 1.0);
  };
  const auto near = static_cast<std::size_t>(std::find_if(fits.begin(), fits.end(), is_far) - fits.begin());
  return std::min(near, kMostRivals + 1);
}

// The best one, and where another one is near, that one too: none loses for want of convergence.
void settle_best(Problem& problem, std::vector<FitResult>& fits, double reach) {
  if (fits.empty()) return;
  settle_leader(problem, fits.front(), reach);
  const double to_reach = reach_of(fits.front(), reach);
  const std::size_t rivals = count_near_best(fits) - 1;
  share_out(problem, rivals, [&](std::size_t behind) { settle_rival(problem, fits[behind + 1], to_reach); });
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// Where one effect leaves noise alone and parameters alone do not, the others draw no parameters off to stand for a second one: they go on with fresh columns,
// for those that they had may have led nowhere.
void go_on_beside_noise(Problem& problem, const FitResult& base, std::vector<FitResult>& fits, std::size_t count) {
  if (fits.empty() || reach_of(base) < kAnywhere || reach_of(fits.front()) == kAnywhere) return;
  converge(problem, fits, count, kAnywhere);
  settle_best(problem, fits, kAnywhere);
}

// Each takes the place of the one with its effects where it is cheaper.
void take_cheaper(std::vector<FitResult>& fits, std::vector<FitResult> others) {
  for (FitResult& other : others) {
    const auto same = std::find_if(fits.begin(), fits.end(), [&](const FitResult& one) { return has_same_effects(one.point, other.point); });
    if (same == fits.end()) {
      fits.push_back(std::move(other));
    } else if (other.cost < same->cost) {
      *same = std::move(other);
    }
  }
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

Point without_effect(Point point, std::size_t left_out) {
  point.effects.erase(point.effects.begin() + static_cast<std::ptrdiff_t>(left_out));
  return point;
}

// A fit's machine without one of its effects, where the parameters and the others say, by the fit's own columns, what that one said. Where it is just taken away,
// the residual is large, counts little, and the descent ends where the parameters stand in for it. Nothing of an effect that is nowhere absent.
std::optional<Point> handed_on(const Problem& problem, const FitResult& from, std::size_t left_out) {
  const std::vector<common::EffectInstance>& effects = from.point.effects;
  const std::optional<double>& absent = problem.catalogue.at(effects[left_out].name).parameters[common::kSize].absent;
  if (!absent || !std::isfinite(*absent)) return {};
  auto first = static_cast<Eigen::Index>(from.point.nuisance.size());
  for (std::size_t e = 0; e < left_out; ++e) first += static_cast<Eigen::Index>(effects[e].values.size());
  const auto count = static_cast<Eigen::Index>(effects[left_out].values.size());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < from.columns.cols(); ++i) {
    if (i < first || i >= first + count) kept.push_back(i);
  }
  // The coordinate of a size is 0 where the effect is absent.
  const double size = effect_coordinates(problem.catalogue, {&effects[left_out], 1})(static_cast<Eigen::Index>(common::kSize));
  const Eigen::VectorXd without = from.difference - size * from.columns.col(first + static_cast<Eigen::Index>(common::kSize));
  const Point start = without_effect(from.point, left_out);
  const Eigen::MatrixXd columns = from.columns(Eigen::all, kept);
  const PriorRows prior = prior_rows(problem, start);
  const double weight = data_weight(from.difference, problem.settings);
  Eigen::MatrixXd system = weight * gram_of(columns);
  system.diagonal() += prior.slope.cwiseAbs2();
  return moved(problem.catalogue, start, -system.ldlt().solve(weight * columns.transpose() * without + prior.value.cwiseProduct(prior.slope)));
}

// From the best fit of `effects` effects to those with one less; they take their places where they are cheaper. Parameters alone, where
// they may be the answer, go on until they settle: their first fit may have stopped at the bounds of their spread.
void go_back(Problem& problem, const Eigen::MatrixXd& nuisance_columns, std::size_t effects, std::vector<FitResult>& fits) {
  const auto best =
      std::find_if(fits.begin(), fits.end(), [&](const FitResult& result) { return result.point.effects.size() == effects; });
  if (best == fits.end()) return;
  const FitResult& from = *best;
  std::vector<FitResult> fewer(effects);
  share_out(problem, effects, [&](std::size_t left_out) {
    const Point start = without_effect(from.point, left_out);
    FitResult& again = fewer[left_out];
    again = fit(problem, nuisance_columns, start);
    take_nuisance_columns(problem, from.columns, again);
    improve(problem, again, false);
    if (const std::optional<Point> other = handed_on(problem, from, left_out)) {
      FitResult handed = fit(problem, from.columns.leftCols(static_cast<Eigen::Index>(start.nuisance.size())), *other);
      settle(problem, handed, kFreshRounds, reach_of(from));
      if (handed.cost < again.cost) again = std::move(handed);
    }
    if (again.point.effects.empty() && residual_power(again.difference, problem.settings) < kDoubtful) settle(problem, again, kFreshRounds);
  });
  take_cheaper(fits, std::move(fewer));
}

// Where a fit's effects begin on that ground, and the sum of squares of their residual there, linearly.
struct OnGround {
  Point start;
  double left = 0.0;
};

// As much of a law, or of a typical one, as takes most away there, for its own fit may have ended far from that. Two laws at once begin as they ended.
OnGround start_on(Problem& problem, const FitResult& ground, const FitResult& other) {
  std::vector<common::EffectInstance> own;
  for (const common::EffectInstance& effect : other.point.effects) {
    if (!has_effect(ground.point.effects, effect.name)) own.push_back(effect);
  }
  if (own.size() != 1) return {{ground.point.nuisance, other.point.effects}, other.difference.squaredNorm()};
  const common::EffectAbout& about = problem.catalogue.at(own.front().name);
  std::vector<common::EffectInstance> starts = with_quarters(about, own.front());
  const std::vector<common::EffectInstance> typical = with_quarters(about, common::typical_instance(about));
  starts.insert(starts.end(), typical.begin(), typical.end());
  const Screening there = screen(problem, ground, projector_of(problem, ground), starts, [](double, const std::string&) {});
  const Screened& screened = *best_of_each(there).front();
  return {with_amount(problem.catalogue, ground.point, screened, screened.amount), screened.left};
}

// Whether the answer may be the other fit's as well as the best one's: they have the same effects but for one, which is of one physics in both. Of a pair that leaves more than noise neither is.
bool is_relative(const Problem& problem, const FitResult& best, const FitResult& other) {
  if (best.point.effects.size() != other.point.effects.size() || (best.point.effects.size() > 1 && mean_square(best.difference) > kNoiseAlone)) return false;
  const auto own = [](const FitResult& fitted, const FitResult& beside) {
    std::vector<std::string> names;
    for (const common::EffectInstance& effect : fitted.point.effects) {
      if (!has_effect(beside.point.effects, effect.name)) names.push_back(effect.name);
    }
    return names;
  };
  const std::vector<std::string> first = own(best, other), second = own(other, best);
  if (first.size() != 1 || second.size() != 1) return false;
  const common::Family family = problem.catalogue.at(first.front()).family;
  return family != common::Family::none && family == problem.catalogue.at(second.front()).family;
}

// The best fit's machine, with another one's effects: of two indistinguishable laws the one that ended lower need not be the better law, and one that is a part of the other, with fewer
// parameters, can do as well. Of the fits with as many effects those try it that promise most there, for how low they ended elsewhere says nothing of it, and all laws of the same physics, which go on until they settle:
// between those the answer lies. What both have starts where the best one has it. Whether one came on by it.
bool start_from_best_machine(Problem& problem, std::vector<FitResult>& fits) {
  if (fits.empty() || fits.front().point.effects.empty()) return false;
  const FitResult& best = fits.front();
  const Eigen::MatrixXd nuisance_columns = best.columns.leftCols(static_cast<Eigen::Index>(best.point.nuisance.size()));
  struct Other {
    FitResult* fitted;
    OnGround there;
  };
  std::vector<Other> others;
  for (std::size_t i = 1; i < fits.size(); ++i) {
    if (fits[i].point.effects.size() == best.point.effects.size()) others.push_back({&fits[i], {}});
  }
  share_out(problem, others.size(), [&](std::size_t i) {
    const FitResult& other = *others[i].fitted;
    others[i].there = start_on(problem, common_ground(problem, best, other.point), other);
  });
  std::stable_sort(others.begin(), others.end(), [](const Other& a, const Other& b) { return a.there.left < b.there.left; });
  std::size_t next = 0;
  std::erase_if(others, [&](const Other& other) { return next++ >= kFromBest && !is_relative(problem, best, *other.fitted); });
  std::atomic<bool> came_on{false};
  share_out(problem, others.size(), [&](std::size_t i) {
    FitResult again = fit(problem, nuisance_columns, others[i].there.start);
    if (is_relative(problem, best, again)) settle(problem, again, kFreshRounds, reach_of(best));
    if (again.cost >= others[i].fitted->cost) return;
    *others[i].fitted = std::move(again);
    came_on = true;
  });
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  return came_on;
}

// Where the leader's residual is more than noise another law may only have begun too far off: on the leader's machine its residual may be noise
// alone. Only then are its fits kept: those with a larger residual have drawn parameters far off, to stand for a second effect.
void find_what_began_too_far_off(Problem& problem, std::vector<FitResult>& fits) {
  if (fits.empty() || mean_square(fits.front().difference) <= kNoiseAlone) return;
  std::vector<FitResult> others = fits;
  if (!start_from_best_machine(problem, others)) return;
  settle_best(problem, others, kAnywhere);
  if (mean_square(others.front().difference) <= kNoiseAlone) fits = std::move(others);
}

// Where no fit's residual is noise alone a law that lasts for a spell may only have been fitted at another time. Not one that another law leaves far behind: at any time it says
// what is slow in it.
void find_other_times(Problem& problem, std::vector<FitResult>& fits) {
  if (fits.empty() || mean_square(fits.front().difference) <= kNoiseAlone) return;
  double least = kAnywhere;
  for (const FitResult& one : fits) {
    if (one.point.effects.size() == 1) least = std::min(least, mean_square(one.difference));
  }
  share_out(problem, fits.size(), [&](std::size_t i) {
    if (fits[i].point.effects.size() == 1 && mean_square(fits[i].difference) <= kFarBehind * least) look_for_other_times(problem, fits[i]);
  });
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// Where a pair is fitted from, and the fit of whose columns it begins with: those of a machine without the pair's larger effect
// lead elsewhere.
struct PairStart {
  Point point;
  const FitResult* from;
};

// Whether a law comes again with an angle.
bool recurs(const common::EffectAbout& about) {
  return std::any_of(about.parameters.begin(), about.parameters.end(), [](const common::EffectParameter& parameter) { return parameter.recurs; });
}

// Starts of a law that recurs, with the lengths that stand out in what is missing at `point`: where another effect was missing as well, others did.
std::vector<common::EffectInstance> recurring_on(const Problem& problem, const Point& point, const std::string& name) {
  const common::EffectAbout& about = problem.catalogue.at(name);
  if (!recurs(about)) return {};
  return recurring_starts(about, recurring_lengths(problem, point, kLengths));
}

// A law that recurs has a valley for every length. Where the best fit has one, or has another law of that physics and a residual of more than noise,
// the law is tried in that one's place with the lengths that stand out then.
void try_recurring(Problem& problem, const Screening& screening, std::vector<FitResult>& fits) {
  if (fits.empty()) return;
  const FitResult& best = fits.front();
  const bool has_recurring = std::any_of(best.point.effects.begin(), best.point.effects.end(), [&](const common::EffectInstance& effect) { return recurs(problem.catalogue.at(effect.name)); });
  if (mean_square(best.difference) <= kNoiseAlone && !has_recurring) return;
  const Eigen::MatrixXd nuisance_columns = best.columns.leftCols(static_cast<Eigen::Index>(best.point.nuisance.size()));
  std::vector<Point> starts;
  for (const common::EffectInstance& replaced : best.point.effects) {
    Point rest = best.point;
    std::erase_if(rest.effects, [&](const common::EffectInstance& effect) { return effect.name == replaced.name; });
    const common::Family family = problem.catalogue.at(replaced.name).family;
    for (const std::string& name : screening.names) {
      if (problem.catalogue.at(name).family != family || has_effect(rest.effects, name)) continue;
      const std::vector<common::EffectInstance> recurring = recurring_on(problem, rest, name);
      if (recurring.empty()) continue;
      const FitResult ground = common_ground(problem, best, rest);
      Screening there = screen(problem, ground, projector_of(problem, ground), recurring, [](double, const std::string&) {});
      std::stable_sort(there.tried.begin(), there.tried.end(), [](const Screened& a, const Screened& b) { return a.left < b.left; });
      for (std::size_t i = 0; i < std::min(kRecurringStarts, there.tried.size()); ++i) {
        starts.push_back(with_amount(problem.catalogue, ground.point, there.tried[i], there.tried[i].amount));
      }
    }
  }
  if (starts.empty()) return;
  std::vector<FitResult> tried(starts.size());
  share_out(problem, starts.size(), [&](std::size_t i) { tried[i] = fit(problem, nuisance_columns, starts[i]); });
  settle(problem, *std::min_element(tried.begin(), tried.end(), cheaper), kFreshRounds);
  take_cheaper(fits, std::move(tried));
  settle_best(problem, fits, kAnywhere);
}

// What is promised beside a fitted effect: the starts, and the sum of squares of the fit's residual, of which they take a part away.
struct Beside {
  std::vector<Screened> tried;
  double left = 0.0;
};

// By a screening of the catalogue there.
Beside look_beside(Problem& problem, const FitResult& single, const Screening& screening, const std::map<std::string, std::string>& same_as,
                   const Progress& tell) {
  std::vector<common::EffectInstance> starts = best_starts(problem, screening);
  for (const std::string& name : screening.names) {
    const std::vector<common::EffectInstance> recurring = recurring_on(problem, single.point, name);
    starts.insert(starts.end(), recurring.begin(), recurring.end());
  }
  std::erase_if(starts, [&](const common::EffectInstance& start) {
    return same_as.contains(start.name) || is_stochastic(problem.catalogue.at(start.name));
  });
  Screening there = screen(problem, single, projector_of(problem, single), starts, tell);
  return {std::move(there.tried), there.gap.squaredNorm()};
}

// By the columns at hand.
Beside beside_by(const Problem& problem, const FitResult& single, const std::vector<const Screened*>& best) {
  const Projector project = projector_of(problem, single);
  const Eigen::VectorXd left = project.gap(single.difference);
  Beside beside{{}, left.squaredNorm()};
  for (const Screened* screened : best) {
    if (screened->start.name == single.point.effects[0].name) continue;
    beside.tried.push_back(*screened);
    try_amount(problem.catalogue, project(screened->column), left, beside.tried.back());
  }
  return beside;
}

// Of a sum of squares, that a pair must promise to take away.
double least_fall(const Problem& problem) { return kLeastPairGain / problem.settings.independent_share; }

std::vector<const Screened*> worth_a_pair(const Problem& problem, const Beside& beside) {
  std::vector<const Screened*> ranked;
  for (const Screened& screened : beside.tried) {
    if (beside.left - screened.left > least_fall(problem)) ranked.push_back(&screened);
  }
  return best_of_each(std::move(ranked));
}

// Beside an effect a parameter that stands where the spread of machines of one make ends may be another one's: what the parameter was is handed over.
std::vector<Point> of_what_is_beyond(const Problem& problem, const std::vector<const Screened*>& best, const Point& single) {
  std::vector<Point> starts;
  for (const Screened* screened : best) {
    const common::EffectAbout& about = problem.catalogue.at(screened->start.name);
    if (about.name == single.effects[0].name || !says_what_is_beyond(problem.nuisances, about, single.nuisance)) continue;
    starts.push_back(with_amount(problem.catalogue, single, *screened, 0.0));
  }
  return starts;
}

// Pairs worth refining, each from one point. First a second effect beside the best single one, with the catalogue screened again
// there: where effects are large, only that is near enough. Then, by the columns at hand, beside two more single ones. Last what two
// columns do jointly from where nothing is added: a pair that is met both ways begins beside its larger effect. Beside a single effect that does not come down
// to parameters alone, where their residual is noise alone, there is nothing to look for.
std::vector<PairStart> pair_starts(Problem& problem, const FitResult& base, const Screening& screening, const std::vector<const Screened*>& best,
                               const std::vector<FitResult>& singles, const std::map<std::string, std::string>& same_as,
                               const SearchSettings& settings, const Progress& tell) {
  const Eigen::VectorXd& gap = screening.gap;
  struct Pair {
    Point start;
    double left;
  };
  std::vector<std::vector<Pair>> joint_with(best.size());
  share_out(problem, best.size(), [&](std::size_t i) {
    for (std::size_t j = i + 1; j < best.size(); ++j) {
      const std::optional<Amounts> amounts = joint_amounts(best[i]->column, best[j]->column, gap, kParallel);
      if (!amounts) continue;
      const auto [x, y, a_target, b_target] = *amounts;
      const auto allowed = [&](const Screened& s, double amount) {
        return std::fabs(amount) <= kLargestAmount && (amount > 0.0 || common::size_turns_sign(problem.catalogue.at(s.start.name)));
      };
      if (!allowed(*best[i], x) || !allowed(*best[j], y)) continue;
      joint_with[i].push_back({with_amount(problem.catalogue, with_amount(problem.catalogue, base.point, *best[i], x), *best[j], y), gap.squaredNorm() + x * a_target + y * b_target});
    }
  });
  std::vector<Pair> joint;
  for (std::vector<Pair>& pairs : joint_with) joint.insert(joint.end(), std::make_move_iterator(pairs.begin()), std::make_move_iterator(pairs.end()));
  std::stable_sort(joint.begin(), joint.end(), [](const Pair& a, const Pair& b) { return a.left < b.left; });
  // Forecasts from where nothing is added are compared with each other, those beside a single fit with that fit.
  double best_single = gap.squaredNorm();
  for (const Screened* screened : best) best_single = std::min(best_single, screened->left);
  std::erase_if(joint, [&](const Pair& pair) { return pair.left > best_single - least_fall(problem); });
  std::vector<PairStart> starts;
  std::set<std::set<std::string>> taken;
  const auto take = [&](const Point& start, const FitResult& from) {
    if (taken.insert({start.effects[0].name, start.effects[1].name}).second) starts.push_back({start, &from});
  };
  const double reach = reach_of(base);
  std::size_t leaders = 0;
  while (leaders < std::min<std::size_t>(kPairLeaders, singles.size()) && singles[leaders].cost < reach) ++leaders;
  for (std::size_t leader = 0; leader < leaders; ++leader) {
    const FitResult& single = singles[leader];
    const bool is_best = leader == 0;
    const Beside look = is_best ? look_beside(problem, single, screening, same_as, tell) : beside_by(problem, single, best);
    const std::vector<const Screened*> ranked = worth_a_pair(problem, look);
    const auto most = static_cast<std::size_t>(is_best ? settings.beside_the_best : kPairsPerLeader);
    for (std::size_t k = 0; k < std::min(most, ranked.size()); ++k) {
      take(with_amount(problem.catalogue, single.point, *ranked[k], ranked[k]->amount), single);
    }
  }
  for (std::size_t leader = 0; leader < leaders; ++leader) {
    for (const Point& start : of_what_is_beyond(problem, best, singles[leader].point)) take(start, singles[leader]);
  }
  const std::size_t most_of_all = starts.size() + static_cast<std::size_t>(settings.joint_pairs);
  for (std::size_t i = 0; i < joint.size() && starts.size() < most_of_all; ++i) take(joint[i].start, base);
  return starts;
}

// The pairs from their starts; the best of them converge and settle. Columns of nuisances that nothing is known of are taken from the best single fit.
std::vector<FitResult> fit_pairs(Problem& problem, const FitResult& base, const std::vector<PairStart>& starts, const FitResult& best_single,
                                 double reach, const SearchSettings& settings, const Progress& refining, const Progress& converging) {
  std::vector<FitResult> pairs(starts.size());
  share_out(problem, starts.size(), [&](std::size_t i) {
    const auto& [start, from] = starts[i];
    refining(static_cast<double>(i) / static_cast<double>(starts.size()), "refining " + effects_of(start));
    const auto nuisances = static_cast<Eigen::Index>(start.nuisance.size());
    pairs[i] = fit(problem, from->columns.leftCols(nuisances), start);
    take_nuisance_columns(problem, best_single.columns, pairs[i]);
  });
  const auto contenders = static_cast<std::size_t>(settings.pair_contenders);
  start_over(problem, base.columns, pairs, contenders, within(converging, kStartOver));
  converging(kStartOver.to, "settling pairs");
  converge(problem, pairs, contenders, reach);
  settle_best(problem, pairs, reach);
  return pairs;
}

// The best single effects converge behind the pairs: before, they draw parameters far off to stand for what a second effect says, and a pair that begins there
// does not come back.
void converge_singles(Problem& problem, std::vector<FitResult>& fits, std::size_t count, double reach) {
  const auto first = std::stable_partition(fits.begin(), fits.end(), [](const FitResult& one) { return one.point.effects.size() != 1; });
  std::vector<FitResult> singles(std::make_move_iterator(first), std::make_move_iterator(fits.end()));
  fits.erase(first, fits.end());
  converge(problem, singles, count, reach);
  settle_best(problem, singles, reach);
  if (start_from_best_machine(problem, singles)) settle_best(problem, singles, reach);
  fits.insert(fits.end(), std::make_move_iterator(singles.begin()), std::make_move_iterator(singles.end()));
  std::stable_sort(fits.begin(), fits.end(), cheaper);
}

// Beside which single effect seconds were looked for, and where it stood.
struct LookedBeside {
  Point point;
  double cost = 0.0;
};

// A fit of one effect that came on only beside a second one has another residual than that in which seconds were looked for, and other parameters. They are looked for
// again from where it stands now, until the best single effect is one that was looked beside there; where it leaves noise alone, by parameters that are beyond their spread, those that say what they stand for.
void look_again(Problem& problem, const FitResult& base, const Screening& screening, const std::vector<const Screened*>& best, const std::map<std::string, std::string>& same_as,
                const SearchSettings& settings, LookedBeside looked_beside, std::vector<FitResult>& fits, const Progress& tell) {
  for (int look = 0; look < kMoreLooks; ++look) {
    const auto is_single = [](const FitResult& one) { return one.point.effects.size() == 1; };
    const auto single = std::find_if(fits.begin(), fits.end(), is_single);
    if (single == fits.end()) return;
    settle(problem, *single, kFreshRounds, reach_of(fits.front()));
    const bool is_looked_beside = has_same_effects(single->point, looked_beside.point) && single->cost > looked_beside.cost - kNearRival;
    if (is_looked_beside) return;
    std::vector<PairStart> starts;
    for (const Point& start : of_what_is_beyond(problem, best, single->point)) starts.push_back({start, &*single});
    const bool is_noise = mean_square(single->difference) <= 1.0;
    if (is_noise && starts.empty()) return;
    looked_beside = {single->point, single->cost};
    const double first = static_cast<double>(look) / kMoreLooks, third = 1.0 / (3.0 * kMoreLooks);
    const auto part = [&](int k) { return within(tell, {first + k * third, first + (k + 1) * third}); };
    const Beside beside = is_noise ? Beside{} : look_beside(problem, *single, screening, same_as, part(0));
    for (const Screened* screened : worth_a_pair(problem, beside)) {
      if (starts.size() >= static_cast<std::size_t>(settings.beside_the_best)) break;
      starts.push_back({with_amount(problem.catalogue, single->point, *screened, screened->amount), &*single});
    }
    take_cheaper(fits, fit_pairs(problem, base, starts, *single, reach_of(*single), settings, part(1), part(2)));
    go_back(problem, base.columns, 2, fits);
  }
}

// The points of a fit with its `whole` effect, which holds others of the catalogue whole, as its parts: of a single effect all of them, beside a second one each alone.
// None where one of them is left out.
std::vector<Point> apart(const Problem& problem, const Screening& screening, const Point& point, std::size_t whole) {
  const std::vector<common::EffectInstance> parts = common::parts_of(problem.catalogue, point.effects[whole]);
  const auto is_left_out = [&](const common::EffectInstance& part) { return !screening.names.contains(part.name); };
  if (parts.empty() || std::any_of(parts.begin(), parts.end(), is_left_out)) return {};
  if (point.effects.size() == 1) return {{point.nuisance, parts}};
  std::vector<Point> points;
  for (const common::EffectInstance& part : parts) {
    if (has_effect(point.effects, part.name)) continue;
    points.push_back(point);
    points.back().effects[whole] = part;
  }
  return points;
}

// A law that holds others of the catalogue whole may have taken their place: the leading single effects that are such, and those in the best pair, as their parts.
void take_apart(Problem& problem, const Screening& screening, std::vector<FitResult>& fits) {
  std::vector<FitResult> found;
  std::size_t singles = 0, pairs = 0;
  for (const FitResult& one : fits) {
    const bool is_single = one.point.effects.size() == 1;
    if (is_single ? singles++ >= kPairLeaders : one.point.effects.size() != 2 || pairs++ >= 1) continue;
    for (std::size_t whole = 0; whole < one.point.effects.size(); ++whole) {
      for (const Point& start : apart(problem, screening, one.point, whole)) {
        FitResult& other = found.emplace_back(fit(problem, one.columns.leftCols(static_cast<Eigen::Index>(start.nuisance.size())), start));
        settle(problem, other, kFreshRounds);
      }
    }
  }
  take_cheaper(fits, std::move(found));
}

// Seconds are looked for beside the best single effect, and that one may only have stood for another one: each effect of the best pair is exchanged for those that promise most beside the
// other one where the pair stands, and these go on until they settle. Not where a single effect is near the pair and leaves noise alone.
void exchange_one(Problem& problem, const Screening& screening, const std::map<std::string, std::string>& same_as, std::vector<FitResult>& fits) {
  if (fits.empty() || fits.front().point.effects.size() != 2) return;
  const FitResult& best = fits.front();
  const auto is_enough = [&](const FitResult& one) { return one.point.effects.size() == 1 && reach_of(one) <= best.cost + kNearRival; };
  if (std::any_of(fits.begin(), fits.end(), is_enough)) return;
  std::vector<Point> starts;
  for (std::size_t exchanged = 0; exchanged < 2; ++exchanged) {
    const Point rest = without_effect(best.point, exchanged);
    const FitResult ground = common_ground(problem, best, rest);
    const Beside beside = look_beside(problem, ground, screening, same_as, [](double, const std::string&) {});
    std::size_t taken = 0;
    for (const Screened* screened : worth_a_pair(problem, beside)) {
      if (taken == kExchanges) break;
      if (has_effect(best.point.effects, screened->start.name)) continue;
      ++taken;
      starts.push_back(with_amount(problem.catalogue, ground.point, *screened, screened->amount));
    }
  }
  const Eigen::MatrixXd nuisance_columns = best.columns.leftCols(static_cast<Eigen::Index>(best.point.nuisance.size()));
  std::vector<FitResult> tried(starts.size());
  share_out(problem, starts.size(), [&](std::size_t i) {
    tried[i] = fit(problem, nuisance_columns, starts[i]);
    settle(problem, tried[i], kFreshRounds, reach_of(best));
  });
  take_cheaper(fits, std::move(tried));
}

// Of two effects that are the same motion the one that was fitted stands for the other as well.
void name_both(const std::map<std::string, std::string>& same_as, std::vector<FitResult>& fits) {
  for (const auto& [name, other] : same_as) {
    for (std::size_t i = 0; i < fits.size(); ++i) {
      for (std::size_t e = 0; e < fits[i].point.effects.size(); ++e) {
        if (fits[i].point.effects[e].name != other) continue;
        FitResult renamed = fits[i];
        renamed.point.effects[e].name = name;
        fits.push_back(std::move(renamed));
        break;
      }
    }
  }
}

// The starts that promise most, from where their screening was made, each effect from two at most. Of effects that are the same motion one is taken, and `same_as` says for which others.
std::vector<const Screened*> chosen_starts(const Problem& problem, const FitResult& from, const Screening& screening, const std::vector<const Screened*>& ranked,
                                           int most, std::map<std::string, std::string>& same_as) {
  std::vector<const Screened*> chosen;
  std::map<std::string, std::size_t> seen;
  for (const Screened* screened : ranked) {
    if (static_cast<int>(chosen.size()) >= most || forecast(problem, from, screening, *screened) < kLeastGain) break;
    if (same_as.count(screened->start.name) != 0) continue;
    const auto same = std::find_if(chosen.begin(), chosen.end(), [&](const Screened* other) {
      return other->start.name != screened->start.name && other->start.values == screened->start.values && screened->column.size() > 0 &&
             (other->column - screened->column).squaredNorm() <= kSameMotion * kSameMotion * screened->visibility;
    });
    if (same != chosen.end()) {
      same_as[screened->start.name] = (*same)->start.name;
    } else if (++seen[screened->start.name] <= kStartsPerEffect) {
      chosen.push_back(screened);
    }
  }
  return chosen;
}

// What can be refined of a screening, the smallest residual first.
std::vector<const Screened*> ranked_starts(const Problem& problem, const Screening& screening) {
  std::vector<const Screened*> ranked;
  for (const Screened& screened : screening.tried) {
    if (!is_stochastic(problem.catalogue.at(screened.start.name))) ranked.push_back(&screened);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
  return ranked;
}

// Where the residual of the nominal machine is large, parameters alone may stand for what an effect says, and beside them it promises nothing: the
// catalogue is looked at from the nominal machine as well, and refined from there. So where they have gone farther than machines of one make do. What an effect
// could say in place of parameters that leave noise alone is no more than how far they have gone: where that is not far there is nothing to look for.
std::vector<FitResult> refined_from_nominal(Problem& problem, const FitResult& base, const Screening& screening, const SearchSettings& settings,
                                            std::map<std::string, std::string>& same_as, const Progress& tell) {
  const double chance = chance_of_prior(base.prior, base.information, problem.settings.independent_share);
  if (mean_square(base.difference) <= 1.0 && chance >= kNotFar) return {};
  FitResult from = base;
  std::fill(from.point.nuisance.begin(), from.point.nuisance.end(), 0.0);
  from.difference = differences(problem, from.point);
  if (mean_square(from.difference) < kLargeResidual && chance >= kFarTogether) return {};
  const std::vector<common::EffectInstance> best = best_starts(problem, screening);
  std::vector<common::EffectInstance> starts;  // those of one effect stand together
  for (const common::EffectInstance& start : best) {
    // What served best elsewhere may be far from what does here.
    const common::EffectInstance typical = common::typical_instance(problem.catalogue.at(start.name));
    const bool is_first = starts.empty() || starts.back().name != start.name;
    const auto is_typical = [&](const common::EffectInstance& one) { return one.name == typical.name && one.values == typical.values; };
    if (is_first && std::none_of(best.begin(), best.end(), is_typical)) {
      const std::vector<common::EffectInstance> turned = with_quarters(problem.catalogue.at(start.name), typical);
      starts.insert(starts.end(), turned.begin(), turned.end());
    }
    starts.push_back(start);
  }
  constexpr Stage kLook{0.0, 0.5}, kRefine{0.5, 1.0};
  const Screening there = screen(problem, from, projector_of(problem, from), starts, within(tell, kLook));
  const std::vector<const Screened*> chosen = chosen_starts(problem, from, there, ranked_starts(problem, there), settings.singles_to_refine, same_as);
  std::vector<FitResult> refined(chosen.size());
  const Progress refining = within(tell, kRefine);
  share_out(problem, chosen.size(), [&](std::size_t i) {
    refining(static_cast<double>(i) / static_cast<double>(chosen.size()), "refining " + chosen[i]->start.name + " from the nominal machine");
    refined[i] = fit(problem, base.columns, with_amount(problem.catalogue, from.point, *chosen[i], chosen[i]->amount));
  });
  return refined;
}

// From the best fit to the others, where it leads: to other effects on its machine, to one effect and to none.
void meet(Problem& problem, const FitResult& base, const Screening& screening, const std::vector<const Screened*>& best, const std::map<std::string, std::string>& same_as, const SearchSettings& settings,
          const LookedBeside& looked_beside, std::vector<FitResult>& fits, const Progress& tell) {
  const double reach = reach_of(base);
  tell(0.0, "meeting at the best fit");
  if (start_from_best_machine(problem, fits)) {
    start_over(problem, base.columns, fits, count_near_best(fits), [](double, const std::string&) {});
    settle_best(problem, fits, reach);
  }
  // What fits with one effect more may show the way to those with less: a descent that stopped short elsewhere goes on from there.
  tell(0.4, "going back to one effect");
  go_back(problem, base.columns, 2, fits);
  converge_singles(problem, fits, static_cast<std::size_t>(settings.contenders), reach_of(fits.front(), reach));
  tell(0.45, "looking for when effects act");
  find_other_times(problem, fits);
  if (settings.joint_pairs > 0) {
    look_again(problem, base, screening, best, same_as, settings, looked_beside, fits, within(tell, kLookAgain));
    take_apart(problem, screening, fits);
    exchange_one(problem, screening, same_as, fits);
  }
  try_recurring(problem, screening, fits);
  tell(0.8, "going back to none");
  go_back(problem, base.columns, 1, fits);
}

// Where noise is all that the best of them leaves, causes are weighed by costs that differ by a few units: each that is near settles as far as it can. So does each of two effects alone, however far: the
// other one is there only if the first, at the floor of its valley, leaves more.
void settle_rivals(Problem& problem, std::vector<FitResult>& fits) {
  const auto best = std::min_element(fits.begin(), fits.end(), cheaper);
  if (best == fits.end() || mean_square(best->difference) > kNoiseAlone) return;
  const double near = best->cost + kRival;
  const std::vector<common::EffectInstance> both = best->point.effects;
  share_out(problem, fits.size(), [&](std::size_t i) {
    const bool is_one_of_both = both.size() > 1 && fits[i].point.effects.size() == 1 && has_effect(both, fits[i].point.effects.front().name);
    if (fits[i].cost <= near || is_one_of_both) settle_to_the_floor(problem, fits[i], kFreshRounds);
  });
}

}  // namespace

Found search(Problem& problem, FitResult& base, const Screening& screening, const SearchSettings& settings, const Shows& shows,
             const Progress& tell_all) {
  const std::vector<const Screened*> ranked = ranked_starts(problem, screening);
  std::vector<const Screened*> best = best_of_each(ranked);

  // Refine the best ones with everything free: what takes away more than chance would. Two indistinguishable effects are fitted once and named both.
  Found found;
  std::map<std::string, std::string>& same_as = found.same_as;
  const std::vector<const Screened*> chosen = chosen_starts(problem, base, screening, ranked, settings.singles_to_refine, same_as);
  std::erase_if(best, [&](const Screened* screened) { return same_as.count(screened->start.name) != 0; });
  std::vector<FitResult>& fits = found.fits;
  fits.resize(chosen.size());
  const bool is_short = chosen.size() <= kFewSingles && residual_power(base.difference, problem.settings) < kDoubtful;
  const Progress tell = is_short ? shortened(tell_all, kWithFewEffects) : tell_all;
  const Progress refining = within(tell, kRefineSingles);
  share_out(problem, chosen.size(), [&](std::size_t i) {
    refining(static_cast<double>(i) / static_cast<double>(chosen.size()), "refining " + chosen[i]->start.name);
    fits[i] = fit(problem, base.columns, with_amount(problem.catalogue, base.point, *chosen[i], chosen[i]->amount));
  });
  std::vector<FitResult> others = refined_from_nominal(problem, base, screening, settings, same_as, within(tell, kLookFromNominal));
  fits.insert(fits.end(), std::make_move_iterator(others.begin()), std::make_move_iterator(others.end()));
  // One fit per effect, the better one. The leaders go on, the best of them with fresh columns, so that none loses for
  // want of convergence.
  std::stable_sort(fits.begin(), fits.end(), cheaper);
  std::set<std::string> seen;
  std::erase_if(fits, [&](const FitResult& result) { return !seen.insert(result.point.effects[0].name).second; });
  const Progress converging = within(tell, kConvergeSingles);
  start_over(problem, base.columns, fits, static_cast<std::size_t>(settings.contenders), within(converging, kStartOver));
  converging(kStartOver.to, "settling single effects");
  settle_best(problem, fits, reach_of(base));
  go_on_beside_noise(problem, base, fits, static_cast<std::size_t>(settings.contenders));
  find_what_began_too_far_off(problem, fits);
  // The best single effect may show what the nominal machine lacks, which parameters alone did not.
  const Shown shown = fits.empty() ? Shown::nothing : shows(fits.front());
  if (shown == Shown::judged_elsewhere) {
    found.is_judged_elsewhere = true;
    return found;
  }
  if (shown == Shown::built_otherwise) {
    share_out(problem, fits.size() - 1, [&](std::size_t behind) { fits[behind + 1] = fit_again(problem, fits[behind + 1]); });  // the first one went on with it
    base = fit_again(problem, base);
    conclude(problem, base);
    std::stable_sort(fits.begin(), fits.end(), cheaper);
  }
  LookedBeside looked_beside;
  if (!fits.empty() && settings.joint_pairs > 0) {
    const auto beside_best = [&, beside = within(tell, kScreenBeside)](double share, const std::string& doing) {
      beside(share, doing + " beside " + effects_of(fits.front().point));
    };
    const std::vector<PairStart> starts = pair_starts(problem, base, screening, best, fits, same_as, settings, beside_best);
    looked_beside = {fits.front().point, fits.front().cost};
    std::vector<FitResult> pairs =
        fit_pairs(problem, base, starts, fits.front(), reach_of(fits.front(), reach_of(base)), settings, within(tell, kRefinePairs), within(tell, kConvergePairs));
    fits.insert(fits.end(), std::make_move_iterator(pairs.begin()), std::make_move_iterator(pairs.end()));
  }

  std::stable_sort(fits.begin(), fits.end(), cheaper);
  const Progress going_back = within(tell, kGoBack);
  if (!fits.empty() && fits.front().cost < reach_of(base)) meet(problem, base, screening, best, same_as, settings, looked_beside, fits, going_back);
  going_back(0.85, "settling the rivals");
  settle_rivals(problem, fits);
  share_out(problem, fits.size(), [&](std::size_t i) { conclude(problem, fits[i]); });
  going_back(0.9, "fitting by what the noise is in each machine");
  fit_by_own_noise(problem, fits);
  FitResult& nothing = found.nothing;
  nothing = base;
  const auto without_effects =
      std::find_if(fits.begin(), fits.end(), [](const FitResult& result) { return result.point.effects.empty(); });
  if (without_effects != fits.end()) {
    if (without_effects->cost < nothing.cost) nothing = *without_effects;
    fits.erase(without_effects);
  }
  std::vector<FitResult> with_stochastic = stochastic_fits(problem, screening, nothing, fits, within(tell, kLookForStochastic));
  fits.insert(fits.end(), std::make_move_iterator(with_stochastic.begin()), std::make_move_iterator(with_stochastic.end()));
  name_both(same_as, fits);

  // A fit whose machine could not follow the record at all is no candidate.
  std::erase_if(fits, [](const FitResult& result) { return !std::isfinite(result.cost + result.information.sum()); });
  return found;
}

}  // namespace slewlab::diagnosis
