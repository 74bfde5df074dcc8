#include "diagnosis/ranking.h"

#include <algorithm>
#include <set>
#include <utility>

#include "diagnosis/record.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kThirdPrior = 0.1;            // chosen: of three effects at once, against two
constexpr double kControllerExplained = 0.01;  // largest residual of the right effect of a controller, as a share of its difference
constexpr double kControllerTold = 1e-3;       // and to be that surely: answers are computed, not measured, so the right law's residual is rounding; chosen, below those of wrong ones
constexpr double kCountError = 1e-3;           // relative, of a quantum found in the positions
constexpr double kSure = 0.98;                 // probability of what needs no fit, or has next to no residual
constexpr double kUnlikely = 0.02;             // probability of what was left out, or has a large residual
constexpr double kPerhaps = 0.6;               // chosen: of what has a larger residual than it should, and a small one
constexpr double kNegligible = 1e-4;           // probability of a part that is not combined further

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

// That the best of a controller's effects is what it has.
double chance_of_the_best(const std::vector<ControllerCause>& parts) {
  if (parts.empty() || parts.front().share_left > kControllerExplained) return kUnlikely;
  return parts.front().share_left > kControllerTold ? kPerhaps : kSure;
}

}  // namespace

void sort_causes(std::vector<Cause>& causes) {
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) { return a.probability > b.probability; });
  std::set<std::string> names;
  for (const Cause& cause : causes) names.insert(name_of(cause));
  for (Cause& cause : causes) std::erase_if(cause.group, [&](const Alike& other) { return !names.contains(other.name); });
}

Cause* nothing_missing(Ranking& ranking) {
  const auto nothing = std::find_if(ranking.causes.begin(), ranking.causes.end(), [](const Cause& one) { return one.effects.empty(); });
  return nothing == ranking.causes.end() ? nullptr : &*nothing;
}

void take_away(double share, bool is_nothing_left, Cause& cause, Ranking& ranking) {
  const double taken = share * cause.probability;
  cause.probability -= taken;
  Cause* const nothing = nothing_missing(ranking);
  (is_nothing_left && nothing != nullptr ? nothing->probability : ranking.unknown) += taken;
}

void hand_on(double share, const std::function<bool(const std::string&)>& is_doubted, bool is_nothing_left, Cause& cause, Ranking& ranking) {
  const auto has_the_rest = [&](const Cause& other) {
    return &other != &cause && !other.effects.empty() && !(other.validation && !other.validation->holds) &&
           std::all_of(cause.effects.begin(), cause.effects.end(), [&](const std::string& effect) {
             return is_doubted(effect) || std::find(other.effects.begin(), other.effects.end(), effect) != other.effects.end();
           });
  };
  const bool has_rest = !std::all_of(cause.effects.begin(), cause.effects.end(), is_doubted);
  double sum = 0.0;
  for (const Cause& other : ranking.causes) sum += has_rest && has_the_rest(other) ? other.probability : 0.0;
  if (!(sum > 0.0)) return take_away(share, is_nothing_left, cause, ranking);
  const double taken = share * cause.probability;
  cause.probability -= taken;
  for (Cause& other : ranking.causes) {
    if (has_the_rest(other)) other.probability += taken * other.probability / sum;
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
