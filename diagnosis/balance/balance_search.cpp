#include "diagnosis/balance/balance_search.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace slewlab::diagnosis {

namespace {

constexpr std::size_t kMostTerms = 6;   // beside the inertia
constexpr std::size_t kGrownPairs = 3;  // of the best, from which more grows

// The choice with one law more, each law in the shape that validates best; nothing where none may be added.
std::vector<ValidatedChoice> additions(const Regression& regression, const std::vector<BalanceLaw>& laws, const LawChoice& choice,
                                 bool only_ordinary) {
  std::vector<ValidatedChoice> found;
  const auto has = [&](const std::string& name) {
    return std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) { return laws[static_cast<std::size_t>(law.first)].name == name; });
  };
  for (std::size_t l = 0; l < laws.size(); ++l) {
    if (only_ordinary && !laws[l].is_ordinary) continue;
    if (has(laws[l].name) || (!laws[l].needs.empty() && !has(laws[l].needs)) || (!laws[l].instead_of.empty() && has(laws[l].instead_of))) continue;
    std::optional<ValidatedChoice> best;
    for (std::size_t s = 0; s < laws[l].shapes.size(); ++s) {
      LawChoice longer = choice;
      longer.laws.emplace_back(static_cast<int>(l), s);
      ValidatedChoice validated = validate(regression, laws, longer);
      if (!validated.is_physical) continue;
      if (!best || is_better(validated, *best)) best = std::move(validated);
    }
    if (best) found.push_back(std::move(*best));
  }
  // By the blocks, which every model has.
  std::stable_sort(found.begin(), found.end(), [](const ValidatedChoice& a, const ValidatedChoice& b) { return a.of_blocks < b.of_blocks; });
  return found;
}

// Whether another law of the choice is a detail of this one.
bool is_needed(const std::vector<BalanceLaw>& laws, const LawChoice& choice, std::size_t index) {
  const std::string& name = laws[static_cast<std::size_t>(choice.laws[index].first)].name;
  return std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) { return laws[static_cast<std::size_t>(law.first)].needs == name; });
}

// The first of `candidates` that helps.
const ValidatedChoice* first_help(const ValidatedChoice& best, const std::vector<ValidatedChoice>& candidates, double gap) {
  const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const ValidatedChoice& candidate) { return helps(best, candidate, gap); });
  return found == candidates.end() ? nullptr : &*found;
}

// Each law's shape chosen again beside the others.
ValidatedChoice reshaped(const Regression& regression, const std::vector<BalanceLaw>& laws, ValidatedChoice best) {
  for (std::size_t k = 0; k < best.choice.laws.size(); ++k) {
    const std::size_t shapes = laws[static_cast<std::size_t>(best.choice.laws[k].first)].shapes.size();
    for (std::size_t s = 0; s < shapes; ++s) {
      LawChoice other = best.choice;
      if (other.laws[k].second == s) continue;
      other.laws[k].second = s;
      ValidatedChoice validated = validate(regression, laws, other);
      if (validated.is_physical && is_better(validated, best)) best = std::move(validated);
    }
  }
  return best;
}

std::vector<int> names_of(const LawChoice& choice) {
  std::vector<int> names;
  for (const auto& [law, shape] : choice.laws) names.push_back(law);
  std::sort(names.begin(), names.end());
  return names;
}

// One law at a time while validation improves, two where no single one helps (in records of one direction each dry friction and a constant
// torque help only together); one that another has made needless goes again. `tried` gets everything that was validated.
ValidatedChoice grow(const Regression& regression, const std::vector<BalanceLaw>& laws, ValidatedChoice best, bool only_ordinary, double gap,
               std::vector<ValidatedChoice>& tried) {
  std::set<std::vector<int>> been;  // two laws may each make the other needless, in turn
  while (best.choice.laws.size() < kMostTerms && been.insert(names_of(best.choice)).second) {
    const std::vector<ValidatedChoice> longer = additions(regression, laws, best.choice, only_ordinary);
    tried.insert(tried.end(), longer.begin(), longer.end());
    const ValidatedChoice* found = first_help(best, longer, gap);
    std::vector<ValidatedChoice> pairs;
    for (std::size_t k = 0; found == nullptr && only_ordinary && k < longer.size(); ++k) {
      const std::vector<ValidatedChoice> beside = additions(regression, laws, longer[k].choice, only_ordinary);
      pairs.insert(pairs.end(), beside.begin(), beside.end());
    }
    if (found == nullptr) found = first_help(best, pairs, gap);
    if (found == nullptr) break;
    best = reshaped(regression, laws, *found);
    tried.push_back(best);
    for (std::size_t k = 0; k + 1 < best.choice.laws.size(); ++k) {
      if (is_needed(laws, best.choice, k)) continue;
      ValidatedChoice shorter = validate(regression, laws, without_law(best.choice, k));
      if (!shorter.is_physical || helps(shorter, best, gap)) continue;
      best = std::move(shorter);
      break;
    }
  }
  return best;
}

}  // namespace

LawChoice without_law(LawChoice choice, std::size_t index) {
  choice.laws.erase(choice.laws.begin() + static_cast<std::ptrdiff_t>(index));
  return choice;
}

std::vector<ValidatedChoice> candidates_of(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& alone) {
  const double gap = alone.of_blocks;
  std::vector<ValidatedChoice> tried{alone};
  const std::vector<ValidatedChoice> singles = additions(regression, laws, {}, false);
  tried.insert(tried.end(), singles.begin(), singles.end());
  std::vector<ValidatedChoice> pairs;
  for (const ValidatedChoice& single : singles) {
    for (const ValidatedChoice& pair : additions(regression, laws, single.choice, false)) pairs.push_back(reshaped(regression, laws, pair));
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const ValidatedChoice& a, const ValidatedChoice& b) { return a.of_blocks < b.of_blocks; });
  tried.insert(tried.end(), pairs.begin(), pairs.end());
  std::vector<ValidatedChoice> ends;
  ValidatedChoice ordinary = alone;
  for (const bool only_ordinary : {true, false}) ordinary = grow(regression, laws, ordinary, only_ordinary, gap, tried);
  ends.push_back(ordinary);
  ends.push_back(grow(regression, laws, alone, false, gap, tried));
  for (std::size_t k = 0; k < std::min(kGrownPairs, pairs.size()); ++k) ends.push_back(grow(regression, laws, pairs[k], false, gap, tried));
  for (const ValidatedChoice& end : ends) {
    tried.push_back(end);
    for (std::size_t k = 0; k < end.choice.laws.size(); ++k) {
      if (is_needed(laws, end.choice, k)) continue;
      const LawChoice shorter = without_law(end.choice, k);
      tried.push_back(validate(regression, laws, shorter));
      for (const ValidatedChoice& swapped : additions(regression, laws, shorter, false)) tried.push_back(swapped);
    }
  }
  std::map<std::vector<int>, ValidatedChoice> best_of;
  for (ValidatedChoice& one : tried) {
    if (!one.is_physical && !one.choice.laws.empty()) continue;  // the inertia alone is told even where it is absurd
    std::sort(one.choice.laws.begin(), one.choice.laws.end());
    const auto [entry, is_new] = best_of.try_emplace(names_of(one.choice), one);
    if (!is_new && is_better(one, entry->second)) entry->second = std::move(one);
  }
  std::vector<ValidatedChoice> candidates;
  for (auto& [names, one] : best_of) candidates.push_back(validate(regression, laws, one.choice));
  return candidates;
}

}  // namespace slewlab::diagnosis
