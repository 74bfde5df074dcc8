#include "controller/play_compensation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/controller_file.h"

namespace slewlab::controller {
namespace {

PlayCompensationSettings thesis_map() {
  return load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings.play_compensation;
}

struct Row {
  double average;
  double measured_1;
  double expected_1;
  double measured_2;
  double expected_2;
};

// Thesis Table 3.4, [%] of T100: average, T1, T1,exp, T2, T2,exp.
constexpr Row kTable34[] = {
    {0, 10, 10, -10, -10}, {48, 92, 93, 0, 3}, {57, 87, 88, 24, 24}, {18, 46, 46, -10, -10}, {-18, 10, 10, -46, -46},
};

TEST(PlayCompensation, GivesTable34WithinOnePoint) {
  const PlayCompensationSettings map = thesis_map();
  for (const Row& row : kTable34) {
    const HalfTorques torques = evaluate_play_map(map, row.average / 100.0);
    EXPECT_NEAR(100.0 * torques.half_1, row.expected_1, 1.0) << row.average;
    EXPECT_NEAR(100.0 * torques.half_2, row.expected_2, 1.0) << row.average;
    EXPECT_NEAR(100.0 * torques.half_1, row.measured_1, 1.0 + 1e-9) << row.average;
  }
}

TEST(PlayCompensation, IsMirroredForNegativeAverages) {
  const PlayCompensationSettings map = thesis_map();
  for (int i = 0; i <= 200; ++i) {
    const double average = 0.005 * i;
    const HalfTorques forward = evaluate_play_map(map, average);
    const HalfTorques backward = evaluate_play_map(map, -average);
    EXPECT_EQ(backward.half_1, -forward.half_2) << average;
    EXPECT_EQ(backward.half_2, -forward.half_1) << average;
  }
}

TEST(PlayCompensation, IsContinuousAndKeepsTheAverage) {
  const PlayCompensationSettings map = thesis_map();
  HalfTorques last = evaluate_play_map(map, -1.0);
  for (int i = -9999; i <= 10000; ++i) {
    const double average = 1e-4 * i;
    const HalfTorques torques = evaluate_play_map(map, average);
    // The steepest segment, 88 - 24 -> 100 - 100, rises by 76 over 43; T1 = 2 average + 10 by 2; 3 -> 24 by 21 / 9.
    EXPECT_LE(std::abs(torques.half_1 - last.half_1), 2.4e-4) << average;
    EXPECT_LE(std::abs(torques.half_2 - last.half_2), 2.4e-4) << average;
    // Table 3.4's rows keep it to one point (57: 88 and 24 are 56 on average).
    EXPECT_NEAR(0.5 * (torques.half_1 + torques.half_2), average, 0.0101) << average;
    // More is asked for in sum wherever the average is larger.
    EXPECT_GT(torques.half_1 + torques.half_2, last.half_1 + last.half_2) << average;
    EXPECT_LE(std::max(std::abs(torques.half_1), std::abs(torques.half_2)), 1.0) << average;
    EXPECT_GE(torques.half_1, torques.half_2) << average;
    last = torques;
  }
}

TEST(PlayCompensation, HoldsTheGearsUnderTensionWhileThereIsTorqueLeft) {
  const PlayCompensationSettings map = thesis_map();
  // Half 2 keeps working against half 1 up to where half 1 nears its limit.
  for (int n = 0; n <= 83; ++n) {  // to 0.415
    const double average = 0.005 * n;
    const HalfTorques torques = evaluate_play_map(map, average);
    EXPECT_NEAR(torques.half_2, -0.10, 1e-12) << average;
    EXPECT_NEAR(torques.half_1, 2.0 * average + 0.10, 1e-12) << average;
  }
}

// Motors may be allowed more than their rated torque: then the map must not hold them back.
TEST(PlayCompensation, BeyondTheMapTheGroupsGetTheAverage) {
  const PlayCompensationSettings map = thesis_map();
  for (const double average : {1.0, 1.2, 1.6}) {
    EXPECT_DOUBLE_EQ(evaluate_play_map(map, average).half_1, average);
    EXPECT_DOUBLE_EQ(evaluate_play_map(map, average).half_2, average);
    EXPECT_DOUBLE_EQ(evaluate_play_map(map, -average).half_1, -average);
  }
  PlayCompensationSettings shorter = map;
  shorter.point_count -= 1;  // ends at 57 %: 88 and 24
  EXPECT_NEAR(evaluate_play_map(shorter, 0.67).half_1, 0.98, 1e-12);
  EXPECT_NEAR(evaluate_play_map(shorter, 0.67).half_2, 0.34, 1e-12);
}

TEST(PlayCompensation, DividesTheGroupsInTwoHalves) {
  EXPECT_EQ(half_of_group(0, 1), 0);
  EXPECT_EQ(half_of_group(0, 2), 1);
  EXPECT_EQ(half_of_group(1, 2), 2);
  EXPECT_EQ(half_of_group(0, 3), 1);
  EXPECT_EQ(half_of_group(1, 3), 0);
  EXPECT_EQ(half_of_group(2, 3), 2);
  EXPECT_EQ(half_of_group(3, 8), 1);
  EXPECT_EQ(half_of_group(4, 8), 2);
}

TEST(PlayCompensation, IsSwitchedAtItsTimesInTheirOrder) {
  PlayCompensationSettings play{.enabled = true};
  EXPECT_TRUE(is_enabled(play, 0));
  add_switch(play, {.time = 30, .enabled = false});
  add_switch(play, {.time = 10, .enabled = false});
  add_switch(play, {.time = 20, .enabled = false});
  add_switch(play, {.time = 20, .enabled = true});  // the later word of one time counts
  EXPECT_TRUE(is_enabled(play, 9));
  EXPECT_FALSE(is_enabled(play, 10));
  EXPECT_FALSE(is_enabled(play, 19));
  EXPECT_TRUE(is_enabled(play, 20));
  EXPECT_TRUE(is_enabled(play, 29));
  EXPECT_FALSE(is_enabled(play, 30));
}

}  // namespace
}  // namespace slewlab::controller
