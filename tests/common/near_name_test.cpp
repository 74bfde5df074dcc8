#include "common/near_name.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

// Distances counted by hand: letters put in, left out, changed or swapped with the next one.
TEST(NearName, IsTheOneWithTheFewestChanges) {
  EXPECT_EQ(nearest_name("rope_lenght", {"rod_length", "rope_length"}), "rope_length");  // 1, and 3 of the other
  EXPECT_EQ(nearest_name("vray", {"draw", "vary"}), "vary");  // 1, and 2 of the other
  EXPECT_EQ(nearest_name("mas", {"mass", "masses"}), "mass");
}

TEST(NearName, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("gearbox_ratio", {"mass", "rope_length"}), std::nullopt);
  EXPECT_EQ(nearest_name("abc", {"xyz"}), std::nullopt);  // 3 of 3
  EXPECT_EQ(nearest_name("4", {"2", "3"}), std::nullopt);  // 1 of 1
}

TEST(NearName, StandsBeforeTheOthersInWords) {
  EXPECT_EQ(known_names_text("mas", {"mass", "rope_length"}), "'mass' (or one of mass, rope_length)");
  EXPECT_EQ(known_names_text("gears", {"mass", "rope_length"}), "one of mass, rope_length");
}

}  // namespace
}  // namespace slewlab::common
