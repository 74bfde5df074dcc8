#include "diagnosis/cause.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/unit.h"
#include "diagnosis/stochastic.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNinetyPercent = 1.645;       // standard deviations of a normal 90 % interval
constexpr double kIndistinguishable = 0.97;    // cosine of two signatures, nuisances taken out
constexpr double kGroupOdds = 20.0;            // of two causes' probabilities, beyond which the records tell them apart
constexpr double kWorthAGroup = 0.005;         // probability of a pair below which its group is not looked for
constexpr double kLawShare = 0.05;             // relative standard deviation of a size by its law: learned, docs/diagnosis/method.md
constexpr double kCurvatureFactor = 1.7;       // of the standard deviations that the curvature gives: learned as well

}  // namespace

std::vector<Size> sizes_of(const common::EffectCatalogue& catalogue, const std::vector<common::EffectInstance>& effects,
                           const std::vector<double>& deviations) {
  std::vector<Size> sizes;
  std::size_t k = 0;
  for (const common::EffectInstance& effect : effects) {
    const common::EffectAbout& about = catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p, ++k) {
      const common::EffectParameter& parameter = about.parameters[p];
      const double value = effect.values[p];
      // No law is quite the machine's: its size is not known better than that, however well it fits.
      const double deviation = std::hypot(kCurvatureFactor * deviations[k], kLawShare * value);
      Size size{fmt::format("{}.{}", effect.name, parameter.name), std::string(common::name_of(parameter.unit)), value,
                deviation, 0.0, 0.0};
      if (parameter.scale == common::ParameterScale::logarithmic) {
        const double factor = std::exp(kNinetyPercent * deviation / std::max(1e-300, std::fabs(value)));
        size.low = value / factor;
        size.high = value * factor;
      } else {
        size.low = value - kNinetyPercent * deviation;
        size.high = value + kNinetyPercent * deviation;
      }
      // A size that goes beyond its range is doubted (doubt.h); a shape is what it can be.
      if (p != common::kSize && !is_all_round(parameter)) {
        size.low = std::max(size.low, parameter.lower);
        size.high = std::min(size.high, parameter.upper);
      }
      // All round is any direction; less than that may go beyond where angles are counted from.
      if (is_all_round(parameter) && size.high - size.low >= 2.0 * std::numbers::pi) {
        size.low = -std::numbers::pi;
        size.high = std::numbers::pi;
      }
      if (p == common::kSize && parameter.absent && std::isfinite(*parameter.absent)) {
        const double away = std::fabs(to_coordinate(parameter, value) - to_coordinate(parameter, *parameter.absent)), told = std::fabs(value_per_deviation(parameter, value)) * away;
        size.may_be_none = told <= kNinetyPercent * kCurvatureFactor * deviations[k];
      }
      sizes.push_back(size);
    }
  }
  return sizes;
}

std::string name_of(const std::vector<std::string>& effects) {
  if (effects.empty()) return "only parameters are off";
  std::string name = effects[0];
  for (std::size_t e = 1; e < effects.size(); ++e) name += " with " + effects[e];
  return name;
}

std::string name_of(const Cause& cause) { return name_of(cause.effects); }

std::string told_name(const Cause& cause) {
  std::string name = name_of(cause);
  for (const std::vector<std::string>& other : cause.also) name += " or " + name_of(other);
  return name;
}

Cause make_cause(const common::EffectCatalogue& catalogue, const FitResult& result) {
  Cause cause;
  for (const common::EffectInstance& effect : result.point.effects) cause.effects.push_back(effect.name);
  cause.point = result.point;
  cause.mean_square = result.mean_square;
  cause.residual_power = result.residual_power;
  cause.prior = result.prior;
  cause.information = result.information;
  cause.ending = result.ending;
  cause.sizes = sizes_of(catalogue, result.point.effects, result.deviation);
  for (std::size_t k = 0; k < result.nuisance_deviation.size(); ++k) {
    const double amount = result.point.nuisance[k], reach = kNinetyPercent * kCurvatureFactor * result.nuisance_deviation[k];
    cause.parameter_intervals.push_back({amount - reach, amount + reach});
  }
  return cause;
}

void find_groups(const Problem& problem, const FitResult& base, const Projector& project, const std::vector<FitResult>& fits,
                 std::span<const double> probability, std::span<Cause> causes) {
  struct Signature {
    std::size_t fit;
    std::string beside;  // the effect shared; none of single causes
    Eigen::VectorXd column;
  };
  std::vector<Signature> signatures;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (fits[k].point.effects.size() != 1) continue;
    signatures.push_back({k, "", project(fits[k].difference - base.difference)});
    if (fits[k].columns.size() == 0) continue;
    const std::string& shared = fits[k].point.effects[0].name;
    std::optional<Projector> beside;
    for (std::size_t i = 0; i < fits.size(); ++i) {
      const std::vector<common::EffectInstance>& effects = fits[i].point.effects;
      const bool is_pair = effects.size() == 2 && probability[i] > kWorthAGroup && has_effect(effects, shared);
      if (!is_pair || is_stochastic(problem.catalogue.at(effects[0].name)) || is_stochastic(problem.catalogue.at(effects[1].name))) continue;
      if (!beside) beside.emplace(fits[k].columns, prior_rows(problem, fits[k].point), data_weight(fits[k].difference, problem.settings));
      signatures.push_back({i, shared, (*beside)(fits[i].difference - fits[k].difference)});
    }
  }
  for (const Signature& one : signatures) {
    Cause& cause = causes[one.fit];
    for (const Signature& other : signatures) {
      if (other.fit == one.fit || other.beside != one.beside) continue;
      const double scale = one.column.norm() * other.column.norm();
      if (scale <= 0.0) continue;
      const double cosine = std::fabs(one.column.dot(other.column)) / scale;
      const double odds = probability[other.fit] / std::max(1e-300, probability[one.fit]);
      if (cosine > kIndistinguishable && odds < kGroupOdds && odds > 1.0 / kGroupOdds) {
        cause.group.push_back({name_of(causes[other.fit]), std::sqrt(std::max(0.0, 1.0 - cosine * cosine))});
      }
    }
  }
}

}  // namespace slewlab::diagnosis
