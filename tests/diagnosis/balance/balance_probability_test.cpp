// The odds against their equation, by hand, and what the probabilities of an axis add up to.
#include "diagnosis/balance/balance_probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "diagnosis/balance/balance_search.h"
#include "diagnosis/balance/balance_unknown.h"
#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

// Four blocks, the residual's mean square in each e times as large: m = 1, s^2 = 0.1^2, so that ln odds = -2 ln(1 + 100 / 3).
TEST(BalanceProbability, OddsAreThoseOfTheirEquation) {
  const double e = std::exp(1.0);
  const LeftOutError more{{e, 2.0 * e, 3.0 * e, 4.0 * e}, {}}, less{{1.0, 2.0, 3.0, 4.0}, {}};
  EXPECT_NEAR(log_odds(more, less, 0.0), -2.0 * std::log1p(100.0 / 3.0), 1e-9);
  EXPECT_NEAR(log_odds(less, more, 0.0), 2.0 * std::log1p(100.0 / 3.0), 1e-9);
  EXPECT_EQ(log_odds(less, less, 0.0), 0.0);
}

// Far below what laws are known to, nothing tells two models apart.
TEST(BalanceProbability, WhatLawsAreKnownNoBetterThanIsLeftByBoth) {
  const LeftOutError more{{4e-6, 4e-6, 4e-6}, {}}, less{{1e-6, 1e-6, 1e-6}, {}};
  EXPECT_LT(log_odds(more, less, 0.0), -3.0);
  EXPECT_NEAR(log_odds(more, less, 1.0), 0.0, 1e-6);
}

// Half the blocks for one model, half for the other by as much.
TEST(BalanceProbability, WhatHelpsHereAndHarmsThereHelpsNowhere) {
  const LeftOutError one{{1.0, 4.0, 1.0, 4.0}, {}}, other{{4.0, 1.0, 4.0, 1.0}, {}};
  EXPECT_NEAR(log_odds(one, other, 0.0), 0.0, 1e-12);
}

TEST(BalanceProbability, AllSetsAndTheUnknownAreOne) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const ValidatedChoice alone = validate(axis.regression, axis.balance.laws, {});
  const std::vector<ValidatedChoice> candidates = candidates_of(axis.regression, axis.balance.laws, alone);
  const SetProbabilities found = set_probabilities(candidates, axis.balance.laws, axis.regression, alone, unknown_validation(axis.records, axis.regression));
  EXPECT_NEAR(std::accumulate(found.probability.begin(), found.probability.end(), found.unknown), 1.0, 1e-12);
  ASSERT_EQ(found.inclusion.size(), axis.balance.laws.size());
  EXPECT_GT(found.inclusion[static_cast<std::size_t>(chosen_law(axis.balance.laws, "dry")->first)], 0.9);
  EXPECT_GT(found.inclusion[static_cast<std::size_t>(chosen_law(axis.balance.laws, "viscous")->first)], 0.9);
  EXPECT_LT(found.inclusion[static_cast<std::size_t>(chosen_law(axis.balance.laws, "gravity")->first)], 0.5);
  EXPECT_EQ(candidates.at(found.answer).choice.laws.size(), 2u);
}

}  // namespace
}  // namespace slewlab::diagnosis
