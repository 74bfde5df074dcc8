#include "diagnosis/stochastic_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <set>

#include "diagnosis/stochastic.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kStochasticSize = 0.2;  // relative standard deviation of a size that is found from the power of one draw
constexpr double kOccam = 3.2;       // 2 ln(1 / 0.2): what a parameter costs that is known so well and has no column
constexpr int kLooks = 8;            // at the power of the size just found, at most
constexpr double kSettledScale = 0.1, kNearScale = 0.7;  // |ln a| from which the size is the power's, and up to which it goes with it
constexpr std::uint64_t kDraws = 3;  // of which a look takes the mean power
constexpr double kMeanSpread = 0.4;  // of the logarithm of the mean that a draw's power goes with: laws differ
constexpr double kLeastMean = 0.02;  // of the fitted delay's, below which there is none
constexpr double kNoPart = 1e-12;    // residual of a column beside another, as a share of it, below which they are one
constexpr double kNearForce = 0.1;   // as kNearFreePower, of a force: it explains differences along one axis only, the true one comes nearer
constexpr std::size_t kBeside = 6;   // single fits beside which stochastic effects are tried
constexpr std::size_t kSeconds = 4;  // effects that are fitted beside the best stochastic one
constexpr double kWorthALook = 1.0;  // above the free power, before the effect is simulated
constexpr double kLeastFall = 20.0;  // of the residual power, for which draws are made
constexpr double kMuch = 1000.0;     // residual power of every other fit from which a second effect is looked for beside a stochastic one that is not near
constexpr double kLeastSecondGain = 40.0;  // fall of the residual power, forecast, for which a second effect is fitted

// The change without what is parallel to the columns.
Eigen::VectorXd without_columns(Eigen::VectorXd change, const std::vector<Eigen::VectorXd>& columns) {
  std::vector<Eigen::VectorXd> basis;
  for (Eigen::VectorXd column : columns) {
    const double whole = column.squaredNorm();
    for (const Eigen::VectorXd& unit : basis) column -= unit.dot(column) * unit;
    if (column.squaredNorm() <= kNoPart * whole) continue;
    basis.push_back(column.normalized());
  }
  for (const Eigen::VectorXd& unit : basis) change -= unit.dot(change) * unit;
  return change;
}

// Which of the effects is only what a stochastic one does on the average.
std::optional<std::size_t> mean_among(const common::EffectCatalogue& catalogue, const std::vector<common::EffectInstance>& effects) {
  for (std::size_t e = 0; e < effects.size(); ++e) {
    if (is_steady_delay(catalogue.at(effects[e].name))) return e;
  }
  return std::nullopt;
}

// A stochastic effect beside a fit.
struct Try {
  FitResult fit;             // without it
  std::optional<std::size_t> mean;  // mean_among its effects
  common::EffectInstance effect;
  PowerFit found;
  Power power;
  double mean_cost = 0.0;    // in -2 ln: that the draws' mean is not what was fitted

  bool is_alone() const { return fit.point.effects.size() == (mean ? 1U : 0U); }
};

// Draws at the size found, where the fit stands.
void look(Problem& problem, const std::vector<Eigen::VectorXd>& delays, Try& one) {
  Point still = one.fit.point;
  if (one.mean) still.effects.erase(still.effects.begin() + static_cast<std::ptrdiff_t>(*one.mean));
  const Eigen::VectorXd here = one.mean ? differences(problem, still) : one.fit.difference;
  const auto count = here.size();
  std::vector<Eigen::VectorXd> means;
  if (is_stochastic_delay(problem.catalogue.at(one.effect.name))) {
    for (const Eigen::VectorXd& delay : delays) means.push_back(delay.head(count));
  }
  if (one.mean) means.push_back(one.fit.difference - here);
  const common::EffectAbout& about = problem.catalogue.at(one.effect.name);
  // A power goes with its size only while that is small, so the size is bracketed until simulations of the effect have the power that is asked for.
  double least = 0.0, most = std::numeric_limits<double>::infinity(), nearest = most;
  common::EffectInstance effect = one.effect;
  for (int round = 0; round < kLooks; ++round) {
    std::vector<Point> points(kDraws, still);
    for (std::size_t draw = 0; draw < points.size(); ++draw) {
      points[draw].effects.push_back(effect);
      points[draw].seed = draw + 1;
    }
    std::vector<Eigen::VectorXd> changes = differences(problem, points);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
    for (Eigen::VectorXd& change : changes) {
      change -= here;
      const Eigen::VectorXd random = without_columns(change, means);
      mean += (change - random) / static_cast<double>(changes.size());
      change = random;
    }
    Power power = power_of(problem, changes);
    const PowerFit found = fit_power(one.fit.difference, power);
    if (found.scale == 0.0) return;
    const double off = std::fabs(std::log(found.scale));
    if (off < nearest) {
      nearest = off;
      one.effect = effect;
      one.found = found;
      one.power = std::move(power);
      // Where no delay was fitted, all of the mean is missed.
      if (one.mean) {
        const Eigen::VectorXd fitted = one.fit.difference - here;
        one.mean_cost = std::pow(std::log(std::max(kLeastMean, mean.dot(fitted) / fitted.squaredNorm())) / kMeanSpread, 2.0);
      } else {
        one.mean_cost = problem.settings.independent_share * divided({one.power, found.scale}, mean).squaredNorm();
      }
    }
    if (off < kSettledScale) break;
    const double size = effect.values[common::kSize];
    (found.scale > 1.0 ? least : most) = size;
    effect = with_power(about, std::move(effect), found.scale);
    double& next = effect.values[common::kSize];
    if (!(next > least && next < most)) {
      if (!(least > 0.0) || !std::isfinite(most)) break;  // at the end of its range
      next = std::sqrt(least * most);
    }
  }
  if (nearest < kNearScale) {
    one.effect = with_power(about, one.effect, one.found.scale);
  } else {
    one.found = power_at(one.fit.difference, one.power, 1.0);  // no size has that power
  }
}

// The fit with the stochastic effect in the place of its mean. `difference` and `columns` are the fit's, already divided.
FitResult with_stochastic_effect(const Problem& problem, const Try& one, const FitResult& fit, const Eigen::VectorXd& difference,
                      const Eigen::MatrixXd& columns, double logarithm_sum) {
  FitResult result;
  result.point.nuisance = fit.point.nuisance;
  result.point.effects = {one.effect};
  result.difference = difference;
  // The stochastic effect's own parameters have no columns.
  const auto nuisances = static_cast<Eigen::Index>(fit.point.nuisance.size());
  auto width = nuisances + static_cast<Eigen::Index>(one.effect.values.size());
  std::vector<std::pair<Eigen::Index, Eigen::Index>> kept;
  Eigen::Index from = nuisances;
  for (std::size_t e = 0; e < fit.point.effects.size(); ++e) {
    const auto size = static_cast<Eigen::Index>(fit.point.effects[e].values.size());
    if (one.mean != e) {
      result.point.effects.push_back(fit.point.effects[e]);
      kept.emplace_back(from, size);
      width += size;
    }
    from += size;
  }
  result.columns = Eigen::MatrixXd::Zero(difference.size(), width);
  result.columns.leftCols(nuisances) = columns.leftCols(nuisances);
  Eigen::Index to = nuisances + static_cast<Eigen::Index>(one.effect.values.size());
  for (const auto& [first, size] : kept) {
    result.columns.middleCols(to, size) = columns.middleCols(first, size);
    to += size;
  }
  conclude(problem, result);
  result.residual_power += problem.settings.independent_share * logarithm_sum;
  result.prior += one.mean_cost + kOccam * static_cast<double>(one.effect.values.size());
  result.cost = result.residual_power + result.prior;
  const common::EffectAbout& about = problem.catalogue.at(one.effect.name);
  for (std::size_t p = 0; p < one.effect.values.size(); ++p) {
    result.deviation[p] =
        p == common::kSize ? kStochasticSize * one.effect.values[p] : std::fabs(value_per_deviation(about.parameters[p], one.effect.values[p]));
  }
  return result;
}

Eigen::MatrixXd divided_columns(const AddedPower& added, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) result.col(c) = divided(added, columns.col(c));
  return result;
}

Eigen::MatrixXd divided_nuisance_columns(const AddedPower& added, const FitResult& fit) {
  return divided_columns(added, fit.columns.leftCols(static_cast<Eigen::Index>(fit.point.nuisance.size())));
}

// A fit under an added power: what was fitted without it knew nothing of it.
FitResult fit_under_power(Problem& problem, const Eigen::MatrixXd& nuisance_columns, const Point& start) {
  FitResult result = fit(problem, nuisance_columns, start);
  improve(problem, result, false);
  return result;
}

// The axes of every effect that was screened, from its best start.
using EffectAxes = std::map<std::string, std::vector<ChannelAxes>>;
EffectAxes screened_axes(Problem& problem, const Screening& screening, Eigen::Index count) {
  const std::vector<const Screened*> best = best_of_each(screening);
  std::vector<std::vector<ChannelAxes>> axes(best.size());
  share_out(problem, best.size(), [&](std::size_t i) { axes[i] = axes_of(problem, std::vector<Eigen::VectorXd>{best[i]->column.head(count)}); });
  EffectAxes by_effect;
  for (std::size_t i = 0; i < best.size(); ++i) by_effect[best[i]->start.name] = std::move(axes[i]);
  return by_effect;
}

// Whether a free power costs more along every other effect's axes. One channel alone says nothing of axes.
bool has_best_axes(const Problem& problem, const EffectAxes& axes, const std::string& effect, const Eigen::VectorXd& difference) {
  const auto left_along = [&](const std::vector<ChannelAxes>& records) { return free_power(problem, along_axes(records, difference)).cost; };
  const double own = left_along(axes.at(effect));
  return std::none_of(axes.begin(), axes.end(), [&](const auto& other) { return other.first != effect && left_along(other.second) <= own; });
}

// A stochastic effect beside a fit, with what its power comes to there.
struct Second {
  FitResult fit;
  Try one;
};

// Where a fit stands under an added power, the effect has to add less than it had to before: draws there, and a fit with their power.
Second fit_closer(Problem& problem, const std::vector<Eigen::VectorXd>& delays, Try one) {
  one.found = fit_power(one.fit.difference, one.power);
  look(problem, delays, one);
  const AddedPower closer{one.power, one.found.scale};
  FitResult result;
  {
    const UnderPower under_power(problem, closer);
    result = fit_under_power(problem, divided_nuisance_columns(closer, one.fit), one.fit.point);
  }
  const double logarithm_sum = logarithms(closer);
  one.fit.point = result.point;
  one.fit.difference = undivided(closer, result.difference);
  one.found.cost = result.difference.squaredNorm() + logarithm_sum;
  FitResult with = with_stochastic_effect(problem, one, result, result.difference, result.columns, logarithm_sum);
  return {std::move(with), std::move(one)};
}

// The stochastic effect alone again, and with a second effect beside it.
std::vector<Second> seconds(Problem& problem, const Screening& catalogue, const Try& one, const std::vector<Eigen::VectorXd>& delays,
                            const Progress& tell) {
  std::vector<Second> results{fit_closer(problem, delays, one)};
  const Try alone = results.front().one;
  const AddedPower added{alone.power, alone.found.scale};
  std::vector<FitResult> under;
  {
    FitResult here = one.fit;
    here.point = alone.fit.point;
    here.difference = divided(added, alone.fit.difference);
    here.columns = divided_columns(added, one.fit.columns);
    const Projector project(here.columns, prior_rows(problem, here.point), data_weight(here.difference, problem.settings));
    std::vector<common::EffectInstance> starts = best_starts(problem, catalogue);
    std::erase_if(starts, [&](const common::EffectInstance& start) {
      return is_stochastic(problem.catalogue.at(start.name)) || (is_stochastic_delay(problem.catalogue.at(one.effect.name)) && is_steady_delay(problem.catalogue.at(start.name)));
    });
    const UnderPower under_power(problem, added);
    const Screening screening = screen(problem, here, project, starts, tell);
    std::vector<const Screened*> ranked;
    for (const Screened& screened : screening.tried) {
      const double gain = problem.settings.independent_share * (screening.gap.squaredNorm() - screened.left);
      if (gain >= kLeastSecondGain) ranked.push_back(&screened);
    }
    ranked = best_of_each(std::move(ranked));
    // The stochastic effect alone goes on as well: what farther parameters take away is not the second effect's.
    std::vector<Point> from{here.point};
    for (std::size_t i = 0; i < std::min(kSeconds, ranked.size()); ++i) {
      from.push_back(with_amount(problem.catalogue, here.point, *ranked[i], ranked[i]->amount));
    }
    const Eigen::MatrixXd nuisance_columns = divided_nuisance_columns(added, one.fit);
    under.resize(from.size());
    share_out(problem, under.size(), [&](std::size_t i) { under[i] = fit_under_power(problem, nuisance_columns, from[i]); });
  }
  for (const FitResult& start : under) {
    Try next = alone;
    next.fit.point = start.point;
    next.fit.difference = differences(problem, start.point);
    results.push_back(fit_closer(problem, delays, std::move(next)));
  }
  return results;
}

// What the stochastic effects are tried beside.
struct Ground {
  std::vector<Eigen::VectorXd> delays;    // columns of the steady delays that were screened
  std::vector<const FitResult*> besides;  // that of parameters alone first
  FreePower free;                         // the cheapest free power beside any fit
};

Ground ground_of(Problem& problem, const Screening& screening, const FitResult& nothing, const std::vector<FitResult>& fits) {
  Ground ground{.delays = {}, .besides = {&nothing}, .free = free_power(problem, nothing.difference)};
  for (const Screened& screened : screening.tried) {
    if (is_steady_delay(problem.catalogue.at(screened.start.name))) ground.delays.push_back(screened.column);
  }
  std::size_t singles = 0;
  for (const FitResult& result : fits) {
    const FreePower of_this = free_power(problem, result.difference);
    if (of_this.cost < ground.free.cost) ground.free = of_this;
    const std::vector<common::EffectInstance>& effects = result.point.effects;
    if (mean_among(problem.catalogue, effects) || (effects.size() == 1 && singles++ < kBeside)) ground.besides.push_back(&result);
  }
  return ground;
}

// A start of a stochastic effect: the power of its draws in the screening, and how much of it each fit of the ground has.
struct DrawnStart {
  const Screened* start = nullptr;
  Power power;
  std::vector<PowerFit> found;
};

std::vector<DrawnStart> drawn_powers(Problem& problem, const Screening& screening, const Ground& ground) {
  const auto count = ground.besides.front()->difference.size();
  std::vector<DrawnStart> drawn;
  for (const Screened& screened : screening.tried) {
    if (is_stochastic(problem.catalogue.at(screened.start.name))) drawn.push_back({.start = &screened, .power = {}, .found = {}});
  }
  share_out(problem, drawn.size(), [&](std::size_t i) {
    DrawnStart& one = drawn[i];
    const common::EffectAbout& about = problem.catalogue.at(one.start->start.name);
    const Eigen::VectorXd& column = one.start->column;
    one.power = power_of(
        problem, std::vector<Eigen::VectorXd>{(is_stochastic_delay(about) ? without_columns(column, ground.delays) : column).head(count)});
    const PowerScales scales(one.power);
    const double most = largest_scale(about, one.start->start);
    for (const FitResult* beside : ground.besides) {
      PowerFit here = scales.fit(beside->difference);
      if (here.scale > most) here = power_at(beside->difference, one.power, most);
      one.found.push_back(here);
    }
  });
  return drawn;
}

// The place of the best power among those drawn, by the effect and the place of the fit among the ground's. No fit is copied before it is
// known to be worth it.
using BestDrawn = std::map<std::pair<std::string, std::size_t>, std::size_t>;
BestDrawn best_of_drawn(const std::vector<DrawnStart>& drawn) {
  BestDrawn best;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    for (std::size_t b = 0; b < drawn[i].found.size(); ++b) {
      const PowerFit& found = drawn[i].found[b];
      if (found.scale == 0.0) continue;
      const auto [entry, is_new] = best.try_emplace({drawn[i].start->start.name, b}, i);
      if (!is_new && found.cost < drawn[entry->second].found[b].cost) entry->second = i;
    }
  }
  return best;
}

// Of each stochastic effect beside each fit the best power, drawn again where the fit stands.
std::list<Try> tries_of(Problem& problem, const Ground& ground, const std::vector<DrawnStart>& drawn, const Progress& tell) {
  const BestDrawn best = best_of_drawn(drawn);
  const auto count = ground.besides.front()->difference.size();
  std::list<Try> tries;
  std::size_t told = 0;
  for (const auto& [key, i] : best) {
    const auto& [name, b] = key;
    tell(static_cast<double>(told++) / static_cast<double>(best.size()), "drawing " + name);
    const FitResult& beside = *ground.besides[b];
    const PowerFit& found = drawn[i].found[b];
    const double fall = problem.settings.independent_share * (beside.difference.squaredNorm() - found.cost);
    if (fall < kLeastFall || above_free_power(found, ground.free, count) >= kWorthALook) continue;
    const common::EffectAbout& about = problem.catalogue.at(name);
    const std::optional<std::size_t> mean = is_stochastic_delay(about) ? mean_among(problem.catalogue, beside.point.effects) : std::nullopt;
    tries.push_back({beside, mean, with_power(about, drawn[i].start->start, found.scale), found, drawn[i].power});
    look(problem, ground.delays, tries.back());
  }
  return tries;
}

bool is_near_enough(const Problem& problem, const Try& one, const FreePower& least) {
  const double limit = is_stochastic_delay(problem.catalogue.at(one.effect.name)) ? kNearFreePower : kNearForce;
  return above_free_power(one.found, least, one.fit.difference.size()) < limit;
}

// What is near enough with a second effect is offered without it too: the second one may only stand for what laws differ in.
// `near` are the effects whose power comes near enough, alone or beside another.
bool may_be_it(const Problem& problem, const std::set<std::string>& near, const Try& one, const FreePower& least) {
  return is_near_enough(problem, one, least) || (one.is_alone() && near.contains(one.effect.name));
}

bool is_cheaper(const Try& one, const Try* other) {
  return other == nullptr || one.found.cost + one.mean_cost < other->found.cost + other->mean_cost;
}

// Which tries are candidates as they stand, and which are fitted closer.
struct Sorted {
  std::vector<const Try*> near;                 // with their powers, in the order of the tries
  std::map<std::string, const Try*> alone_of;   // the best of each effect alone
  const Try* alone = nullptr;                   // the best of these
  const Try* beside_another = nullptr;          // the best that is not near, where nothing is
};

Sorted sorted(const Problem& problem, const std::list<Try>& tries, const std::set<std::string>& near, const FreePower& free, bool much_is_left) {
  Sorted result;
  for (const Try& one : tries) {
    const bool is_alone = one.is_alone(), is_near = may_be_it(problem, near, one, free);
    if (is_near) result.near.push_back(&one);
    if (!is_near && !(near.empty() && much_is_left)) continue;
    if (is_alone) {
      const Try*& best = result.alone_of[one.effect.name];
      if (is_cheaper(one, best)) best = &one;
    }
    if (!is_alone && !is_near && is_cheaper(one, result.beside_another)) result.beside_another = &one;
  }
  for (const auto& [name, one] : result.alone_of) {
    if (is_cheaper(*one, result.alone)) result.alone = one;
  }
  return result;
}

// The cheapest fit of each set of effects. Low frequencies say of any force little more than that it turns the crane: such an effect must be the
// one whose axes fit best.
class BestOfEachSet {
 public:
  BestOfEachSet(Problem& problem, const Screening& screening) : problem_(problem), screening_(screening) {}

  void keep(const Try& one, FitResult result) {
    if (!is_stochastic_delay(problem_.catalogue.at(one.effect.name))) {
      if (axes_.empty()) axes_ = screened_axes(problem_, screening_, one.fit.difference.size());
      if (!has_best_axes(problem_, axes_, one.effect.name, one.fit.difference)) return;
    }
    std::set<std::string> names;
    for (const common::EffectInstance& effect : result.point.effects) names.insert(effect.name);
    const auto [entry, is_new] = best_.try_emplace(names, result);
    if (!is_new && result.cost < entry->second.cost) entry->second = std::move(result);
  }

  std::vector<FitResult> take() {
    std::vector<FitResult> results;
    for (auto& [names, result] : best_) results.push_back(std::move(result));
    return results;
  }

 private:
  Problem& problem_;
  const Screening& screening_;
  EffectAxes axes_;  // made where they are asked for
  std::map<std::set<std::string>, FitResult> best_;
};

}  // namespace

std::vector<FitResult> stochastic_fits(Problem& problem, const Screening& screening, const FitResult& nothing,
                                   const std::vector<FitResult>& fits, const Progress& tell) {
  const Ground ground = ground_of(problem, screening, nothing, fits);
  const std::list<Try> tries = tries_of(problem, ground, drawn_powers(problem, screening, ground), within(tell, {0.0, 0.5}));
  std::set<std::string> near;
  for (const Try& one : tries) {
    if (is_near_enough(problem, one, ground.free)) near.insert(one.effect.name);
  }
  // Where no power is near and all residuals are large, a second effect may be what is too much for the best of them alone.
  const bool much_is_left = std::all_of(fits.begin(), fits.end(), [](const FitResult& result) { return result.residual_power > kMuch; });
  const Sorted candidates = sorted(problem, tries, near, ground.free, much_is_left);

  BestOfEachSet best(problem, screening);
  for (const Try* one : candidates.near) {
    const AddedPower added{one->power, one->found.scale};
    best.keep(*one, with_stochastic_effect(problem, *one, one->fit, divided(added, one->fit.difference),
                                           divided_columns(added, one->fit.columns), logarithms(added)));
  }
  const auto keep_if_near = [&](Second second) {
    const FreePower here = free_power(problem, second.one.fit.difference);
    if (may_be_it(problem, near, second.one, here.cost < ground.free.cost ? here : ground.free)) best.keep(second.one, std::move(second.fit));
  };
  for (const auto& [name, one] : candidates.alone_of) {
    if (one != candidates.alone && may_be_it(problem, near, *one, ground.free)) keep_if_near(fit_closer(problem, ground.delays, *one));
  }
  if (candidates.alone != nullptr) {
    const auto tell_second = [&, second = within(tell, {0.5, 1.0})](double share, const std::string& doing) {
      second(share, doing + " beside " + candidates.alone->effect.name);
    };
    for (Second& second : seconds(problem, screening, *candidates.alone, ground.delays, tell_second)) keep_if_near(std::move(second));
  }
  if (candidates.beside_another != nullptr) keep_if_near(fit_closer(problem, ground.delays, *candidates.beside_another));
  return best.take();
}

}  // namespace slewlab::diagnosis
