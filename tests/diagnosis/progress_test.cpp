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
  constexpr std::array kStages{kFitParameters, kScreen,          kRefineSingles, kConvergeSingles, kScreenBeside,
                               kRefinePairs,   kConvergePairs, kGoBack,        kLookForChance,   kHoldOut};
  double until = 0.0;
  for (const Stage& stage : kStages) {
    EXPECT_EQ(stage.from, until);
    EXPECT_GT(stage.to, stage.from);
    until = stage.to;
  }
  EXPECT_EQ(until, 1.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
