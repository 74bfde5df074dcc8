// On a virtual clock: it stands still but for what a test says it does. No test looks at the machine's own time.

#include "sim/drive/wall_clock_loop.h"

#include <gtest/gtest.h>

#include <functional>

#include "msgs/memory_bus.h"
#include "sim/drive/drive_protection.h"
#include "sim/drive/plant_output.h"
#include "tests/sim/drive/toy_plant.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // [ns]

class VirtualClock : public LoopClock {
 public:
  std::int64_t now() override { return time; }
  std::int64_t processor_time() override { return worked; }
  void sleep_until(std::int64_t until) override {
    wakeups.push_back(until);
    if (until > time) time = until + latency;
  }
  void work(std::int64_t duration) { time += duration, worked += duration; }

  std::int64_t time = 123'456'789;
  std::int64_t worked = 0;
  std::int64_t latency = 0;
  std::vector<std::int64_t> wakeups;
};

// The toy plant under the drive's own bookkeeping, taking time as the test says.
class TimedPlant : public ToyPlant {
 public:
  void begin_cycle(std::int64_t sequence) override { sim::begin_cycle(drive, sequence); }
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override {
    sim::receive(settings, {2, 77, 10 * kMillisecond}, drive, {.time = steps * kMillisecond}, status, message);
    ToyPlant::receive(status, message);
  }
  void step(const PlantConditions& conditions) override {
    command = drive_command(settings, {2, 77, 10 * kMillisecond}, drive, {.time = steps * kMillisecond}, kMillisecond);
    ToyPlant::step(conditions);
    if (on_step) on_step(steps);
  }
  void read_status(msgs::PlantStatus& message) override {
    ToyPlant::read_status(message);
    message.drive_state = static_cast<std::int8_t>(drive.state);
    message.stale_commands = drive.stale_commands;
  }

  DriveProtectionSettings settings;
  DriveProtectionState drive;
  DriveCommand command;
  std::function<void(int)> on_step;
};

class WallClockLoopTest : public testing::Test {
 protected:
  WallClockLoopTest() {
    settings_.duration = 1000 * kMillisecond;
    settings_.configuration_hash = 77;
    settings_.operator_moves = {{0, 0.0, false, false}, {500 * kMillisecond, 1.0, false, false}};
    plant_.settings.answer_age_limit = 1;
    plant_.settings.silence_timeout = 100 * kMillisecond;
    controller_bus_->subscribe(msgs::kEncoderChannel, [this](msgs::Bytes bytes) {
      msgs::Encoder encoder;
      ASSERT_EQ(msgs::decode(bytes, encoder), msgs::DecodeStatus::ok);
      ++asked_;
      if (!answers_ || !answers_(encoder.sequence)) return;
      msgs::Torque torque{};
      torque.sequence = torque.answered_sequence = torque.alive_counter = encoder.sequence;
      torque.configuration_hash = encoder.configuration_hash;
      torque.run_identity = encoder.run_identity + (foreign_ ? 1 : 0);
      torque.enable = 1;
      torque.group_count = 2;
      torque.motor_torque = {1.0, 2.0};
      std::vector<std::uint8_t> out;
      msgs::encode(torque, out);
      controller_bus_->publish(msgs::kTorqueChannel, out);
    });
    plant_.on_step = [this](int step) {
      clock_.work(work_ ? work_(step) : 0);
      controller_bus_->drain();
    };
  }

  WallClockReport run() {
    plant_bus_ = wire_.connect();  // a bus serves one run
    plant_bus_->on_wait = [this] { controller_bus_->drain(); };
    return run_wall_clock(
        settings_, speed_, plant_, *plant_bus_,
        [this](const char* channel, std::int64_t, msgs::Bytes bytes) {
          ++logged_[channel];
          if (channel == std::string(msgs::kTorqueChannel)) largest_ = std::max(largest_, bytes.size());
          if (channel == std::string(msgs::kPlantStatusChannel)) msgs::decode(bytes, status_);
        },
        clock_, hooks_);
  }

  msgs::MemoryWire wire_;
  std::unique_ptr<msgs::MemoryBus> plant_bus_;
  std::unique_ptr<msgs::MemoryBus> controller_bus_ = wire_.connect();
  LockstepSettings settings_;
  double speed_ = 1.0;
  TimedPlant plant_;
  VirtualClock clock_;
  WallClockHooks hooks_;
  std::function<bool(std::int64_t)> answers_ = [](std::int64_t) { return true; };
  std::function<std::int64_t(int)> work_;
  int asked_ = 0;
  bool foreign_ = false;  // the controller answers as to another run
  int waits_ = 0;
  std::size_t largest_ = 0;  // [bytes] TORQUE in the log
  std::map<std::string, int> logged_;
  msgs::PlantStatus status_;
};

TEST_F(WallClockLoopTest, WakesAtStartPlusWholeStepsAndDoesNotDrift) {
  clock_.latency = 70'000;  // late every time, and never later for it
  const WallClockReport report = run();
  ASSERT_EQ(clock_.wakeups.size(), 1000u);
  for (std::int64_t i = 0; i < 1000; ++i) EXPECT_EQ(clock_.wakeups[i], clock_.wakeups[0] + i * kMillisecond);
  EXPECT_EQ(report.simulated_time, 1000 * kMillisecond);
  EXPECT_EQ(report.cycles, 100);
  EXPECT_EQ(report.missed_deadlines, 0);
  EXPECT_EQ(report.wakeup_latency.count(), 1000);
  EXPECT_EQ(report.wakeup_latency.largest(), 70'000);
  EXPECT_EQ(logged_["ENCODER"], 100);
  EXPECT_EQ(logged_["TORQUE"], 100);
}

TEST_F(WallClockLoopTest, TheSpeedStretchesTheWallClockAndNothingElse) {
  speed_ = 3.0;
  run();
  ASSERT_EQ(clock_.wakeups.size(), 1000u);
  // A third of a millisecond is no whole number of nanoseconds: the rounding does not add up either.
  for (std::int64_t i = 0; i < 1000; ++i) {
    EXPECT_NEAR(static_cast<double>(clock_.wakeups[i] - clock_.wakeups[0]), static_cast<double>(i) * 1e6 / 3.0, 0.51);
  }
  EXPECT_EQ(logged_["ENCODER"], 100);
}

TEST_F(WallClockLoopTest, CountsDeadlinesMissedByItsOwnWorkAndMakesUpForTheTime) {
  work_ = [](int step) { return step == 200 ? 2'500'000 : 100'000; };  // [ns]
  const WallClockReport report = run();
  // The step of 2.5 ms misses its deadline, and so does the next, which begins 1.5 ms late; then 0.6 ms late is in time.
  EXPECT_EQ(report.missed_deadlines, 2);
  EXPECT_EQ(report.missed_by_own_computation, 1);
  EXPECT_EQ(report.simulated_time, 1000 * kMillisecond);
  EXPECT_EQ(clock_.wakeups.back(), clock_.wakeups[0] + 999 * kMillisecond);
  EXPECT_EQ(report.step_time.largest(), 2'500'000);
}

TEST_F(WallClockLoopTest, ADelayThatIsNotItsOwnIsMissedButNotItsFault) {
  work_ = [this](int step) -> std::int64_t {
    if (step == 300) clock_.time += 5'200'000;  // the machine did something else
    return 0;
  };
  const WallClockReport report = run();
  EXPECT_EQ(report.missed_deadlines, 5);  // 5.2, 4.2 ... 1.2 ms late against a step of 1 ms
  EXPECT_EQ(report.missed_by_own_computation, 0);
}

TEST_F(WallClockLoopTest, AnswersAreNotWaitedForAndTheLastIsHeld) {
  answers_ = [](std::int64_t k) { return k % 5 != 3; };
  run();
  EXPECT_EQ(plant_.drive.stale_commands, 20);  // a fifth of 100 cycles
  EXPECT_EQ(plant_.drive.state, DriveState::running);
  EXPECT_EQ(plant_.command.motor_torque[1], 2.0);
  EXPECT_EQ(status_.stale_commands, plant_.drive.stale_commands);
}

TEST_F(WallClockLoopTest, SilenceTripsTheDriveAfterItsTimeInSimulatedMilliseconds) {
  for (const double speed : {1.0, 4.0}) {
    speed_ = speed;
    plant_.drive = {};
    plant_.steps = 0;
    answers_ = [](std::int64_t k) { return k <= 50; };
    int tripped_at = 0;
    plant_.on_step = [&](int step) {
      controller_bus_->drain();
      if (tripped_at == 0 && plant_.drive.trips > 0) tripped_at = step;
    };
    run();
    // ENCODER 50 goes out at 500 ms, its answer is there at the next step, 501 ms; 100 ms later it is too long ago.
    EXPECT_EQ(tripped_at, 602) << speed;  // the step that begins at 601 ms
    EXPECT_EQ(plant_.drive.trip_cause, DriveFault::silence);
  }
}

TEST_F(WallClockLoopTest, TheClockStartsWithTheFirstAnswer) {
  answers_ = [this](std::int64_t) { return asked_ >= 7; };
  const WallClockReport report = run();
  EXPECT_EQ(report.simulated_time, 1000 * kMillisecond);
  EXPECT_EQ(plant_.drive.stale_commands, 0);
  EXPECT_EQ(plant_.drive.trips, 0);
}

TEST_F(WallClockLoopTest, StatusCarriesTheHistogramsAndTheMisses) {
  clock_.latency = 70'000;
  work_ = [](int step) { return step == 200 ? 2'500'000 : 100'000; };
  const WallClockReport report = run();
  EXPECT_EQ(status_.missed_deadlines, report.missed_deadlines);
  ASSERT_EQ(status_.bin_count, LatencyHistogram::kOctaves);
  std::int64_t latencies = 0;
  for (int i = 0; i < status_.bin_count; ++i) {
    const double lower = i == 0 ? 0.0 : status_.bin_edge[i - 1];
    // All wake-ups but the one or two behind the long step came 70 us late.
    if (lower < 70e-6 && 70e-6 <= status_.bin_edge[i]) {
      EXPECT_GE(status_.wakeup_latency[i], 997);
    }
    latencies += status_.wakeup_latency[i];
  }
  EXPECT_EQ(latencies, 1000);
}

TEST_F(WallClockLoopTest, FaultsOnPurposeActHereToo) {
  Fault lost;
  lost.kind = FaultKind::message_lost;
  lost.from = 300 * kMillisecond;
  lost.until = 350 * kMillisecond;
  Fault power;
  power.kind = FaultKind::main_power_lost;
  power.from = 900 * kMillisecond;
  settings_.faults = {lost, power};
  run();
  EXPECT_EQ(plant_.drive.stale_commands, 5);
  EXPECT_EQ(logged_["TORQUE"], 95);
}

TEST_F(WallClockLoopTest, AFloodOfGarbageIsBoundedAndCounted) {
  const std::vector<std::uint8_t> garbage(60'000, 0xee);
  plant_.on_step = [&](int) {
    for (int i = 0; i < 100; ++i) controller_bus_->publish(msgs::kTorqueChannel, garbage);
    controller_bus_->drain();
  };
  const WallClockReport report = run();
  // Per period of 10 ms 4 of them and the controller's own answer; what comes behind the last step is not heard.
  EXPECT_EQ(logged_["TORQUE"], 100 + 100 * 4);
  EXPECT_EQ(report.cut_answers, 999 * 100);
  EXPECT_EQ(report.flooding_answers, 999 * 100 - 100 * 4);
  EXPECT_LE(largest_, kLargestAnswer);
  EXPECT_EQ(plant_.drive.faults[static_cast<std::size_t>(DriveFault::garbage)], 100 * 4);
  EXPECT_EQ(plant_.drive.trips, 0);
}

TEST_F(WallClockLoopTest, ATorqueOfAnotherRunDoesNotStartTheClock) {
  settings_.run_identity = 1;
  foreign_ = true;
  hooks_.while_waiting = [this](const WallClockReport&) { ++waits_; };
  hooks_.stop = [this] { return waits_ >= 10; };
  const WallClockReport report = run();
  EXPECT_EQ(report.simulated_time, 0);
  EXPECT_GE(report.foreign_answers, 10);
  EXPECT_EQ(logged_["TORQUE"], 0);
}

TEST_F(WallClockLoopTest, AStopIsHeardWithinAStep) {
  hooks_.stop = [this] { return plant_.steps >= 42; };
  EXPECT_EQ(run().simulated_time, 42 * kMillisecond);
}

TEST(LatencyHistogram, PercentilesAreRightToABin) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 10'000; ++i) histogram.add(i * 1000);  // 1 us to 10 ms evenly
  EXPECT_NEAR(histogram.percentile(0.5), 5.0e6, 0.045 * 5.0e6);
  EXPECT_NEAR(histogram.percentile(0.999), 9.99e6, 0.045 * 9.99e6);
  EXPECT_EQ(histogram.percentile(1.0), 1e7);
  EXPECT_EQ(histogram.count(), 10'000);
  std::int64_t sum = 0;
  for (int i = 0; i < LatencyHistogram::kOctaves; ++i) sum += histogram.octave_count(i);
  EXPECT_EQ(sum, 10'000);
}

}  // namespace
}  // namespace slewlab::sim
