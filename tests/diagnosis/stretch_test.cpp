#include "diagnosis/stretch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/msgs/logged_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kTime = 1.0;               // [s] characteristic, of the machine
constexpr std::int64_t kSecond = 1000000000;  // [ns]

// Each log of its own, for its run is read when it is asked for; they go when the tests end.
std::filesystem::path kept_log() {
  static const TemporaryFolder folder;
  static int count = 0;
  return folder.path() / (std::to_string(++count) + ".lcmlog");
}

// Two motors that turn at that speed [rad/s], read every 10 ms with positions counted to a hundredth of a radian.
msgs::LoggedRun run_of(const std::function<double(double)>& speed, double duration) {
  constexpr std::int64_t kPeriod = kSecond / 100;
  msgs::RunLog run;
  double position = 0.0;
  for (std::int64_t n = 0; n * kPeriod <= std::llround(duration * 1e9); ++n) {
    const double time = 1e-9 * static_cast<double>(n * kPeriod);
    msgs::Encoder encoder{};
    encoder.sequence = n;
    encoder.simulated_time = n * kPeriod;
    encoder.group_count = 2;
    const double counted = 0.01 * std::round(position / 0.01);
    encoder.shaft_position = {counted + 3.0, counted - 3.0};
    encoder.shaft_speed = {speed(time), speed(time)};
    run.encoder.push_back(encoder);
    position += 0.01 * speed(time);
  }
  return msgs::logged(run, kept_log());
}

// Up to a speed and back to rest, with 2 s for either.
double move(double time, double from, double to, double speed) {
  if (time < from || time > to) return 0.0;
  return speed * std::min({1.0, (time - from) / 2.0, (to - time) / 2.0});
}

// Shares of a whole: the short log whole, the two others half of what is left each.
TEST(Stretch, LogsShareWhatIsFitted) {
  EXPECT_EQ(fitted_lengths(std::vector<double>{100.0, 10.0, 500.0}, 90.0), (std::vector<double>{40.0, 10.0, 40.0}));
  EXPECT_EQ(fitted_lengths(std::vector<double>{20.0, 30.0}, 90.0), (std::vector<double>{20.0, 30.0}));
  EXPECT_TRUE(fitted_lengths({}, 90.0).empty());
}

// A long turn at constant speed holds one start and one stop, whatever its length: the two short moves beside each other hold twice as many. The stretch begins where the
// machine has stood for T before, and T before the first of them at the latest.
TEST(Stretch, StartsAndStopsCountAndNotTheWay) {
  const msgs::LoggedRun run = run_of([](double t) { return move(t, 5.0, 45.0, 100.0) + move(t, 60.0, 68.0, -100.0) + move(t, 72.0, 80.0, 100.0); }, 100.0);
  const std::vector<Stretch> stretches = stretches_by_motion(run, 30.0, kTime);
  ASSERT_FALSE(stretches.empty());
  EXPECT_GE(stretches[0].from, 47 * kSecond);
  EXPECT_LE(stretches[0].from, 59 * kSecond);
  EXPECT_EQ(stretches[0].to - stretches[0].from, 30 * kSecond);
  EXPECT_NEAR(stretches[0].motion, 400.0, 8.0);  // [rad/s]: up and down twice
}

TEST(Stretch, TheNextOnesLieBesideIt) {
  const msgs::LoggedRun run = run_of([](double t) { return move(t, 10.0, 20.0, 50.0) + move(t, 40.0, 50.0, 100.0) + move(t, 70.0, 80.0, 80.0); }, 100.0);
  const std::vector<Stretch> stretches = stretches_by_motion(run, 25.0, kTime);
  ASSERT_EQ(stretches.size(), 3u);
  const double largest[] = {100.0, 80.0, 50.0};
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_NEAR(stretches[s].motion, 2.0 * largest[s], 0.05 * largest[s]);
    for (std::size_t other = 0; other < s; ++other) EXPECT_TRUE(stretches[s].from > stretches[other].to || stretches[s].to < stretches[other].from);
  }
}

// A machine that never rests is cut where most moves; one that never moves gives nothing.
TEST(Stretch, WithoutARestItBeginsInMotion) {
  const msgs::LoggedRun swinging = run_of([](double t) { return (t > 50.0 ? 100.0 : 30.0) * std::cos(t) + 200.0; }, 100.0);
  const std::vector<Stretch> stretches = stretches_by_motion(swinging, 20.0, kTime);
  ASSERT_FALSE(stretches.empty());
  EXPECT_GE(stretches[0].from, 49 * kSecond);
  EXPECT_TRUE(stretches_by_motion(run_of([](double) { return 0.0; }, 100.0), 20.0, kTime).empty());
  EXPECT_TRUE(stretches_by_motion(swinging, 200.0, kTime).empty()) << "longer than the run";
}

// Numbers, masses and forces have no say, and times none but beside T: the run ten times as slow is cut at ten times the times.
TEST(Stretch, GoesWithTheMachinesTime) {
  const auto speed = [](double t) { return move(t, 5.0, 15.0, 40.0) + move(t, 52.0, 60.0, -90.0); };
  const std::vector<Stretch> fast = stretches_by_motion(run_of(speed, 90.0), 20.0, kTime);
  const std::vector<Stretch> slow = stretches_by_motion(run_of([&](double t) { return speed(t / 10.0); }, 900.0), 200.0, 10.0 * kTime);
  ASSERT_EQ(fast.size(), slow.size());
  for (std::size_t s = 0; s < fast.size(); ++s) EXPECT_NEAR(static_cast<double>(slow[s].from), 10.0 * static_cast<double>(fast[s].from), 2.6e9);  // a coarse speed's time
}

// Behind the move the load swings on and draws the motors to and fro: nothing to fit there.
TEST(Stretch, WhereTheMachineStandsIsNone) {
  const msgs::LoggedRun run = run_of([](double t) { return move(t, 10.0, 20.0, 100.0) + (t > 20.0 ? 2.0 * std::sin(t) : 0.0); }, 100.0);
  EXPECT_EQ(stretches_by_motion(run, 25.0, kTime).size(), 1u);
}

}  // namespace
}  // namespace slewlab::diagnosis
