#include "diagnosis/cause.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace slewlab::diagnosis {
namespace {

TEST(Cause, IsNamedByItsEffects) {
  Cause cause;
  EXPECT_EQ(told_name(cause), "only parameters are off");
  cause.effects = {"early", "load"};
  EXPECT_EQ(name_of(cause), "early with load");
  cause.also = {{"late", "load"}};
  EXPECT_EQ(told_name(cause), "early with load or late with load");
}

// The interval of a number is even to either side, that of a logarithm by a factor; a size may end beyond its range, which is doubted (doubt.h), a shape is what it can be. Of quantiles of the normal distribution.
TEST(Cause, SizesHaveNinetyPercentIntervals) {
  constexpr double kNinety = 1.645;
  const auto parameter = [](std::string_view name, common::ParameterScale scale, double lower) {
    return common::EffectParameter{.name = name, .unit = common::Unit::newton_metre, .per = common::ScaleOf::one, .meaning = "", .lower = lower, .upper = 10.0, .typical = 1.0, .prior_scale = 1.0,
                                   .scale = scale, .absent = 0.0};
  };
  common::EffectAbout about;
  about.name = "law";
  about.parameters = {parameter("size", common::ParameterScale::linear, 0.0), parameter("shape", common::ParameterScale::linear, 0.0), parameter("factor", common::ParameterScale::logarithmic, 0.01)};
  common::EffectCatalogue catalogue;
  catalogue.effects = {about};
  const std::vector<Size> sizes = sizes_of(catalogue, {{"law", {1.0, 1.0, 1.0}}}, {2.0, 2.0, 0.1});
  ASSERT_EQ(sizes.size(), 3U);
  EXPECT_EQ(sizes[0].parameter, "law.size");
  EXPECT_EQ(sizes[0].unit, "N m");
  EXPECT_NEAR(sizes[0].high - sizes[0].value, kNinety * sizes[0].deviation, 1e-12);
  EXPECT_NEAR(sizes[0].value - sizes[0].low, kNinety * sizes[0].deviation, 1e-12);
  EXPECT_GT(sizes[0].deviation, 2.0);  // laws differ as well
  EXPECT_LT(sizes[0].low, 0.0);
  EXPECT_EQ(sizes[1].low, 0.0);
  EXPECT_NEAR(sizes[2].low * sizes[2].high, 1.0, 1e-12);
  EXPECT_NEAR(std::log(sizes[2].high), kNinety * sizes[2].deviation, 1e-12);
}

// A size whose interval reaches zero may be none; of a limit, which is absent where it is endless, no interval says so.
TEST(Cause, ASizeMayBeNoneWhereItsIntervalReachesThere) {
  common::EffectAbout about;
  about.parameters.emplace_back();
  about.parameters[0].absent = 0.0;
  EXPECT_TRUE(may_be_absent(about, {"size", "N m", 0.1, 1.0, -1.5, 1.7}));
  EXPECT_FALSE(may_be_absent(about, {"size", "N m", 2.0, 1.0, 0.4, 3.6}));
  about.parameters[0].absent = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(may_be_absent(about, {"limit", "N m", 2.0, 1.0, 0.4, 3.6}));
  about.parameters[0].absent.reset();
  EXPECT_FALSE(may_be_absent(about, {"size", "N m", 0.1, 1.0, -1.5, 1.7}));
}

}  // namespace
}  // namespace slewlab::diagnosis
