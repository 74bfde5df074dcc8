// Numbers in messages are written as people write them.

#include "common/readable_number.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace slewlab::common {
namespace {

TEST(ReadableNumber, HasSixDigitsAndNoExponentWhereNoneIsNeeded) {
  EXPECT_EQ(readable(0.41500000000000004), "0.415");
  EXPECT_EQ(readable(-6e6), "-6000000");
  EXPECT_EQ(readable(2.6790804018112957), "2.67908");
  EXPECT_EQ(readable(0.0), "0");
  EXPECT_EQ(readable(100.0), "100");
  EXPECT_EQ(readable(1e-4), "0.0001");
  EXPECT_EQ(readable(1e-6), "1e-06");
  EXPECT_EQ(readable(3e10), "3e+10");
  EXPECT_EQ(readable(std::numeric_limits<double>::infinity()), "inf");
}

TEST(ReadableNumber, AnglesAreInDegrees) { EXPECT_EQ(readable_angle(std::numbers::pi / 3.0), "60 deg"); }

TEST(ReadableNumber, TimesAreInMillisecondsBelowASecond) {
  EXPECT_EQ(readable_time(10'000'000), "10 ms");
  EXPECT_EQ(readable_time(0), "0 ms");
  EXPECT_EQ(readable_time(1'500), "0.0015 ms");
  EXPECT_EQ(readable_time(5'000'500'000), "5.0005 s");
  EXPECT_EQ(readable_time(3'600'000'000'000), "3600 s");
}

}  // namespace
}  // namespace slewlab::common
