// The observer that goes on message by message against the one that follows the whole record.
#include "diagnosis/live_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "msgs/codec.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

sim::MachineSettings nominal() {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  return machine;
}

// All messages in the order of time, as a log has them: SENSORS of an instant behind ENCODER and TORQUE.
struct Wire {
  std::int64_t time;
  int order;
  std::string channel;
  std::vector<std::uint8_t> bytes;
};
std::vector<Wire> wire_of(const msgs::RunLog& log) {
  std::vector<Wire> all;
  const auto add = [&](const char* channel, int order, const auto& messages) {
    for (const auto& message : messages) {
      all.push_back({message.simulated_time, order, channel, {}});
      msgs::encode(message, all.back().bytes);
    }
  };
  add(msgs::kEncoderChannel, 0, log.encoder);
  add(msgs::kTorqueChannel, 1, log.torque);
  add(msgs::kSensorsChannel, 2, log.sensors);
  add(msgs::kPlantStatusChannel, 3, log.plant_status);
  std::stable_sort(all.begin(), all.end(), [](const Wire& a, const Wire& b) { return std::pair(a.time, a.order) < std::pair(b.time, b.order); });
  return all;
}

struct Told {
  LiveGap gap;
  std::vector<std::string> begun_again;
};
Told live(const std::vector<Wire>& wire) {
  LiveObserver observer(nominal());
  Told told;
  for (const Wire& message : wire) {
    observer.take(message.channel, message.bytes);
    const auto gap = observer.look();
    if (!gap) continue;
    if (!gap->begins_again.empty()) told.begun_again.push_back(gap->begins_again);
    told.gap.time.insert(told.gap.time.end(), gap->time.begin(), gap->time.end());
    for (std::size_t g = 0; g < 2; ++g) {
      auto& all = told.gap.missing_torque[g];
      all.insert(all.end(), gap->missing_torque[g].begin(), gap->missing_torque[g].end());
    }
    auto& all = told.gap.acceleration_difference[kTip];
    all.insert(all.end(), gap->acceleration_difference[kTip].begin(), gap->acceleration_difference[kTip].end());
  }
  return told;
}

double mean(const std::vector<double>& series, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t n = from; n < to; ++n) sum += series[n];
  return sum / static_cast<double>(to - from);
}

TEST(LiveObserver, SaysWhatTheObserverOfTheWholeRecordSays) {
  const msgs::RunLog log = simulated_log(nominal(), bench().controller, kThereAndBack, kDuration, 3);
  const Told told = live(wire_of(log));
  EXPECT_TRUE(told.begun_again.empty()) << told.begun_again.front();
  sim::MachineSettings machine = nominal();
  machine.crane.boom.highest_frequency = bench().thresholds.highest_mode;
  const Record record = make_record(log, "log", bench().admission);
  const Shadow whole = shadow(machine, record, bench_gains());
  ASSERT_GT(told.gap.time.size(), record.size() - 200u);
  for (std::size_t n = 0; n < told.gap.time.size(); ++n) {
    ASSERT_NEAR(told.gap.time[n], record.time(n), 1e-9);
    // Apart only by the rates of the positions, taken over as many samples behind as in front: the same sums in another place.
    ASSERT_NEAR(told.gap.missing_torque[0][n], whole.missing_torque[0][n], 1e-6) << n;
    ASSERT_NEAR(told.gap.missing_torque[1][n], whole.missing_torque[1][n], 1e-6) << n;
    ASSERT_NEAR(told.gap.acceleration_difference[kTip][n], whole.acceleration_difference[kTip][n], 1e-6) << n;
  }
}

// Brakes that drag with 5 Nm per motor: the motors need that much more than the nominal machine's while they turn.
TEST(LiveObserver, ShowsWhatIsMissingAtTheMotors) {
  constexpr double kDrag = 5.0;  // [Nm] per motor
  sim::MachineSettings dragging = nominal();
  dragging.effects.push_back({"dragging_brake", {kDrag, 0.0, 0.0}});  // the same at both groups, sliding at once
  const Told told = live(wire_of(simulated_log(dragging, bench().controller, kThereAndBack, kDuration, 3)));
  const Told usual = live(wire_of(simulated_log(nominal(), bench().controller, kThereAndBack, kDuration, 3)));
  for (std::size_t g = 0; g < 2; ++g) {
    // Turning to one side from 6 to 9 s, to the other from 17 to 19 s.
    EXPECT_NEAR(mean(told.gap.missing_torque[g], 6000, 9000), -kDrag, 0.1);
    EXPECT_NEAR(mean(told.gap.missing_torque[g], 17000, 19000), kDrag, 0.1);
    EXPECT_NEAR(mean(usual.gap.missing_torque[g], 6000, 9000), 0.0, 0.1);
  }
}

TEST(LiveObserver, BeginsAgainBehindAGapAndSaysWhy) {
  msgs::RunLog log = simulated_log(nominal(), bench().controller, kThereAndBack, kDuration, 3);
  const auto cut = [](auto& messages, std::size_t first) { messages.erase(messages.begin() + 5000 - static_cast<long>(first), messages.begin() + 5500 - static_cast<long>(first)); };
  cut(log.encoder, 0);
  cut(log.torque, 0);
  cut(log.sensors, 1);
  const Told told = live(wire_of(log));
  ASSERT_EQ(told.begun_again.size(), 1u);
  EXPECT_NE(told.begun_again[0].find("gap of 0.501 s in ENCODER"), std::string::npos) << told.begun_again[0];
  EXPECT_EQ(told.begun_again[0].find("slewlab cut"), std::string::npos) << told.begun_again[0];  // of a log alone
  EXPECT_GT(told.gap.time.back(), kDuration - 0.5);
  for (std::size_t n = 1; n < told.gap.time.size(); ++n) ASSERT_GT(told.gap.time[n], told.gap.time[n - 1]);
}

// A drive that trips at rest, is acknowledged and runs again. Behind the brakes the teeth stand anywhere, until torques press them.
TEST(LiveObserver, FindsNoGapInAMachineWhoseDriveTripsAndRunsAgain) {
  constexpr double kTrip = 10.0, kRunsAgain = 12.0;                   // [s]
  msgs::RunLog log = simulated_log(nominal(), bench().controller, kThereAndBack, kDuration, 3);
  // As PLANT_STATUS tells it each second; what stands before it is said with the next one alone.
  for (std::int64_t second = 0; second < static_cast<std::int64_t>(kDuration); ++second) {
    msgs::PlantStatus status{};
    status.run_identity = log.run_identity;
    status.simulated_time = second * 1'000'000'000;
    const auto at = static_cast<double>(second);
    const bool is_tripped = at > kTrip && at < kRunsAgain;
    status.drive_state = static_cast<std::int8_t>(is_tripped ? sim::DriveState::braked : sim::DriveState::running);
    status.trip_cause = static_cast<std::int8_t>(is_tripped ? sim::DriveFault::silence : sim::DriveFault::none);
    status.trip_time = at > kTrip ? static_cast<std::int64_t>(kTrip * 1e9) + 500'000'000 : -1;
    log.plant_status.push_back(status);
  }
  const Told told = live(wire_of(log));
  EXPECT_EQ(told.begun_again, (std::vector<std::string>{"the drive is tripped, and nothing is compared until it runs again", "the drive runs again"}));
  const auto is_told = [&](double from, double to) {
    return std::any_of(told.gap.time.begin(), told.gap.time.end(), [&](double time) { return time > from && time < to; });
  };
  EXPECT_TRUE(is_told(kTrip - 1.0, kTrip));
  EXPECT_FALSE(is_told(kTrip + 0.5, kRunsAgain));
  EXPECT_TRUE(is_told(kRunsAgain + 2.5, kDuration));
}

TEST(LiveObserver, GoesOnWhereNoPlantStatusComesAnyMore) {
  msgs::RunLog log = simulated_log(nominal(), bench().controller, kThereAndBack, kDuration, 3);
  msgs::PlantStatus only{};
  only.run_identity = log.run_identity;
  only.drive_state = static_cast<std::int8_t>(sim::DriveState::running);
  only.trip_time = -1;
  log.plant_status = {only};
  const Told told = live(wire_of(log));
  ASSERT_FALSE(told.gap.time.empty());
  EXPECT_GT(told.gap.time.back(), kDuration - 0.5);
}

}  // namespace
}  // namespace slewlab::diagnosis