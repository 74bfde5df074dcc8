#include "tools/verification/row.h"

#include <gtest/gtest.h>

#include <limits>

namespace slewlab::tools {
namespace {

TEST(Row, JudgesByItsCriterion) {
  EXPECT_EQ(relative_row("", "", "", 10.0, 10.4, 0.05).verdict, RowVerdict::kPass);
  EXPECT_EQ(relative_row("", "", "", 10.0, 10.6, 0.05).verdict, RowVerdict::kMisses);
  EXPECT_EQ(relative_row("", "", "", -10.0, -9.6, 0.05).verdict, RowVerdict::kPass);
  EXPECT_EQ(absolute_row("", "", "", 0.0, 0.4, 0.5).verdict, RowVerdict::kPass);
  EXPECT_EQ(absolute_row("", "", "", 0.0, -0.6, 0.5).verdict, RowVerdict::kMisses);
  EXPECT_EQ(at_most_row("", "", "", 5.0, 4.9).verdict, RowVerdict::kPass);
  EXPECT_EQ(at_most_row("", "", "", 5.0, 5.1).verdict, RowVerdict::kMisses);
  EXPECT_EQ(at_least_row("", "", "", 5.0, 5.1).verdict, RowVerdict::kPass);
  EXPECT_EQ(at_least_row("", "", "", 5.0, 4.9).verdict, RowVerdict::kMisses);
}

TEST(Row, WhatRoundingLeavesIsNoDeviation) {
  EXPECT_EQ(deviation(absolute_row("", "", "", 0.3, 0.1 + 0.2, 0.5)), 0.0);  // 0.30000000000000004
  EXPECT_EQ(deviation(relative_row("", "", "", 0.3, 0.1 + 0.2, 0.5)), 0.0);
  EXPECT_NEAR(deviation(absolute_row("", "", "", 0.3, 0.3 + 1e-9, 0.5)), 1e-9, 1e-15);
}

TEST(Row, NotANumberNeverPasses) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(relative_row("", "", "", 10.0, none, 0.05).verdict, RowVerdict::kMisses);
  EXPECT_EQ(at_most_row("", "", "", 10.0, none).verdict, RowVerdict::kMisses);
  EXPECT_EQ(at_least_row("", "", "", 10.0, none).verdict, RowVerdict::kMisses);
}

TEST(Row, AMissThatCannotBeReachedSaysWhyAndAPassStaysOne) {
  const VerificationRow missed = judge_unreachable(relative_row("", "", "", 10.0, 20.0, 0.05), "misprint");
  EXPECT_EQ(missed.verdict, RowVerdict::kCannotBeReached);
  EXPECT_EQ(missed.note, "misprint");
  EXPECT_EQ(judge_unreachable(relative_row("", "", "", 10.0, 10.0, 0.05), "misprint").verdict, RowVerdict::kPass);
}

}  // namespace
}  // namespace slewlab::tools
