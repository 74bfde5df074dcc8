#include "sim/drive/lockstep_loop.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <random>

#include "msgs/log_reader.h"
#include "msgs/memory_bus.h"
#include "msgs/run_log.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/sim/drive/toy_plant.h"

namespace slewlab::sim {
namespace {

using msgs::Bytes;

constexpr std::int64_t kMillisecond = 1'000'000;

// A controller written from docs/wire.md alone, as a user would: torque = speed request of the operator - shaft speed.
class ToyController {
 public:
  explicit ToyController(msgs::Bus& bus) : bus_(bus) {
    bus.subscribe(msgs::kOperatorChannel, [this](Bytes bytes) {
      msgs::Operator message;
      ASSERT_EQ(msgs::decode(bytes, message), msgs::DecodeStatus::ok);
      if (!operator_ || message.sequence > operator_->sequence) operator_ = message;
    });
    bus.subscribe(msgs::kEncoderChannel, [this](Bytes bytes) {
      msgs::Encoder message;
      ASSERT_EQ(msgs::decode(bytes, message), msgs::DecodeStatus::ok);
      ++heard;
      if (message.sequence > answered) {
        if (!operator_ || operator_->sequence < message.operator_sequence) return;
        answered = message.sequence;
        compute(message);
      }
      if (message.sequence == answered) send();
    });
  }

  bool with_state = true;
  int wrong_groups = 0;
  std::int64_t wrong_sequence = 0;
  std::int64_t wrong_configuration = 0;
  std::int64_t answered = -1;
  int heard = 0;
  std::function<void(msgs::Bus& bus, std::int64_t sequence)> before_answer;

 private:
  void compute(const msgs::Encoder& encoder) {
    torque_.sequence = torque_.alive_counter = encoder.sequence;
    torque_.simulated_time = encoder.simulated_time;
    torque_.configuration_hash = encoder.configuration_hash + wrong_configuration;
    torque_.run_identity = encoder.run_identity;
    torque_.answered_sequence = encoder.sequence + wrong_sequence;
    torque_.enable = 1;
    torque_.state_follows = with_state;
    torque_.motor_torque.clear();
    for (const double speed : encoder.shaft_speed) torque_.motor_torque.push_back(operator_->speed_request - speed);
    torque_.motor_torque.resize(torque_.motor_torque.size() + wrong_groups);
    torque_.group_count = static_cast<int>(torque_.motor_torque.size());
    state_.sequence = state_.answered_sequence = encoder.sequence;
    state_.simulated_time = encoder.simulated_time;
    state_.configuration_hash = encoder.configuration_hash;
    state_.run_identity = encoder.run_identity;
    state_.group_count = 0;
  }
  void send() {
    if (before_answer) before_answer(bus_, answered);
    std::vector<std::uint8_t> bytes;
    if (with_state) {
      msgs::encode(state_, bytes);
      bus_.publish(msgs::kControllerStateChannel, bytes);
    }
    msgs::encode(torque_, bytes);
    bus_.publish(msgs::kTorqueChannel, bytes);
  }

  msgs::Bus& bus_;
  std::optional<msgs::Operator> operator_;
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
};

struct Result {
  LockstepCounts counts;
  std::vector<char> log;
  ToyPlant plant;
  std::int64_t answered = 0;
  std::map<std::string, int> live;  // messages on the bus by channel
};

class LockstepLoopTest : public testing::Test {
 protected:
  LockstepLoopTest() {
    settings_.duration = 100 * kMillisecond;
    settings_.configuration_hash = 77;
    settings_.run_identity = 1001;
    settings_.operator_moves = {{0, 0.0, false, false}, {25 * kMillisecond, 0.8, false, false}};
  }

  Result run(const std::function<void(ToyController&)>& set_up = {}) {
    msgs::MemoryWire wire;
    wire.copies = copies_;
    const auto plant_bus = wire.connect();
    const auto controller_bus = wire.connect();
    const auto listener = wire.connect();
    ToyController controller(*controller_bus);
    if (set_up) set_up(controller);
    Result result;
    for (const char* channel : {"SENSORS", "TRUTH", "PLANT_STATUS"}) {
      listener->subscribe(channel, [&result, channel](Bytes) { ++result.live[channel]; });
    }
    plant_bus->on_wait = [&] {
      if (!stopped_ || !stopped_()) controller_bus->drain();
    };
    const std::filesystem::path path = folder_.path() / "run.lcmlog";
    msgs::LogWriter log(path);
    result.counts = run_lockstep(settings_, result.plant, *plant_bus, log, hooks_);
    log.finish();
    listener->drain();
    std::ifstream file(path, std::ios::binary);
    result.log.assign(std::istreambuf_iterator<char>(file), {});
    result.answered = controller.answered;
    return result;
  }
  msgs::RunLog read() { return msgs::read_run_logs(folder_.path() / "run.lcmlog").runs.at(0); }

  LockstepSettings settings_;
  LockstepHooks hooks_;
  std::function<int(const std::string&, std::vector<std::uint8_t>&)> copies_;
  std::function<bool()> stopped_;
  int stop_after_ = 0;
  TemporaryFolder folder_;
};

TEST_F(LockstepLoopTest, TheTorqueOfEncoderKActsFromItsTimeOnAndNotEarlier) {
  run();
  const msgs::RunLog log = read();
  ASSERT_EQ(log.encoder.size(), 10u);
  ASSERT_EQ(log.torque.size(), 10u);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_EQ(log.encoder[k].simulated_time, static_cast<std::int64_t>(k) * 10 * kMillisecond);
    EXPECT_EQ(log.torque[k].answered_sequence, log.encoder[k].sequence);
    // J = 1 kg m^2: the speed gains torque * period.
    EXPECT_NEAR(log.encoder[k + 1].shaft_speed[0],
                log.encoder[k].shaft_speed[0] + 0.01 * log.torque[k].motor_torque[0], 1e-15);
  }
  // The operator moves at 25 ms, which the controller hears with ENCODER 3 at 30 ms.
  EXPECT_EQ(log.torque[2].motor_torque[0], 0.0);
  EXPECT_EQ(log.torque[3].motor_torque[0], 0.8);
}

TEST_F(LockstepLoopTest, TheLogHasTheCanonicalOrder) {
  settings_.duration = 40 * kMillisecond;
  settings_.controller_period = settings_.sensors_period = 10 * kMillisecond;
  settings_.truth_period = settings_.status_period = 20 * kMillisecond;
  run();
  msgs::LogReader reader(folder_.path() / "run.lcmlog");
  std::string order;
  msgs::LogEvent event;
  while (reader.next(event)) {
    order += std::string(event.channel) + "@" + std::to_string(event.timestamp_us / 1000) + " ";
  }
  EXPECT_EQ(order,
            "SENSORS@0 TRUTH@0 PLANT_STATUS@0 "
            "OPERATOR@0 ENCODER@0 CONTROLLER_STATE@0 TORQUE@0 SENSORS@10 "
            "ENCODER@10 CONTROLLER_STATE@10 TORQUE@10 SENSORS@20 TRUTH@20 PLANT_STATUS@20 "
            "ENCODER@20 CONTROLLER_STATE@20 TORQUE@20 SENSORS@30 "
            "OPERATOR@30 ENCODER@30 CONTROLLER_STATE@30 TORQUE@30 SENSORS@40 TRUTH@40 PLANT_STATUS@40 ");
}

TEST_F(LockstepLoopTest, EveryControllerPeriodOverTheOneMillisecondStep) {
  for (const int period : {1, 2, 5, 10, 20}) {
    settings_.controller_period = period * kMillisecond;
    const Result result = run();
    EXPECT_EQ(result.counts.cycles, 100 / period);
    EXPECT_EQ(result.plant.commands, 100 / period);
    EXPECT_EQ(result.plant.steps, 100);
    EXPECT_EQ(result.counts.simulated_time, 100 * kMillisecond);
    const msgs::RunLog log = read();
    EXPECT_EQ(log.encoder.size(), static_cast<std::size_t>(100 / period));
    EXPECT_EQ(log.sensors.size(), 101u);
    EXPECT_EQ(log.truth.size(), 11u);
    EXPECT_EQ(log.plant_status.size(), 2u);
  }
}

TEST_F(LockstepLoopTest, LostAndDoubledMessagesChangeNothingButTheCountOfResends) {
  const Result calm = run();
  EXPECT_EQ(calm.counts.resends, 0);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    copies_ = [&](const std::string&, std::vector<std::uint8_t>&) { return static_cast<int>(random() % 3); };
    const Result rough = run();
    EXPECT_GT(rough.counts.resends, 0) << seed;
    EXPECT_EQ(rough.log, calm.log) << seed;
  }
}

TEST_F(LockstepLoopTest, AControllerThatStandsStillForAWhileChangesNothing) {
  const Result calm = run();
  int asked = 0;
  stopped_ = [&] {
    ++asked;
    return asked > 5 && asked < 50;
  };
  const Result halted = run();
  EXPECT_GE(halted.counts.resends, 40);
  EXPECT_EQ(halted.log, calm.log);
}

TEST_F(LockstepLoopTest, AControllerThatComesUpLateHearsTheOperatorAndTheQuestionAgain) {
  const Result calm = run();
  int sent = 0;
  copies_ = [&](const std::string&, std::vector<std::uint8_t>&) { return ++sent > 12 ? 1 : 0; };
  const Result late = run();
  EXPECT_EQ(late.log, calm.log);
}

TEST_F(LockstepLoopTest, AControllerWithoutStateIsAnsweredTo) {
  const Result result = run([](ToyController& controller) { controller.with_state = false; });
  EXPECT_EQ(result.counts.cycles, 10);
  EXPECT_TRUE(read().controller_state.empty());
  EXPECT_EQ(read().torque.size(), 10u);
}

TEST_F(LockstepLoopTest, ATorqueWhoseStateIsMissingDoesNotMoveThePlant) {
  copies_ = [](const std::string& channel, std::vector<std::uint8_t>&) { return channel == "CONTROLLER_STATE" ? 0 : 1; };
  int asked = 0;
  hooks_.stop = [&] { return ++asked > 100; };
  const Result result = run();
  EXPECT_EQ(result.plant.commands, 0);
  EXPECT_EQ(result.plant.steps, 0);
  EXPECT_GT(result.counts.stale_answers, 0);
}

TEST_F(LockstepLoopTest, WrongAnswersAreHandedOnAndTimeGoesOn) {
  const Result foreign = run([](ToyController& controller) { controller.wrong_configuration = 1; });
  EXPECT_EQ(foreign.counts.wrong_answers, 10);
  EXPECT_EQ(foreign.plant.received.at(msgs::DecodeStatus::ok), 10);
  const Result other = run([](ToyController& controller) { controller.wrong_sequence = 3; });
  EXPECT_EQ(other.counts.wrong_answers, 10);
  EXPECT_EQ(other.counts.simulated_time, 100 * kMillisecond);
  const Result groups = run([](ToyController& controller) { controller.wrong_groups = 1; });
  EXPECT_EQ(groups.plant.received.at(msgs::DecodeStatus::ok), 10);
  EXPECT_EQ(groups.plant.commands, 0);
  copies_ = [](const std::string& channel, std::vector<std::uint8_t>& bytes) {
    if (channel == "TORQUE") bytes.pop_back();
    return 1;
  };
  const Result cut = run();
  EXPECT_EQ(cut.counts.wrong_answers, 10);
  EXPECT_EQ(cut.plant.received.at(msgs::DecodeStatus::truncated), 10);
  EXPECT_EQ(cut.plant.commands, 0);
}

// A second run's controller on the same bus: its answers are to other questions.
TEST_F(LockstepLoopTest, ATorqueOfAnotherRunIsNoAnswer) {
  const Result alone = run();
  msgs::Torque foreign{};
  foreign.configuration_hash = 77;
  foreign.run_identity = 1002;
  foreign.group_count = 2;
  foreign.motor_torque = {500.0, 500.0};
  int sent = 0;
  const Result crowded = run([&](ToyController& controller) {
    controller.before_answer = [&](msgs::Bus& bus, std::int64_t sequence) {
      foreign.sequence = foreign.answered_sequence = sequence;
      std::vector<std::uint8_t> bytes;
      msgs::encode(foreign, bytes);
      bus.publish(msgs::kTorqueChannel, bytes);
      ++sent;
    };
  });
  EXPECT_EQ(sent, 10);
  EXPECT_EQ(crowded.counts.foreign_answers, 10);
  EXPECT_EQ(crowded.counts.wrong_answers, 0);
  EXPECT_EQ(crowded.log, alone.log);
}

TEST_F(LockstepLoopTest, WrongAnswersMakeTheSameRunHoweverOftenTheControllerIsAsked) {
  const auto wrong = [](ToyController& controller) { controller.wrong_sequence = 3; };
  const Result calm = run(wrong);
  int asked = 0;
  stopped_ = [&] { return ++asked % 3 != 0; };
  const Result halted = run(wrong);
  EXPECT_GT(halted.counts.resends, 0);
  EXPECT_EQ(halted.log, calm.log);
}

TEST_F(LockstepLoopTest, AStopLeavesWholePeriods) {
  hooks_.stop = [this] { return stop_after_ <= 0; };
  hooks_.after_cycle = [this](const LockstepCounts&) { --stop_after_; };
  stop_after_ = 4;
  const Result result = run();
  EXPECT_EQ(result.counts.simulated_time, 40 * kMillisecond);
  EXPECT_EQ(read().sensors.size(), 41u);
}

TEST_F(LockstepLoopTest, TheBusCarriesFewerOutputsThanTheLog) {
  settings_.live_period = 50 * kMillisecond;
  const Result result = run();
  EXPECT_EQ(result.live.at("SENSORS"), 3);       // 0, 50, 100 ms
  EXPECT_EQ(result.live.at("TRUTH"), 3);
  EXPECT_EQ(result.live.at("PLANT_STATUS"), 2);  // 0, 100 ms
}

TEST_F(LockstepLoopTest, PeriodsThatDoNotFitAreRefused) {
  settings_.controller_period = 1'500'000;
  EXPECT_THROW(run(), std::invalid_argument);
  settings_.controller_period = 0;
  EXPECT_THROW(run(), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
