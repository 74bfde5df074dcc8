#include "diagnosis/ranking.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slewlab::diagnosis {
namespace {

Cause cause_of(std::vector<std::string> effects, double probability) {
  Cause cause;
  cause.effects = std::move(effects);
  cause.probability = probability;
  return cause;
}

// Two indistinguishable effects, alone and beside a third one; a cause that has both is another cause.
TEST(Ranking, NamesOfOneMotionAreOneAnswer) {
  Ranking ranking{{cause_of({"early"}, 0.3), cause_of({"load", "early"}, 0.1), cause_of({"late"}, 0.3), cause_of({"late", "load"}, 0.1), cause_of({"early", "late"}, 0.05), cause_of({}, 0.05)}, 0.1};
  merge_same_motion({{"late", "early"}}, ranking);
  ASSERT_EQ(ranking.causes.size(), 4U);
  EXPECT_EQ(told_name(ranking.causes[0]), "early or late");
  EXPECT_EQ(name_of(ranking.causes[0]), "early");
  EXPECT_DOUBLE_EQ(ranking.causes[0].probability, 0.6);
  EXPECT_EQ(told_name(ranking.causes[1]), "load with early or late with load");
  EXPECT_DOUBLE_EQ(ranking.causes[1].probability, 0.2);
  EXPECT_EQ(told_name(ranking.causes[2]), "early with late");
  EXPECT_EQ(told_name(ranking.causes[3]), "only parameters are off");
  double sum = ranking.unknown;
  for (const Cause& cause : ranking.causes) sum += cause.probability;
  EXPECT_DOUBLE_EQ(sum, 1.0);  // as before
}

// A controller's answers are computed: the residual of its right law is what was rounded. A law with a residual of a hundredth may be the right one
// and is not sure. A law with a larger residual hardly is.
TEST(Ranking, AControllersLawIsSureOnlyWhereItLeavesNextToNothing) {
  common::EffectParameter factor;
  factor.name = "factor";
  factor.lower = 0.1;
  factor.upper = 10.0;
  factor.typical = 1.1;
  factor.prior_scale = 0.1;
  factor.absent = 1.0;
  common::EffectAbout ramp;
  ramp.name = "ramp";
  ramp.parameters = {factor};
  common::EffectCatalogue catalogue;
  catalogue.effects = {ramp};
  const auto lead_where = [&](double share_left) {
    Ranking ranking{{cause_of({}, 1.0)}, 0.0};
    add_controller_causes(catalogue, {{{{"ramp", {1.2}}}, {0.01}, share_left, 1.0}}, ranking);
    EXPECT_NEAR(ranking.causes.front().probability + ranking.unknown, 1.0, 1e-12);
    return ranking.causes.front().probability;
  };
  EXPECT_GT(lead_where(1e-9), 0.95);
  EXPECT_GT(lead_where(5e-3), 0.5);
  EXPECT_LT(lead_where(5e-3), 0.75);
  EXPECT_LT(lead_where(0.05), 0.1);
}

double sum_of(const Ranking& ranking) {
  double sum = ranking.unknown;
  for (const Cause& cause : ranking.causes) sum += cause.probability;
  return sum;
}

// The probability that a cause loses goes to "unknown", or to nothing missing where the residual of parameters alone is no more than noise. Without a
// cause of which nothing is missing it goes to "unknown" as well.
TEST(Ranking, WhatIsTakenAwayIsKeptElsewhere) {
  const auto taken = [](Ranking ranking, bool is_nothing_left) {
    take_away(0.5, is_nothing_left, ranking.causes[0], ranking);
    EXPECT_DOUBLE_EQ(sum_of(ranking), 1.0);
    EXPECT_DOUBLE_EQ(ranking.causes[0].probability, 0.4);
    return ranking;
  };
  const Ranking both{{cause_of({"a"}, 0.8), cause_of({}, 0.1)}, 0.1}, alone{{cause_of({"a"}, 0.8)}, 0.2};
  EXPECT_DOUBLE_EQ(taken(both, false).unknown, 0.5);
  Ranking to_nothing = taken(both, true);
  EXPECT_DOUBLE_EQ(nothing_missing(to_nothing)->probability, 0.5);
  EXPECT_DOUBLE_EQ(taken(alone, true).unknown, 0.6);
}

// A doubted effect's share goes to the causes that have the others, by their own probabilities, but to none that did not predict.
TEST(Ranking, WhatIsDoubtedIsHandedToWhatIsNot) {
  Ranking ranking{{cause_of({"a", "b"}, 0.6), cause_of({"a"}, 0.1), cause_of({"a", "c"}, 0.2), cause_of({"c"}, 0.05), cause_of({}, 0.05)}, 0.0};
  const auto is_b = [](const std::string& effect) { return effect == "b"; };
  hand_on(0.5, is_b, false, ranking.causes[0], ranking);
  EXPECT_DOUBLE_EQ(ranking.causes[0].probability, 0.3);
  EXPECT_DOUBLE_EQ(ranking.causes[1].probability, 0.2);
  EXPECT_DOUBLE_EQ(ranking.causes[2].probability, 0.4);
  EXPECT_DOUBLE_EQ(ranking.causes[3].probability, 0.05);
  EXPECT_DOUBLE_EQ(sum_of(ranking), 1.0);
  ranking.causes[2].validation = Validation{};  // it did not hold
  hand_on(1.0, is_b, false, ranking.causes[0], ranking);
  EXPECT_DOUBLE_EQ(ranking.causes[1].probability, 0.5);
  EXPECT_DOUBLE_EQ(ranking.causes[2].probability, 0.4);
  // Of one effect alone nothing is left to have.
  hand_on(1.0, [](const std::string& effect) { return effect == "c"; }, false, ranking.causes[3], ranking);
  EXPECT_DOUBLE_EQ(ranking.unknown, 0.05);
  EXPECT_DOUBLE_EQ(sum_of(ranking), 1.0);
}

TEST(Ranking, FallsAndItsGroupsNameWhatIsThere) {
  std::vector<Cause> causes{cause_of({"a"}, 0.1), cause_of({"b"}, 0.9)};
  causes[1].group = {{"a", 0.1}, {"c", 0.1}};
  sort_causes(causes);
  EXPECT_EQ(name_of(causes[0]), "b");
  ASSERT_EQ(causes[0].group.size(), 1U);
  EXPECT_EQ(causes[0].group[0].name, "a");
}

}  // namespace
}  // namespace slewlab::diagnosis
