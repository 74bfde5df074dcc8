// Which sets of laws are judged, on axes whose law is known.
#include "diagnosis/balance/balance_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

// Sets of names, of candidates that are all of one axis.
std::vector<std::set<std::string>> named(const std::vector<ValidatedChoice>& candidates, const std::vector<BalanceLaw>& laws) {
  std::vector<std::set<std::string>> sets;
  for (const ValidatedChoice& one : candidates) {
    sets.emplace_back();
    for (const auto& [law, shape] : one.choice.laws) sets.back().insert(laws[static_cast<std::size_t>(law)].name);
  }
  return sets;
}

TEST(BalanceSearch, JudgesEachSetOnceTheRightOneAmongThem) {
  const PreparedAxis axis = prepared_axis({.resistance = [](double t, double q, double v) { return usual_friction(t, q, v) + 0.5; }, .noise = 2e-6});
  const ValidatedChoice alone = validate(axis.regression, axis.balance.laws, {});
  const std::vector<ValidatedChoice> candidates = candidates_of(axis.regression, axis.balance.laws, alone);
  const std::vector<std::set<std::string>> sets = named(candidates, axis.balance.laws);
  EXPECT_EQ(std::set<std::set<std::string>>(sets.begin(), sets.end()).size(), sets.size());
  for (const std::set<std::string>& wanted : {std::set<std::string>{}, {"dry"}, {"viscous"}, {"dry", "viscous"}, {"dry", "offset", "viscous"}}) {
    EXPECT_NE(std::find(sets.begin(), sets.end(), wanted), sets.end()) << wanted.size();
  }
  for (const ValidatedChoice& one : candidates) {
    EXPECT_TRUE(one.is_physical || one.choice.laws.empty());
    EXPECT_LE(one.choice.laws.size(), 6u);
    EXPECT_TRUE(std::is_sorted(one.choice.laws.begin(), one.choice.laws.end()));
  }
}

TEST(BalanceSearch, WithoutLawsThereIsTheInertiaAlone) {
  const PreparedAxis axis = prepared_axis({.noise = 2e-6});
  const Regression bare = prepared_regression(axis.records, {}, 2.0, axis.balance.resolved_speed);
  const std::vector<ValidatedChoice> candidates = candidates_of(bare, {}, validate(bare, {}, {}));
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_TRUE(candidates.front().choice.laws.empty());
}

TEST(BalanceSearch, WithoutALawTheOthersStay) {
  const LawChoice choice{{{0, 0}, {3, 2}, {5, 1}}};
  EXPECT_EQ(without_law(choice, 1).laws, (std::vector<std::pair<int, std::size_t>>{{0, 0}, {5, 1}}));
}

}  // namespace
}  // namespace slewlab::diagnosis
