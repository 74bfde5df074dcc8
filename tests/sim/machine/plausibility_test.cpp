#include "sim/machine/plausibility.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

// The keys that are found implausible, blanks between.
std::string keys(const CraneParameters& crane, double step = kStep) {
  std::string text;
  for (const ImplausibleValue& value : implausible_values(crane, step)) text += (text.empty() ? "" : " ") + value.key;
  return text;
}

TEST(Plausibility, TheThesissCraneIsPlausibleAtAnyScale) {
  EXPECT_EQ(keys(thesis_crane()), "");
  for (const double factor : {1e-6, 1e-3, 1e3}) EXPECT_EQ(keys(with_masses_times(thesis_crane(), factor)), "") << factor;
}

// 60 t as 60 000 t, the slip of kg for t.
TEST(Plausibility, ALoadOfManyBooms) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 60e6;
  const auto found = implausible_values(crane, kStep);
  ASSERT_GE(found.size(), 1u);
  EXPECT_EQ(found[0].key, "load.mass");
  EXPECT_EQ(found[0].found, "a load of 740 times the boom's mass");  // 6e7 / 81 047
}

// A thousand times the stiffness is 32 times the frequency, 103 Hz: 9.7 steps of 1 ms to a period. A shorter step has more.
TEST(Plausibility, GearsTooStiffForTheStep) {
  CraneParameters crane = thesis_crane();
  crane.drive.gearbox_stiffness *= 1000.0;
  EXPECT_EQ(keys(crane), "drive.gearbox_stiffness");
  EXPECT_EQ(keys(crane, 1e-4), "");
  EXPECT_EQ(keys(crane, 0.0), "") << "no step is known";
}

TEST(Plausibility, RopesThatAreNoRopes) {
  CraneParameters crane = thesis_crane();
  crane.load.rope_length = 1e-3;  // millimetres for metres
  EXPECT_EQ(keys(crane), "load.rope_length");
  crane.load.rope_length = 6e3;
  EXPECT_EQ(keys(crane), "load.rope_length");
}

TEST(Plausibility, ABoomOfJelly) {
  CraneParameters crane = thesis_crane();
  crane.boom.youngs_modulus *= 1e-3;  // MPa for GPa
  crane.boom.shear_modulus *= 1e-3;
  EXPECT_EQ(keys(crane), "boom.youngs_modulus");
}

}  // namespace
}  // namespace slewlab::sim
