#include "diagnosis/chance_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "diagnosis/chance.h"
#include "diagnosis/nuisance.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kChanceSize = 0.2;  // relative standard deviation of a size that is found from the power of one draw
constexpr int kLooks = 2;            // at the power of the size just found
constexpr std::uint64_t kDraws = 3;  // of which a look takes the mean power
constexpr double kMeanSpread = 0.4;  // of the logarithm of the mean that a draw's power goes with: laws differ
constexpr double kLeastMean = 0.02;  // of the fitted delay's, below which there is none
constexpr double kNoPart = 1e-12;    // share of a column that another leaves, below which they are one
constexpr std::size_t kBeside = 6;   // single fits beside which chance is tried

// The change without what is parallel to the columns.
Eigen::VectorXd without(Eigen::VectorXd change, const std::vector<Eigen::VectorXd>& columns) {
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

struct Beside {
  const FitResult* fit;
  std::size_t mean;  // which of its effects is only the mean of the chance; beyond the last: none
};

struct Try {
  Beside beside{};
  common::EffectInstance effect;
  ChanceFit chance{};
  Eigen::VectorXd profile;
  double mean_cost = 0.0;  // in -2 ln: that the draws' mean is not what was fitted
};

// The mean of the draws against the delay that was fitted; where none was, all of it is missed.
double cost_of_mean(const Eigen::VectorXd& fitted, const Eigen::VectorXd& mean, const ChanceFit& chance, const Eigen::VectorXd& profile) {
  if (fitted.size() == 0) return (mean.array().square() / (1.0 + chance.scale * profile.array())).sum();
  const double ratio = std::max(kLeastMean, mean.dot(fitted) / fitted.squaredNorm());
  return std::pow(std::log(ratio) / kMeanSpread, 2.0);
}

}  // namespace

std::vector<FitResult> chance_fits(Problem& problem, const Base& base, const Screening& screening,
                                   const FitResult& nothing, const std::vector<FitResult>& fits) {
  std::vector<Eigen::VectorXd> delays;
  for (const Screened& screened : screening.tried) {
    if (is_mean_of_chance(screened.start.name)) delays.push_back(screened.column);
  }
  FreePower free = free_power(problem, nothing.difference);
  std::vector<Beside> besides{{&nothing, 0}};
  std::size_t singles = 0;
  for (const FitResult& result : fits) {
    const FreePower of_this = free_power(problem, result.difference);
    if (of_this.cost < free.cost) free = of_this;
    const std::vector<common::EffectInstance>& effects = result.point.effects;
    const auto mean = std::find_if(effects.begin(), effects.end(), [](const auto& effect) { return is_mean_of_chance(effect.name); });
    const bool is_single = effects.size() == 1 && singles++ < kBeside;
    if (is_single || mean != effects.end()) besides.push_back({&result, static_cast<std::size_t>(mean - effects.begin())});
  }
  // Of each effect by chance and each fit the best profile of the screening.
  std::map<std::pair<std::string, const FitResult*>, Try> tries;
  for (const Screened& screened : screening.tried) {
    if (!comes_by_chance(screened.start.name)) continue;
    const Eigen::VectorXd profile = power_profile(problem, without(screened.column, delays).head(base.difference.size()));
    for (const Beside& beside : besides) {
      const ChanceFit chance = fit_chance(beside.fit->difference, profile);
      if (chance.scale == 0.0) continue;
      Try& best = tries.try_emplace({screened.start.name, beside.fit}, Try{beside, screened.start, {0.0, 1e300}, profile}).first->second;
      if (chance.cost < best.chance.cost) best = {beside, with_power(screened.start, chance.scale), chance, profile};
    }
  }
  std::map<std::set<std::string>, FitResult> best;
  for (auto& [key, one] : tries) {
    const auto count = base.difference.size();
    if (!is_worth_a_look(one.chance, free, count)) continue;
    // Draws at the size found, where the fit stands; what they do on the average is a delay.
    const FitResult& fit = *one.beside.fit;
    Point still = fit.point;
    const bool has_mean = one.beside.mean < still.effects.size();
    if (has_mean) still.effects.erase(still.effects.begin() + static_cast<std::ptrdiff_t>(one.beside.mean));
    const Eigen::VectorXd here = has_mean ? differences(problem, still) : fit.difference;
    std::vector<Eigen::VectorXd> means;
    for (const Eigen::VectorXd& delay : delays) means.push_back(delay.head(count));
    if (has_mean) means.push_back(fit.difference - here);
    for (int look = 0; look < kLooks; ++look) {
      std::vector<Point> points(kDraws, still);
      for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
        points[draw].effects.push_back(one.effect);
        points[draw].seed = draw + 1;
      }
      Eigen::VectorXd profile = Eigen::VectorXd::Zero(count), mean = Eigen::VectorXd::Zero(count);
      for (const Eigen::VectorXd& drawn : differences(problem, points)) {
        const Eigen::VectorXd change = drawn - here, random = without(change, means);
        profile += power_profile(problem, random) / static_cast<double>(kDraws);
        mean += (change - random) / static_cast<double>(kDraws);
      }
      const ChanceFit chance = fit_chance(fit.difference, profile);
      if (chance.scale == 0.0) break;
      if (chance.cost < one.chance.cost || look == 0) {
        one.chance = chance;
        one.profile = profile;
        one.mean_cost = cost_of_mean(has_mean ? Eigen::VectorXd(fit.difference - here) : Eigen::VectorXd(), mean, chance, profile);
      }
      one.effect = with_power(one.effect, chance.scale);
    }
    if (!is_near_free_power(one.chance, free, count)) continue;

    FitResult result;
    result.point = still;
    result.point.effects.insert(result.point.effects.begin(), one.effect);
    const Eigen::VectorXd deviation = (1.0 + one.chance.scale * one.profile.array()).sqrt();
    result.difference = fit.difference.cwiseQuotient(deviation);
    const auto nuisances = static_cast<Eigen::Index>(fit.point.nuisance.size());
    // Columns of the chance's own parameters: none; of the other effect: as fitted.
    auto from = nuisances, to = nuisances + static_cast<Eigen::Index>(one.effect.values.size());
    auto others = to;
    for (const common::EffectInstance& effect : still.effects) others += static_cast<Eigen::Index>(effect.values.size());
    result.columns = Eigen::MatrixXd::Zero(count, others);
    result.columns.leftCols(nuisances) = deviation.cwiseInverse().asDiagonal() * fit.columns.leftCols(nuisances);
    for (std::size_t e = 0; e < fit.point.effects.size(); ++e) {
      const auto size = static_cast<Eigen::Index>(fit.point.effects[e].values.size());
      if (e != one.beside.mean) {
        result.columns.middleCols(to, size) = deviation.cwiseInverse().asDiagonal() * fit.columns.middleCols(from, size);
        to += size;
      }
      from += size;
    }
    conclude(problem, result);
    result.excess = problem.settings.independent_share * (one.chance.cost - static_cast<double>(count));
    if (has_mean) {
      result.prior += one.mean_cost;
    } else {
      result.excess += problem.settings.independent_share * one.mean_cost;
    }
    result.cost = result.excess + result.prior;
    const common::EffectAbout& about = about_effect(one.effect.name);
    for (std::size_t p = 0; p < one.effect.values.size(); ++p) {
      result.deviation[p] = p == 0 ? kChanceSize * one.effect.values[p]
                                   : std::fabs(value_per_deviation(about.parameters[p], one.effect.values[p]));
    }
    std::set<std::string> names;
    for (const common::EffectInstance& effect : result.point.effects) names.insert(effect.name);
    const auto [entry, is_new] = best.try_emplace(names, result);
    if (!is_new && result.cost < entry->second.cost) entry->second = std::move(result);
  }
  std::vector<FitResult> found;
  for (auto& [names, result] : best) found.push_back(std::move(result));
  return found;
}

}  // namespace slewlab::diagnosis
