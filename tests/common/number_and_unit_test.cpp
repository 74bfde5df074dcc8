#include "common/number_and_unit.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

TEST(NumberAndUnit, TakesATextApart) {
  for (const char* text : {"60 t", "60t", "60   t"}) {
    const auto parts = number_and_unit(text);
    ASSERT_TRUE(parts) << text;
    EXPECT_EQ(parts->number, 60.0);
    EXPECT_EQ(parts->digits, "60");
    EXPECT_EQ(parts->unit, "t");
  }
  EXPECT_EQ(number_and_unit("-1.5e-3 kg m^2")->number, -1.5e-3);
  EXPECT_EQ(number_and_unit("-1.5e-3 kg m^2")->unit, "kg m^2");
}

TEST(NumberAndUnit, OfANumberAloneIsTheUnitEmpty) {
  EXPECT_EQ(number_and_unit("25.355")->number, 25.355);
  EXPECT_TRUE(number_and_unit("25.355")->unit.empty());
}

TEST(NumberAndUnit, NeedsANumberInFront) {
  for (const char* text : {"", " ", "t", "t 60", "-", "1.2.3 t"}) EXPECT_FALSE(number_and_unit(text)) << text;
}

}  // namespace
}  // namespace slewlab::common
