#include "common/unit.h"

#include <gtest/gtest.h>

#include <numbers>

namespace slewlab::common {
namespace {

TEST(Unit, ConvertsDeclaredSpellingsToSi) {
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::metre, "mm"), 1e-3);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::radian, "deg"), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::newton_metre, "kNm"), 1e3);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::radian_per_second, "rpm"), std::numbers::pi / 30.0);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::radian_per_second, "1/min"), std::numbers::pi / 30.0);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::kilogram_square_metre, "kg cm^2"), 1e-4);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::kilogram_square_metre, "g cm²"), 1e-7);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::newton_metre, "mNm"), 1e-3);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::newton_metre, "MNm"), 1e6);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::newton_metre, "N cm"), 1e-2);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::second, "ms"), 1e-3);
  EXPECT_DOUBLE_EQ(*factor_to_si(Unit::none, "%"), 0.01);
}

TEST(Unit, AcceptsTheWaysAUnitIsWritten) {
  for (const char* spelling : {"kg m^2", "kgm^2", "kg*m^2", "kg m²", "kg·m²"}) {
    EXPECT_TRUE(factor_to_si(Unit::kilogram_square_metre, spelling).has_value()) << spelling;
  }
  EXPECT_TRUE(factor_to_si(Unit::radian, "°").has_value());
}

TEST(Unit, RefusesAnotherQuantity) {
  EXPECT_FALSE(factor_to_si(Unit::newton_metre, "N m/rad").has_value());
  EXPECT_FALSE(factor_to_si(Unit::hertz, "rad/s").has_value());
  EXPECT_FALSE(factor_to_si(Unit::kilogram, "N").has_value());
  EXPECT_EQ(unit_of("MNm/rad"), Unit::newton_metre_per_radian);
  EXPECT_FALSE(unit_of("furlong").has_value());
}

}  // namespace
}  // namespace slewlab::common
