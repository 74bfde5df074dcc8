#include "sim/effects/delay_line.h"

#include <gtest/gtest.h>

namespace slewlab::sim {
namespace {

struct Sample {
  double value = 0.0;
};

TEST(DelayLine, AnswersTheSamplesAroundADelay) {
  DelayLine<Sample> line(3.4);
  for (int k = 1; k <= 20; ++k) {
    line.push({static_cast<double>(k)});
    for (const double delay : {0.0, 0.25, 1.0, 2.5, 3.4}) {
      const auto past = line.at(delay);
      const double expected = k - delay;
      if (expected < 0.0) continue;
      EXPECT_NEAR(blend(past.older.value, past.newer.value, past.share), expected, 1e-12) << k << " " << delay;
    }
  }
}

TEST(DelayLine, IsEmptyBeforeTheFirstPush) {
  DelayLine<Sample> line(5.0);
  line.push({7.0});
  EXPECT_EQ(line.at(0.0).newer.value, 7.0);
  EXPECT_EQ(line.at(0.0).share, 0.0);
  for (const double delay : {1.0, 2.0, 5.0}) EXPECT_EQ(line.at(delay).newer.value, 0.0);
}

TEST(DelayLine, BlendWithoutShareIsTheNewerToTheBit) {
  EXPECT_EQ(blend(1e300, 0.1, 0.0), 0.1);
  EXPECT_EQ(blend(3.0, 1.0, 1.0), 3.0);
}

}  // namespace
}  // namespace slewlab::sim
