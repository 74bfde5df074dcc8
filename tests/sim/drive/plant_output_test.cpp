// Counted by hand from the periods.
#include "sim/drive/plant_output.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "msgs/memory_bus.h"
#include "tests/sim/drive/toy_plant.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

class PlantOutputTest : public testing::Test {
 protected:
  PlantOutputTest() {
    settings_.sensors_period = kMillisecond;
    settings_.truth_period = 10 * kMillisecond;
    settings_.status_period = 50 * kMillisecond;
    settings_.live_period = 20 * kMillisecond;
    settings_.configuration_hash = 77;
    settings_.run_identity = 78;
    for (const char* channel : {msgs::kOperatorChannel, msgs::kSensorsChannel, msgs::kTruthChannel, msgs::kPlantStatusChannel}) {
      listener_->subscribe(channel, [this, channel](msgs::Bytes) { ++heard_[channel]; });
    }
  }
  void listen() {
    while (listener_->handle_one(std::chrono::milliseconds(0))) {
    }
  }

  LockstepSettings settings_;
  ToyPlant plant_;
  msgs::MemoryWire wire_;
  std::unique_ptr<msgs::MemoryBus> bus_ = wire_.connect(), listener_ = wire_.connect();
  std::map<std::string, int> heard_;
  std::vector<std::pair<std::string, std::int64_t>> logged_;  // channel, time [us]
  LogSink sink_ = [this](const char* channel, std::int64_t time, msgs::Bytes) { logged_.emplace_back(channel, time); };
  PlantOutput output_{settings_, plant_, *bus_, sink_};

  int logged(const std::string& channel) const {
    return static_cast<int>(std::count_if(logged_.begin(), logged_.end(), [&](const auto& event) { return event.first == channel; }));
  }
};

// 0 to 100 ms: every series at both ends; on the bus where its period and the live period (20 ms) fall together.
TEST_F(PlantOutputTest, SeriesKeepTheirPeriodsInTheLogAndTheLivePeriodOnTheBus) {
  for (std::int64_t time = 0; time <= 100 * kMillisecond; time += kMillisecond) output_.send_series(time);
  listen();
  EXPECT_EQ(logged(msgs::kSensorsChannel), 101);
  EXPECT_EQ(logged(msgs::kTruthChannel), 11);
  EXPECT_EQ(logged(msgs::kPlantStatusChannel), 3);  // 0, 50, 100 ms
  EXPECT_EQ(heard_[msgs::kSensorsChannel], 6);      // 0, 20, ... 100 ms
  EXPECT_EQ(heard_[msgs::kTruthChannel], 6);
  EXPECT_EQ(heard_[msgs::kPlantStatusChannel], 2);  // 0 and 100 ms
  EXPECT_EQ(logged_.back().second, 100'000);
}

TEST_F(PlantOutputTest, StatusIsCompletedBeforeItIsSent) {
  msgs::PlantStatus seen{};
  listener_->subscribe(msgs::kPlantStatusChannel, [&](msgs::Bytes bytes) { ASSERT_EQ(msgs::decode(bytes, seen), msgs::DecodeStatus::ok); });
  output_.send_series(0, [](msgs::PlantStatus& status) { status.missed_deadlines = 5; });
  listen();
  EXPECT_EQ(seen.missed_deadlines, 5);
  EXPECT_EQ(seen.configuration_hash, 77);
  EXPECT_EQ(seen.run_identity, 78);
}

// The first call speaks even where nothing moves; afterwards only moves do, each once. A repetition is no event of the log.
TEST_F(PlantOutputTest, OperatorSpeaksWhereTheJoystickMoves) {
  settings_.operator_moves = {{10 * kMillisecond, 0.5, false, false}, {30 * kMillisecond, 0.0, false, false}};
  EXPECT_EQ(output_.operator_sequence(), -1);
  for (std::int64_t time = 0; time <= 50 * kMillisecond; time += 10 * kMillisecond) output_.send_operator_moves(time);
  output_.repeat_operator();
  listen();
  EXPECT_EQ(logged_, (std::vector<std::pair<std::string, std::int64_t>>{
                         {msgs::kOperatorChannel, 0}, {msgs::kOperatorChannel, 10'000}, {msgs::kOperatorChannel, 30'000}}));
  EXPECT_EQ(heard_[msgs::kOperatorChannel], 4);
  EXPECT_EQ(output_.operator_sequence(), 2);
}

}  // namespace
}  // namespace slewlab::sim
