#include <gtest/gtest.h>

#include "tests/controller/effects/change_by.h"

namespace slewlab::controller {
namespace {

// Table 3.4 at 18 %: 46 and -10. Half the offset: 32 and 4; none: 18 and 18.
TEST(OtherPlayCompensation, ScalesTheOffsetFromTheAverage) {
  for (const double factor : {1.0, 0.5, 0.0}) {
    ControllerSettings settings;
    settings.play_compensation.enabled = true;
    settings.play_compensation.point_count = 2;
    settings.play_compensation.points[0] = {0.0, 0.10, -0.10};
    settings.play_compensation.points[1] = {0.18, 0.46, -0.10};
    change_by("other_play_compensation", {factor}, settings);
    const HalfTorques positive = evaluate_play_map(settings.play_compensation, 0.18);
    EXPECT_NEAR(positive.half_1, 0.18 + factor * 0.28, 1e-12);
    EXPECT_NEAR(positive.half_2, 0.18 - factor * 0.28, 1e-12);
    const HalfTorques rest = evaluate_play_map(settings.play_compensation, 0.0);
    EXPECT_NEAR(rest.half_1, factor * 0.10, 1e-12);
    EXPECT_NEAR(rest.half_2, -factor * 0.10, 1e-12) << "the mirrored map joins without a jump";
  }
}

}  // namespace
}  // namespace slewlab::controller
