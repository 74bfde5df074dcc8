#include "diagnosis/cause.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/unit.h"
#include "diagnosis/stochastic.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNinetyPercent = 1.645;       // standard deviations of a normal 90 % interval
constexpr double kIndistinguishable = 0.97;    // cosine of two signatures, nuisances taken out
constexpr double kGroupOdds = 20.0;            // of two causes' probabilities, beyond which the records tell them apart
constexpr double kWorthAGroup = 0.005;         // probability of a pair below which its group is not looked for
constexpr double kThirdPrior = 0.1;            // chosen: of three effects at once, against two
constexpr double kControllerExplained = 0.01;  // share of its difference that an effect of a controller may leave, to be the right one
constexpr double kControllerTold = 1e-3;       // the same, to be that surely: answers are computed, not measured, and the right law leaves what was rounded; chosen, below what wrong ones left
constexpr double kLawShare = 0.05;             // relative standard deviation of a size by its law: learned, docs/diagnosis/method.md
constexpr double kCurvatureFactor = 1.7;       // of the standard deviations that the curvature gives: learned as well
constexpr double kCountError = 1e-3;           // relative, of a quantum found in the positions
constexpr double kSure = 0.98;                 // probability of what needs no fit, or leaves next to nothing
constexpr double kUnlikely = 0.02;             // probability of what was left out, or leaves much
constexpr double kPerhaps = 0.6;               // chosen: of what leaves more than it should, and little
constexpr double kNegligible = 1e-4;           // probability of a part that is not combined further

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
      // A size that goes beyond its range is doubted (diagnose.cpp); a shape is what it can be.
      if (p != common::kSize && !is_all_round(parameter)) {
        size.low = std::max(size.low, parameter.lower);
        size.high = std::min(size.high, parameter.upper);
      }
      sizes.push_back(size);
    }
  }
  return sizes;
}

// The effect whose size a record shows so; nullptr where the catalogue has none.
const common::EffectAbout* read_off(const common::EffectCatalogue& catalogue, common::ReadOff from) {
  for (const common::EffectAbout& about : catalogue.effects) {
    if (about.read_off == from) return &about;
  }
  return nullptr;
}

// Every cause gets the found effect beside what it has. `known` is the probability that it is the catalogue's.
void add_beside(const common::EffectInstance& effect, const std::vector<Size>& sizes, double known, Ranking& ranking) {
  for (Cause& cause : ranking.causes) {
    cause.effects.push_back(effect.name);
    cause.point.effects.push_back(effect);
    cause.probability *= known;
    for (Alike& other : cause.group) other.name += " with " + effect.name;
    for (std::vector<std::string>& other : cause.also) other.push_back(effect.name);
    cause.sizes.insert(cause.sizes.end(), sizes.begin(), sizes.end());
  }
  ranking.unknown = 1.0 - (1.0 - ranking.unknown) * known;
}

}  // namespace

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
  cause.excess = result.excess;
  cause.prior = result.prior;
  cause.information = result.information;
  cause.ending = result.ending;
  cause.sizes = sizes_of(catalogue, result.point.effects, result.deviation);
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

void merge_same_motion(const std::map<std::string, std::string>& same_as, Ranking& ranking) {
  std::map<std::vector<std::string>, std::size_t> places;
  std::vector<Cause> merged;
  for (Cause& cause : ranking.causes) {
    std::vector<std::string> motion;
    for (const std::string& effect : cause.effects) {
      const auto same = same_as.find(effect);
      motion.push_back(same != same_as.end() ? same->second : effect);
    }
    std::sort(motion.begin(), motion.end());
    const auto [place, is_new] = places.try_emplace(std::move(motion), merged.size());
    if (is_new) {
      merged.push_back(std::move(cause));
      continue;
    }
    merged[place->second].probability += cause.probability;
    merged[place->second].also.push_back(cause.effects);
  }
  ranking.causes = std::move(merged);
}

double add_counts(const Problem& problem, std::span<const std::string> without, Ranking& ranking) {
  double quantum = 0.0;
  for (const Record& record : problem.records) quantum = std::max(quantum, record.encoder_quantum);
  const common::EffectAbout* const counts = read_off(problem.catalogue, common::ReadOff::encoder_counts);
  if (quantum < kCoarseCount || counts == nullptr || has_effect(problem.nominal.effects, counts->name)) return 0.0;
  common::EffectInstance effect = common::typical_instance(*counts);
  effect.values[common::kSize] = quantum;
  std::vector<double> deviations(effect.values.size(), 0.0);
  deviations[common::kSize] = kCountError * quantum;
  const bool left_out = std::find(without.begin(), without.end(), counts->name) != without.end();
  add_beside(effect, sizes_of(problem.catalogue, {effect}, deviations), left_out ? kUnlikely : kSure, ranking);
  return quantum;
}

namespace {

// That the best of a controller's effects is what it has.
double chance_of_the_best(const std::vector<ControllerCause>& parts) {
  if (parts.empty() || parts.front().share_left > kControllerExplained) return kUnlikely;
  return parts.front().share_left > kControllerTold ? kPerhaps : kSure;
}

}  // namespace

void add_controller_causes(const common::EffectCatalogue& catalogue, const std::vector<ControllerCause>& parts, Ranking& ranking) {
  const double known = chance_of_the_best(parts);
  std::vector<Cause> combined;
  for (const ControllerCause& part : parts) {
    if (part.probability < kNegligible) continue;
    for (const Cause& cause : ranking.causes) {
      if (cause.effects.size() + part.effects.size() > 2) continue;
      Cause both = cause;
      for (const common::EffectInstance& effect : part.effects) both.effects.push_back(effect.name);
      for (const common::EffectInstance& effect : part.effects) {
        for (Alike& other : both.group) other.name += " with " + effect.name;
        for (std::vector<std::string>& other : both.also) other.push_back(effect.name);
      }
      both.controller_effects = part.effects;
      both.probability *= part.probability * known;
      const std::vector<Size> sizes = sizes_of(catalogue, part.effects, part.deviation);
      both.sizes.insert(both.sizes.end(), sizes.begin(), sizes.end());
      combined.push_back(both);
    }
  }
  ranking.unknown = 1.0 - (1.0 - ranking.unknown) * known;
  // What needs a third effect is not looked for, and rare; what it has goes to what is not known.
  double two = 0.0;
  for (const Cause& cause : combined) two += cause.probability;
  const double three = std::max(0.0, 1.0 - ranking.unknown - two);
  const double share = (1.0 - ranking.unknown) / (two + kThirdPrior * three);
  for (Cause& cause : combined) cause.probability *= share;
  ranking.unknown = 1.0 - share * two;
  ranking.causes = std::move(combined);
}

}  // namespace slewlab::diagnosis
