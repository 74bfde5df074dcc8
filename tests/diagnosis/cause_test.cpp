#include "diagnosis/cause.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
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

// An angle of which nothing is known may be any; one that is known better may lie beyond half a turn, where the same direction has another number.
TEST(Cause, AnAngleIsNoMoreThanAllRound) {
  constexpr double kHalfTurn = std::numbers::pi;
  common::EffectAbout about;
  about.name = "law";
  about.parameters = {{.name = "size", .unit = common::Unit::newton_metre, .meaning = "", .lower = 0.0, .upper = 10.0, .typical = 1.0, .prior_scale = 1.0, .absent = 0.0},
                      common::angle_parameter("direction", "", 0.0)};
  common::EffectCatalogue catalogue;
  catalogue.effects = {about};
  const auto angle_of = [&](double deviation) { return sizes_of(catalogue, {{"law", {1.0, 3.0}}}, {0.1, deviation}).back(); };
  EXPECT_EQ(angle_of(2.0).low, -kHalfTurn);
  EXPECT_EQ(angle_of(2.0).high, kHalfTurn);
  EXPECT_GT(angle_of(0.2).high, kHalfTurn);
}

// A size may be none by what the records say of it, whatever laws differ by: a factor of 1.04 that is known to a hundredth is not 1, though its interval, as wide as laws differ, holds it. Of a limit, which is absent where it is
// endless, no interval says so.
TEST(Cause, ASizeMayBeNoneWhereTheRecordsDoNotTellItFromThat) {
  common::EffectParameter factor{.name = "factor", .unit = common::Unit::none, .per = common::ScaleOf::one, .meaning = "", .lower = 0.1, .upper = 10.0, .typical = 1.2, .prior_scale = 0.1,
                                 .scale = common::ParameterScale::logarithmic, .absent = 1.0};
  common::EffectAbout about;
  about.name = "law";
  const auto size_of = [&](double value, double deviation) {
    about.parameters = {factor};
    common::EffectCatalogue catalogue;
    catalogue.effects = {about};
    return sizes_of(catalogue, {{"law", {value}}}, {deviation}).front();
  };
  const Size known = size_of(1.04, 0.01);
  EXPECT_FALSE(known.may_be_none);
  EXPECT_LT(known.low, 1.0);
  EXPECT_TRUE(size_of(1.04, 0.02).may_be_none);
  EXPECT_TRUE(size_of(0.96, 0.02).may_be_none);
  factor.absent = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(size_of(1.04, 0.02).may_be_none);
}

}  // namespace
}  // namespace slewlab::diagnosis
