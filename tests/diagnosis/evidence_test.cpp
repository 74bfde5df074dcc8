#include "diagnosis/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace slewlab::diagnosis {
namespace {

double total(const Probabilities& p) {
  return std::accumulate(p.candidate.begin(), p.candidate.end(), p.unknown);
}

TEST(Evidence, ProbabilitiesSumToOne) {
  const Probabilities p =
      weigh({{{}, 500.0, 0.0}, {{"a"}, 10.0, 4.0}, {{"b"}, 300.0, 2.0}, {{"a", "b"}, 9.0, 8.0}}, 40, {});
  EXPECT_NEAR(total(p), 1.0, 1e-12);
}

TEST(Evidence, NothingMissingIsSaidWhereEffectsGainNothing) {
  const Probabilities p = weigh({{{}, 0.0, 0.0}, {{"a"}, -5.0, 5.0}, {{"a", "b"}, -8.0, 9.0}}, 40, {});
  EXPECT_GT(p.candidate[0], 0.9);
}

// What mesh and step let an effect gain where nothing is missing, settings.effect_cost, is no evidence for it.
TEST(Evidence, AnEffectMustGainItsPrice) {
  const EvidenceSettings settings;
  EXPECT_GT(weigh({{{}, 0.0, 0.0}, {{"a"}, -settings.effect_cost, 0.0}}, 40, {}).candidate[0], 0.9);
  EXPECT_LT(weigh({{{}, 0.0, 0.0}, {{"a"}, -10.0 * settings.temper * settings.effect_cost, 0.0}}, 40, {}).candidate[0], 0.1);
}

TEST(Evidence, ASecondEffectMustEarnItsPlace) {
  const Probabilities p = weigh({{{}, 2000.0, 0.0}, {{"a"}, 10.0, 0.0}, {{"a", "b"}, 0.0, 5.0}}, 40, {});
  EXPECT_GT(p.candidate[1], p.candidate[2]);
}

// What a law has beside two others that it holds must gain its price, as a second effect beside a first; the two belong together, and are as likely as one.
TEST(Evidence, ALawThatHoldsOthersMustShowWhatItHasOfItsOwn) {
  const EvidenceSettings settings;
  const Candidate nothing{{}, 2000.0, 0.0}, parts{.effects = {"a", "b"}, .laws = 2, .is_one_cause = true};
  const auto odds = [&](double gain) {
    const Probabilities p = weigh({nothing, parts, {.effects = {"ab"}, .residual_power = -gain, .laws = 3}}, 40, settings);
    return p.candidate[2] / p.candidate[1];
  };
  EXPECT_NEAR(odds(0.0), std::exp(-0.5 / settings.temper * settings.effect_cost), 1e-9);
  EXPECT_GT(odds(10.0 * settings.effect_cost), 10.0);
}

TEST(Evidence, UnknownWhereEveryCauseLeavesMuchOfALargeGap) {
  const Probabilities p = weigh({{{}, 10000.0, 0.0}, {{"a"}, 6000.0, 0.0}, {{"a", "b"}, 5000.0, 0.0}}, 40, {});
  EXPECT_GT(p.unknown, 0.99);
}

TEST(Evidence, KnownWhereACauseLeavesLittle) {
  const Probabilities p = weigh({{{}, 10000.0, 0.0}, {{"a"}, 100.0, 0.0}}, 40, {});
  EXPECT_LT(p.unknown, 0.01);
}

// Two causes of equal prior: their odds are the ratio of their discounted misfits, by the header's formula. 55 is half of k + r G
// and a quarter of n + q G.
TEST(Evidence, OddsFollowTheFormula) {
  EvidenceSettings settings;
  settings.law_freedom = 10.0;
  settings.law_share = 0.1;
  settings.near_freedom = 4.0;
  settings.near_misfit = 200.0;
  settings.near_share = 0.02;
  settings.temper = 1.0;
  const Probabilities p = weigh({{{}, 1000.0, 0.0}, {{"a"}, 0.0, 0.0}, {{"b"}, 55.0, 0.0}}, 40, settings);
  EXPECT_NEAR(p.candidate[1] / p.candidate[2], std::pow(1.5, 5.0) * std::pow(1.25, 2.0), 1e-9);
}

// The residual of noise under parameters that no machine has is no measure for the others: ten parameters that the records determine, whose squares of
// deviations sum to 150 in the pair; chi squared of 10 exceeds that in 3e-27.
TEST(Evidence, AMachineThatNobodyBuildsSetsNoFloor) {
  const Eigen::VectorXd ten = Eigen::VectorXd::Constant(10, 1e3);
  const std::vector<Candidate> others{{{}, 400.0, 8.0, ten}, {{"a"}, -50.0, 12.0, ten}, {{"b"}, 60.0, 20.0, ten}};
  std::vector<Candidate> all = others;
  all.push_back({{"b", "c"}, -300.0, 150.0, ten});
  EXPECT_DOUBLE_EQ(weigh(others, 40, {}).floor, -50.0);
  EXPECT_DOUBLE_EQ(weigh(all, 40, {}).floor, -50.0);
  all.back().prior = 15.0;
  EXPECT_DOUBLE_EQ(weigh(all, 40, {}).floor, -300.0);
}

// Two laws with the same residual, one of which has it at a bound of its own, where it is the other one: half of what its parameter may be lies
// beyond.
TEST(Evidence, AParameterAtItsBoundHasHalfItsWidth) {
  const Probabilities p = weigh({{{}, 500.0, 0.0}, {{"a"}, 10.0, 4.0}, {{"b"}, 10.0, 4.0, {}, 1}}, 40, {});
  EXPECT_NEAR(p.candidate[1] / p.candidate[2], 2.0, 1e-12);
}

TEST(Evidence, TheSlopeOfAMisfitsCostIsItsDerivative) {
  const MisfitCost cost({}, 1e6);
  for (const double left : {0.0, 30.0, 4000.0, 1e6}) {
    const double h = 1e-4 * (left + 1.0);
    EXPECT_NEAR(cost.slope(left + h), (cost(left + 2.0 * h) - cost(left)) / (2.0 * h), 1e-6 * cost.slope(left)) << left;
  }
}

// Upper tails of chi squared as tables have them (Abramowitz and Stegun, table 26.8); what the records do not determine does not count.
TEST(Evidence, TheChanceOfParametersIsThatOfChiSquared) {
  const auto chance = [](double prior, int determined) {
    Eigen::VectorXd information = Eigen::VectorXd::Zero(determined + 5);
    information.head(determined).setConstant(1e12);
    return chance_of_prior(prior, information, 0.3);
  };
  EXPECT_NEAR(chance(7.81473, 3), 0.05, 1e-3);
  EXPECT_NEAR(chance(18.3070, 10), 0.05, 1e-3);
  EXPECT_NEAR(chance(37.5662, 20), 0.01, 1e-3);
  EXPECT_NEAR(chance(45.3147, 20), 0.001, 1e-4);
  EXPECT_NEAR(chance(15.4518, 20), 0.75, 2e-3);
  EXPECT_EQ(chance(50.0, 0), 1.0);
  // Half determined is half a degree of freedom: s lambda = 1 of twenty are ten.
  EXPECT_NEAR(chance_of_prior(18.3070, Eigen::VectorXd::Constant(20, 1.0 / 0.3), 0.3), 0.05, 1e-3);
}

// A hypothesis with a chance of its own has that before the records, and is no single effect by which "unknown" is measured, nor nothing missing, whatever effects it has.
TEST(Evidence, TakesTheChanceOfAnUnknownLaw) {
  const std::vector<Candidate> known{{{}, 400.0, 1.0}, {{"a"}, 10.0, 2.0}};
  std::vector<Candidate> with_law = known;
  with_law.push_back({{"a"}, 10.0, 2.0});
  with_law.back().laws = 1;
  with_law.back().chance = 0.5 * EvidenceSettings{}.prior_single / 40.0;
  with_law.push_back({{}, 400.0, 1.0});
  with_law.back().laws = 0;
  with_law.back().chance = 0.25 * EvidenceSettings{}.prior_nothing;
  const Probabilities before = weigh(known, 40, {}), after = weigh(with_law, 40, {});
  EXPECT_NEAR(after.candidate[2] / after.candidate[1], 0.5, 1e-12);
  EXPECT_NEAR(after.candidate[3] / after.candidate[0], 0.25, 1e-12);
  EXPECT_NEAR(after.unknown / after.candidate[1], before.unknown / before.candidate[1], 1e-12);
}

TEST(Evidence, WantsTheCandidateWithoutEffects) {
  EXPECT_THROW(weigh({{{"a"}, 1.0, 0.0}}, 40, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
