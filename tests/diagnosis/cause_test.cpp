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

}  // namespace
}  // namespace slewlab::diagnosis
