// Sets of laws judged on axes whose law is known.
#include "diagnosis/balance/balance_validation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

ValidatedChoice judged(const PreparedAxis& axis, const std::vector<std::string>& names) {
  return validate(axis.regression, axis.balance.laws, choice_of(axis.balance.laws, names));
}

TEST(BalanceValidation, EveryBlockAndEveryRecordIsLeftOutOnce) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const ValidatedChoice right = judged(axis, {"dry", "viscous"});
  EXPECT_EQ(right.block_error.size(), 2u * kBlocksPerRecord);
  EXPECT_EQ(right.record_block_error.size(), right.block_error.size());
  EXPECT_EQ(right.record_error.size(), 2u);
  double mean = 0.0;
  for (std::size_t b = 0; b < right.block_error.size(); ++b) mean += right.block_error[b] * axis.regression.blocks[b].count / axis.regression.count;
  EXPECT_NEAR(right.of_blocks, mean, 1e-9 * mean);
}

TEST(BalanceValidation, TheLawsThatActHelpAndNoOthersDo) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const ValidatedChoice alone = judged(axis, {}), dry = judged(axis, {"dry"}), both = judged(axis, {"dry", "viscous"});
  EXPECT_TRUE(helps(alone, dry, alone.of_blocks));
  EXPECT_TRUE(helps(dry, both, alone.of_blocks));
  EXPECT_FALSE(helps(both, dry, alone.of_blocks));
  EXPECT_TRUE(is_better(both, dry));
  EXPECT_FALSE(is_better(dry, both));
  for (const char* more : {"offset", "gravity", "spring", "quadratic"}) {
    EXPECT_FALSE(helps(both, judged(axis, {"dry", "viscous", more}), alone.of_blocks)) << more;
  }
}

TEST(BalanceValidation, FrictionThatPushesIsNotPhysical) {
  EXPECT_FALSE(judged(prepared_axis({.resistance = [](double, double, double speed) { return -0.1 * speed; }, .noise = 2e-6}), {"viscous"}).is_physical);
  EXPECT_TRUE(judged(prepared_axis({.resistance = [](double, double, double speed) { return 0.1 * speed; }, .noise = 2e-6}), {"viscous"}).is_physical);
  // A constant torque may have either sign.
  EXPECT_TRUE(judged(prepared_axis({.resistance = [](double, double, double speed) { return 0.8 * speed - 0.5; }, .noise = 2e-6}), {"viscous", "offset"}).is_physical);
}

// By blocks and records where both have them: sqrt(4 * 9) and sqrt(1 * 16); by the blocks where one has no records.
TEST(BalanceValidation, IsTheGeometricMeanOfBlocksAndRecords) {
  ValidatedChoice a, b;
  a.of_blocks = 4.0;
  a.of_records = 9.0;
  a.record_error = {9.0};
  b.of_blocks = 1.0;
  b.of_records = 16.0;
  b.record_error = {16.0};
  EXPECT_EQ(compared(a, b), std::pair(6.0, 4.0));
  b.record_error.clear();
  EXPECT_EQ(compared(a, b), std::pair(4.0, 1.0));
}

// The means fall, and one of two records gets worse by more than half of what the other gains.
TEST(BalanceValidation, NoRecordPaysForAnother) {
  ValidatedChoice without, with;
  without.block_error = {2.0, 2.0, 2.0, 2.0};
  with.block_error = {1.0, 1.01, 0.99, 1.0};
  without.of_blocks = 2.0;
  with.of_blocks = 1.0;
  without.record_error = {2.0, 2.0};
  without.of_records = 2.0;
  with.record_error = {1.0, 1.2};
  with.of_records = 1.1;
  EXPECT_TRUE(helps(without, with, 10.0));
  with.record_error = {0.2, 3.0};
  EXPECT_FALSE(helps(without, with, 10.0));
  with.record_error = {1.0, 1.2};
  with.is_physical = false;
  EXPECT_FALSE(helps(without, with, 10.0));
}

}  // namespace
}  // namespace slewlab::diagnosis
