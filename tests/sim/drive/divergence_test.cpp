// A plant that is no machine any more ends its run, in lockstep and against the wall clock alike, and says when and what.

#include <gtest/gtest.h>

#include <limits>

#include "msgs/memory_bus.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/wall_clock_loop.h"
#include "tests/common/allocation_guard.h"
#include "tests/sim/drive/toy_plant.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

// From its 15th step on its speed is no number.
class LostPlant : public ToyPlant {
 public:
  std::optional<Divergence> divergence() const override {
    if (steps < 15) return std::nullopt;
    return Divergence{"slewing speed", "rad/s", std::numeric_limits<double>::quiet_NaN()};
  }
};

// Answers every ENCODER with no torque.
void answer(msgs::Bus& bus) {
  bus.subscribe(msgs::kEncoderChannel, [&bus](msgs::Bytes bytes) {
    msgs::Encoder encoder;
    ASSERT_EQ(msgs::decode(bytes, encoder), msgs::DecodeStatus::ok);
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = torque.alive_counter = encoder.sequence;
    torque.configuration_hash = encoder.configuration_hash;
    torque.group_count = encoder.group_count;
    torque.motor_torque.assign(encoder.shaft_speed.size(), 0.0);
    std::vector<std::uint8_t> reply;
    msgs::encode(torque, reply);
    bus.publish(msgs::kTorqueChannel, reply);
  });
}

// A clock that stands wherever the loop wants to be.
class ObligingClock : public LoopClock {
 public:
  std::int64_t now() override { return now_; }
  void sleep_until(std::int64_t time) override { now_ = time; }
  std::int64_t processor_time() override { return 0; }

 private:
  std::int64_t now_ = 0;
};

class DivergenceTest : public testing::Test {
 protected:
  DivergenceTest() {
    settings_.duration = 100 * kMillisecond;
    settings_.controller_period = 10 * kMillisecond;
    answer(*controller_bus_);
    plant_bus_->on_wait = [this] { controller_bus_->drain(); };
  }
  void expect_told(const std::function<void()>& run) {
    try {
      run();
      FAIL() << "the run went on";
    } catch (const PlantDiverged& error) {
      EXPECT_NE(std::string(error.what()).find("by 0.020 s of simulated time: slewing speed is nan rad/s"), std::string::npos)
          << error.what();
    }
    EXPECT_EQ(plant_.steps, 20) << "judged at the end of the controller's period";
  }

  LockstepSettings settings_;
  LostPlant plant_;
  msgs::MemoryWire wire_;
  decltype(wire_.connect()) plant_bus_ = wire_.connect();
  decltype(wire_.connect()) controller_bus_ = wire_.connect();
  LogSink no_log_ = [](const char*, std::int64_t, msgs::Bytes) {};
};

TEST_F(DivergenceTest, EndsALockstepRun) {
  expect_told([&] { run_lockstep(settings_, plant_, *plant_bus_, no_log_); });
}

TEST_F(DivergenceTest, EndsARunAgainstTheWallClock) {
  ObligingClock clock;
  expect_told([&] { run_wall_clock(settings_, 1.0, plant_, *plant_bus_, no_log_, clock); });
}

// The thesis's crane under full torque for two seconds stays one; a boom of 1e308 kg, as a file once could name it, does not.
TEST(CranePlantDivergence, IsFoundInTheStateAndCostsNoAllocation) {
  for (const bool possible : {true, false}) {
    MachineSettings settings;
    settings.crane = thesis_crane();
    if (!possible) settings.crane.boom.mass = 1e308;
    CranePlant plant(settings, DriveRun{settings.crane.drive.group_count, 7, 10 * kMillisecond});
    msgs::Torque torque{};
    torque.configuration_hash = 7;
    torque.enable = 1;
    torque.group_count = settings.crane.drive.group_count;
    torque.motor_torque.assign(static_cast<std::size_t>(torque.group_count), 250.0);
    for (std::int64_t cycle = 0; cycle < 200; ++cycle) {
      plant.begin_cycle(cycle);
      torque.sequence = torque.answered_sequence = torque.alive_counter = cycle;
      plant.receive(msgs::DecodeStatus::ok, torque);
      for (int i = 0; i < 10; ++i) plant.step({});
    }
    const tests::AllocationGuard guard;
    const bool diverged = plant.divergence().has_value();
    EXPECT_EQ(guard.count(), 0);
    EXPECT_EQ(diverged, !possible);
  }
}

}  // namespace
}  // namespace slewlab::sim
