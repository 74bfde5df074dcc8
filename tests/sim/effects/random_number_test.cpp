#include "sim/effects/random_number.h"

#include <gtest/gtest.h>

namespace slewlab::sim {
namespace {

// Mean 1/2, variance 1/12 of an even distribution; 100 000 draws put both within 0.003.
TEST(RandomNumber, IsEvenlyDistributed) {
  double sum = 0.0, square = 0.0, neighbours = 0.0;
  constexpr int kCount = 100000;
  for (std::uint64_t k = 0; k < kCount; ++k) {
    const double x = uniform_number(42, k) - 0.5;
    ASSERT_TRUE(x >= -0.5 && x < 0.5);
    sum += x;
    square += x * x;
    neighbours += x * (uniform_number(42, k + 1) - 0.5);
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.005);
  EXPECT_NEAR(square / kCount, 1.0 / 12.0, 0.002);
  EXPECT_NEAR(neighbours / kCount, 0.0, 0.002);
}

TEST(RandomNumber, DependsOnSeedAndCounterAlone) {
  EXPECT_EQ(uniform_number(1, 5), uniform_number(1, 5));
  EXPECT_NE(uniform_number(1, 5), uniform_number(2, 5));
  EXPECT_NE(uniform_number(1, 5), uniform_number(1, 6));
}

}  // namespace
}  // namespace slewlab::sim
