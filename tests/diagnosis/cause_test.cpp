#include "diagnosis/cause.h"

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

// Two names of one motion, alone and beside a third effect; what has both names is another motion.
TEST(Cause, NamesOfOneMotionAreOneAnswer) {
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

// A controller's answers are computed: its right law leaves what was rounded. One that leaves a hundredth may be it and is not sure, one that leaves more hardly is.
TEST(Cause, AControllersLawIsSureOnlyWhereItLeavesNextToNothing) {
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

}  // namespace
}  // namespace slewlab::diagnosis
