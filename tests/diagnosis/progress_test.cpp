#include "diagnosis/progress.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace slewlab::diagnosis {
namespace {

TEST(Progress, TellsAStagesShareAsOneOfTheWhole) {
  double told = -1.0;
  std::string what;
  const Progress inner = within([&](double share, const std::string& doing) { told = share, what = doing; }, {0.2, 0.6});
  inner(0.25, "fitting");
  EXPECT_NEAR(told, 0.3, 1e-12);
  EXPECT_EQ(what, "fitting");
  within({}, kScreen)(0.5, "nobody listens");
}

// Nothing is left out and nothing counted twice.
TEST(Progress, StagesFollowEachOtherFromNothingToAll) {
  constexpr std::array kStages{kFitParameters, kScreen,          kRefineSingles, kLookFromNominal, kConvergeSingles, kScreenBeside,
                               kRefinePairs,   kConvergePairs, kGoBack,        kLookForStochastic,   kHoldOut,
                               kFollow};
  double until = 0.0;
  for (const Stage& stage : kStages) {
    EXPECT_EQ(stage.from, until);
    EXPECT_GT(stage.to, stage.from);
    until = stage.to;
  }
  EXPECT_EQ(until, 1.0);
}

// From where 60 % are left to where 30 % are, when half of the time is to be saved.
TEST(Progress, SaysOfAShorterSearchThatLessIsLeft) {
  double told = -1.0;
  shortened([&](double share, const std::string&) { told = share; }, 0.5)(0.4, "refining");
  EXPECT_NEAR(told, 0.7, 1e-12);
}

// From the beginning of the screening at an even pace: what the parameters took does not count, nor who is behind.
TEST(Forecast, TellsTheTimeLeftAtTheScreeningsPace) {
  Forecast forecast;
  forecast.tell(0.0, 0.0);
  forecast.tell(40.0, kScreen.from);
  forecast.tell(45.0, 0.5 * (kScreen.from + kScreen.to));
  EXPECT_FALSE(forecast.left().has_value()) << "what there is to be done shows at the end of the screening";
  forecast.tell(60.0, kScreen.from + 0.2);
  forecast.tell(60.0, kScreen.from + 0.1);
  ASSERT_TRUE(forecast.left().has_value());
  EXPECT_NEAR(*forecast.left(), (1.0 - kScreen.from - 0.2) * 100.0, 1e-9);
  EXPECT_NEAR(forecast.share(), kScreen.from + 0.2, 1e-12);
  forecast.tell(200.0, 1.0);
  EXPECT_EQ(*forecast.left(), 0.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
