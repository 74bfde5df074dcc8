#include "sim/effects/effect.h"

#include <gtest/gtest.h>

namespace slewlab::sim {
namespace {

// As many on one side as on the other; the middle one of an odd number on neither.
TEST(GroupSide, SplitsTheGroupsInHalves) {
  EXPECT_EQ(group_side(0, 1), 0.0);
  EXPECT_EQ(group_side(0, 2), 1.0);
  EXPECT_EQ(group_side(1, 2), -1.0);
  EXPECT_EQ(group_side(1, 3), 0.0);
  for (int count = 1; count <= kMaximumGroupCount; ++count) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += group_side(i, count);
    EXPECT_EQ(sum, 0.0) << count;
  }
}

}  // namespace
}  // namespace slewlab::sim
