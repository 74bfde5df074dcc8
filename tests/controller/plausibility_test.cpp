#include "controller/plausibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slewlab::controller {
namespace {

constexpr double kPeriod = 0.01;        // [s]
constexpr int kGroups = 2;
constexpr double kSpeed = 100.0;        // [rad/s]
constexpr PlausibilitySettings kSettings{
    .speed_limit = 120.0, .acceleration_limit = 500.0, .tolerance = 2.0, .timeout = 0.05};
constexpr int kHeld = 5;  // readings within the time-out

// A shaft at constant speed; what is said of it can be changed before it is judged.
class Shafts {
 public:
  explicit Shafts(double speed = kSpeed) : speed_(speed) {}

  EncoderReading reading() const {
    EncoderReading reading;
    reading.sequence = cycle_;
    reading.simulated_time = cycle_ * 10'000'000;
    reading.group_count = kGroups;
    for (int i = 0; i < kGroups; ++i) {
      reading.shaft_speed[i] = speed_;
      reading.shaft_position[i] = speed_ * kPeriod * static_cast<double>(cycle_);
    }
    return reading;
  }
  void lose(int cycles) { cycle_ += cycles; }

  Plausibility judge(EncoderReading reading) {
    ++cycle_;
    judged = reading;
    return controller::judge(kSettings, kPeriod, kGroups, state, judged);
  }
  Plausibility judge() { return judge(reading()); }

  PlausibilityState state;
  EncoderReading judged;

 private:
  double speed_;
  std::int64_t cycle_ = 0;
};

using Change = void (*)(EncoderReading&);

struct Wrong {
  const char* name;
  Change change;
  bool possible_later = false;  // since the last plausible reading the shaft has had more time
};
constexpr double kInfinite = std::numeric_limits<double>::infinity();
const Wrong kWrong[] = {
    {"speed beyond its limit", [](EncoderReading& r) { r.shaft_speed[1] = 121.0; }},
    {"speed whose square overflows", [](EncoderReading& r) { r.shaft_speed[0] = -1e300; }},
    {"acceleration", [](EncoderReading& r) { r.shaft_speed[0] -= 8.0; }, true},  // 500 * 0.01 + 2 = 7 are possible
    {"position that stands still", [](EncoderReading& r) { r.shaft_position[1] -= kSpeed * kPeriod; }},
    // (500 / 4 * 0.01 + 2) * 0.01 = 0.0325 are possible
    {"position that jumps", [](EncoderReading& r) { r.shaft_position[0] += 0.04; }, true},
    {"position that is no number", [](EncoderReading& r) { r.shaft_position[0] = std::nan(""); }},
    {"infinite position", [](EncoderReading& r) { r.shaft_position[0] = kInfinite; }},
    {"time that stands still", [](EncoderReading& r) { r.simulated_time -= 10'000'000; }},
    {"time that runs back", [](EncoderReading& r) { r.simulated_time = -1; }},
    {"time far ahead", [](EncoderReading& r) { r.simulated_time += std::int64_t{1} << 60; }},
    {"sequence far ahead", [](EncoderReading& r) { r.sequence = std::numeric_limits<std::int64_t>::max(); }},
    {"sequence of the past", [](EncoderReading& r) { r.sequence = std::numeric_limits<std::int64_t>::min(); }},
};

TEST(Plausibility, WhatAShaftCanDoIsPlausible) {
  Shafts shafts;
  for (int i = 0; i < 100; ++i) {
    EncoderReading reading = shafts.reading();
    reading.shaft_speed[0] += i % 2 == 0 ? 1.0 : -1.0;         // 2 of the 7 rad/s that are possible
    reading.shaft_position[1] += i % 2 == 0 ? 0.008 : -0.008;  // 0.016 of 0.0325 rad
    ASSERT_EQ(shafts.judge(reading), Plausibility::plausible) << i;
    EXPECT_EQ(shafts.judged.shaft_speed, reading.shaft_speed);
  }
}

// Full acceleration, then full braking within one period: the position is farthest from the mean of the speeds.
TEST(Plausibility, TheHardestMotionWithinAPeriodIsPlausible) {
  Shafts shafts(0.0);
  ASSERT_EQ(shafts.judge(), Plausibility::plausible);
  EncoderReading reading = shafts.reading();
  reading.shaft_position[0] = 0.25 * kSettings.acceleration_limit * kPeriod * kPeriod;
  EXPECT_EQ(shafts.judge(reading), Plausibility::plausible);
}

TEST(Plausibility, EachWrongReadingAloneIsHeldOver) {
  for (const Wrong& wrong : kWrong) {
    Shafts shafts;
    for (int i = 0; i < 10; ++i) ASSERT_EQ(shafts.judge(), Plausibility::plausible);
    EncoderReading reading = shafts.reading();
    wrong.change(reading);
    EXPECT_EQ(shafts.judge(reading), Plausibility::held) << wrong.name;
    for (int i = 0; i < kGroups; ++i) EXPECT_EQ(shafts.judged.shaft_speed[i], kSpeed) << wrong.name;
    EXPECT_EQ(shafts.judge(), Plausibility::plausible) << wrong.name;
  }
}

TEST(Plausibility, WrongReadingsForLongerThanTheTimeOutAreUnusable) {
  for (const Wrong& wrong : kWrong) {
    if (wrong.possible_later) continue;
    Shafts shafts;
    for (int i = 0; i < 10; ++i) ASSERT_EQ(shafts.judge(), Plausibility::plausible);
    for (int i = 0; i <= kHeld; ++i) {
      EncoderReading reading = shafts.reading();
      wrong.change(reading);
      EXPECT_EQ(shafts.judge(reading), i < kHeld ? Plausibility::held : Plausibility::unusable) << wrong.name << ' ' << i;
    }
  }
}

TEST(Plausibility, UnusableUntilPlausibleForAsLong) {
  Shafts shafts;
  ASSERT_EQ(shafts.judge(), Plausibility::plausible);
  for (int i = 0; i <= kHeld; ++i) {
    EncoderReading wrong = shafts.reading();
    wrong.shaft_speed[0] = 1e9;
    shafts.judge(wrong);
  }
  for (int i = 0; i < kHeld; ++i) EXPECT_EQ(shafts.judge(), Plausibility::unusable) << i;
  EXPECT_EQ(shafts.judge(), Plausibility::plausible);
}

// An encoder that has no signal says so.
TEST(Plausibility, NoSignalIsUnusableAtOnce) {
  for (const double nothing : {std::nan(""), kInfinite, -kInfinite}) {
    Shafts shafts;
    ASSERT_EQ(shafts.judge(), Plausibility::plausible);
    EncoderReading reading = shafts.reading();
    reading.shaft_speed[1] = nothing;
    EXPECT_EQ(shafts.judge(reading), Plausibility::unusable);
  }
  Shafts shafts;
  EncoderReading reading = shafts.reading();
  reading.group_count = 3;
  EXPECT_EQ(shafts.judge(reading), Plausibility::unusable);
}

TEST(Plausibility, TheFirstReadingNeedsOnlyBeInRange) {
  Shafts plausible;
  plausible.lose(12345);
  EXPECT_EQ(plausible.judge(), Plausibility::plausible) << "a controller that is started while the machine turns";
  Shafts implausible(121.0);
  EXPECT_EQ(implausible.judge(), Plausibility::unusable);
}

// Lost ENCODER messages: what the shaft can have done meanwhile grows with the time.
TEST(Plausibility, AGapIsJudgedByItsLength) {
  Shafts shafts;
  ASSERT_EQ(shafts.judge(), Plausibility::plausible);
  shafts.lose(4);
  EncoderReading reading = shafts.reading();
  reading.shaft_speed[0] -= 25.0;  // 500 rad/s^2 over 50 ms and 2 rad/s: 27 are possible
  reading.shaft_position[0] -= 0.5 * 25.0 * 5 * kPeriod;
  EXPECT_EQ(shafts.judge(reading), Plausibility::plausible);
}

TEST(Plausibility, WithoutSettingsOnlyWhatIsNoNumberIsRefused) {
  PlausibilityState state;
  EncoderReading reading;
  reading.group_count = 1;
  for (const double speed : {1e300, -1e300, 0.0}) {
    ++reading.sequence;
    reading.simulated_time += 10'000'000;
    reading.shaft_speed[0] = speed;
    EXPECT_EQ(judge({}, kPeriod, 1, state, reading), Plausibility::plausible);
  }
}

}  // namespace
}  // namespace slewlab::controller
