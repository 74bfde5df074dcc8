#include "sim/drive/steering.h"

#include <gtest/gtest.h>

#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;       // [ns]
constexpr std::int64_t kAfterLoss = 12'000'000'000;  // [ns]

Steering steering() { return Steering({.controller_period = kPeriod, .drive = {.group_count = 2}, .seed = 1, .scenario_faults = 3, .after_loss = kAfterLoss}); }

using News = std::vector<std::string>;

TEST(Steering, TheLeversLastPlaceCountsInAPeriod) {
  Steering desk = steering();
  desk.take("operator 0.1 0 0");
  desk.take("operator 0.25 0 0");
  const SteeredPeriod period = desk.begin_period(3 * kPeriod);
  ASSERT_TRUE(period.move);
  EXPECT_EQ(period.move->speed_request, 0.25);
  EXPECT_EQ(period.move->time, 3 * kPeriod);
  EXPECT_FALSE(desk.begin_period(4 * kPeriod).move) << "nothing has changed";
  desk.take("operator 0.25 0 0");
  EXPECT_FALSE(desk.begin_period(5 * kPeriod).move) << "the same again is no change";
}

TEST(Steering, AButtonThatIsPressedAndLetGoAtOnceIsSeenForAPeriod) {
  Steering desk = steering();
  desk.take("operator 0 0 1");
  desk.take("operator 0 0 0");
  desk.take("operator 0.5 0 0");
  EXPECT_TRUE(desk.begin_period(0).move->acknowledge);
  const auto second = desk.begin_period(kPeriod).move;
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->acknowledge);
  EXPECT_EQ(second->speed_request, 0.5);
}

TEST(Steering, LossLetsGoOfTheLeverAndKeepsTheEmergencyStop) {
  Steering desk = steering();
  desk.take("operator 1 1 0");
  desk.begin_period(0);
  desk.take("pause");
  EXPECT_TRUE(desk.holds());
  desk.take("lost");
  EXPECT_FALSE(desk.holds()) << "nobody could let it go on";
  const auto move = desk.begin_period(kPeriod).move;
  ASSERT_TRUE(move);
  EXPECT_EQ(move->speed_request, 0.0);
  EXPECT_TRUE(move->emergency_stop);
  EXPECT_FALSE(desk.begin_period(kAfterLoss).ends_run);
  EXPECT_TRUE(desk.begin_period(kPeriod + kAfterLoss).ends_run) << "the machine stands by then";
}

TEST(Steering, SilenceLetsGoOfTheLeverUntilTheDeskSaysMore) {
  Steering desk = steering();
  EXPECT_FALSE(desk.patience()) << "nobody measures silence where nobody asked for it";
  desk.take("patience 1.5");
  EXPECT_EQ(desk.patience(), 1.5);
  desk.take("patience 0");
  EXPECT_EQ(desk.take_news().size(), 1u);
  desk.take("operator 1 1 1");
  desk.begin_period(0);
  desk.take("silence");
  const auto move = desk.begin_period(kPeriod).move;
  ASSERT_TRUE(move);
  EXPECT_EQ(move->speed_request, 0.0);
  EXPECT_TRUE(move->emergency_stop);
  EXPECT_FALSE(move->acknowledge);
  EXPECT_FALSE(desk.begin_period(kPeriod + kAfterLoss).ends_run);
  desk.take("operator 0.5 0 0");
  EXPECT_EQ(desk.begin_period(2 * kPeriod + kAfterLoss).move->speed_request, 0.5);
}

// Whatever the crane's size: times go with the root of its lengths, and do not know its masses. Of the thesis's T is 1.0 s (method.md).
TEST(Steering, TheEndAfterALossComesInTheMachinesOwnTime) {
  const auto seconds = [](const CraneParameters& crane) { return static_cast<double>(after_loss_of(crane)) * 1e-9; };
  const double thesis = seconds(thesis_crane());
  EXPECT_NEAR(thesis, 30.0, 1.0);
  EXPECT_NEAR(seconds(with_lengths_times(thesis_crane(), 0.25)), 0.5 * thesis, 1e-5);
  EXPECT_NEAR(seconds(with_masses_times(thesis_crane(), 1e-3)), thesis, 1e-5);
}

TEST(Steering, APauseLetsSingleCyclesPass) {
  Steering desk = steering();
  desk.take("cycle");
  desk.take("pause");
  EXPECT_TRUE(desk.holds()) << "a cycle that was asked for before the pause is none";
  desk.take("cycle");
  desk.take("cycle");
  EXPECT_FALSE(desk.holds());
  desk.begin_period(0);
  EXPECT_FALSE(desk.holds());
  desk.begin_period(kPeriod);
  EXPECT_TRUE(desk.holds());
  desk.take("resume");
  EXPECT_FALSE(desk.holds());
  desk.take("end");
  EXPECT_TRUE(desk.begin_period(2 * kPeriod).ends_run);
}

TEST(Steering, AFaultBeginsAndEndsWithPeriods) {
  Steering desk = steering();
  desk.take("fault begin 1 fault: {value: motor_group_lost, source: desk}, group: {value: 1, unit: '-', source: desk}");
  desk.take("fault begin 1 fault: {value: main_power_lost, source: desk}");
  const SteeredPeriod period = desk.begin_period(7 * kPeriod);
  ASSERT_EQ(period.faults.size(), 1u);
  ASSERT_TRUE(period.faults[0].begins);
  EXPECT_EQ(period.faults[0].begins->kind, FaultKind::motor_group_lost);
  EXPECT_EQ(period.faults[0].begins->group, 1);
  EXPECT_EQ(period.faults[0].begins->from, 7 * kPeriod);
  EXPECT_EQ(desk.take_news(), (News{"fault 1 from 0.070000000", "refused fault 1: it is under way"}));
  desk.take("fault end 1");
  desk.take("fault end 2");
  const SteeredPeriod later = desk.begin_period(9 * kPeriod);
  ASSERT_EQ(later.faults.size(), 1u);
  EXPECT_FALSE(later.faults[0].begins);
  EXPECT_EQ(later.faults[0].ends, 3u) << "behind the three of the scenario";
  EXPECT_EQ(desk.take_news(), (News{"fault 1 until 0.090000000", "refused fault 2: it is not under way"}));
}

TEST(Steering, AnEffectOfTheMachineIsSwitchedWithAPeriod) {
  Steering desk({.controller_period = kPeriod, .effects = {"", "gusts"}});
  desk.take("effect gusts off");
  desk.take("effect heel on");
  const SteeredPeriod period = desk.begin_period(4 * kPeriod);
  ASSERT_EQ(period.effects.size(), 1u);
  EXPECT_EQ(period.effects[0].effect, "gusts");
  EXPECT_FALSE(period.effects[0].on);
  EXPECT_EQ(period.effects[0].time, 4 * kPeriod);
  const News news = desk.take_news();
  ASSERT_EQ(news.size(), 2u);
  EXPECT_EQ(news[0].rfind("refused effect 'heel on'", 0), 0u) << news[0];
  EXPECT_EQ(news[1], "effect gusts off 0.040000000");
}

TEST(Steering, PlayCompensationIsSwitchedWithAPeriod) {
  Steering desk = steering();
  desk.take("play_compensation on");
  desk.take("play_compensation off");  // the last word counts
  const SteeredPeriod period = desk.begin_period(3 * kPeriod);
  ASSERT_TRUE(period.play_compensation);
  EXPECT_FALSE(*period.play_compensation);
  EXPECT_EQ(desk.take_news(), News{"play_compensation off 0.030000000"});
  EXPECT_FALSE(desk.begin_period(4 * kPeriod).play_compensation) << "nothing has changed";
}

TEST(Steering, WhatIsNoCommandIsRefusedAndChangesNothing) {
  Steering desk = steering();
  for (const char* line : {"operator 2 0 0", "operator nan 0 0", "operator 0.5 2 0", "operator 0.5", "speed -1", "speed x",
                           "fault begin 1 fault: {value: no_such_fault, source: desk}", "fault begin", "effect gusts on", "play_compensation", "play_compensation maybe", "dance", ""}) {
    desk.take(line);
    const SteeredPeriod period = desk.begin_period(0);
    EXPECT_FALSE(period.move) << line;
    EXPECT_TRUE(period.faults.empty()) << line;
    EXPECT_FALSE(period.play_compensation) << line;
    EXPECT_FALSE(period.ends_run) << line;
    const News news = desk.take_news();
    ASSERT_EQ(news.size(), 1u) << line;
    EXPECT_EQ(news[0].rfind("refused ", 0), 0u) << news[0];
  }
  EXPECT_EQ(desk.speed(), 1.0);
}

}  // namespace
}  // namespace slewlab::sim
