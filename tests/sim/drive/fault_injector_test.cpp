#include "sim/drive/fault_injector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "msgs/codec.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;  // [ns]

// Passes one byte string per period, its own number, and lists what arrives in each.
std::vector<std::vector<std::int64_t>> arrivals(const std::vector<Fault>& faults, int periods) {
  FaultInjector injector(faults, kPeriod);
  std::vector<std::vector<std::int64_t>> all;
  for (std::int64_t k = 0; k < periods; ++k) {
    injector.begin_period(FaultChannel::torque, k * kPeriod);
    const std::uint8_t byte = static_cast<std::uint8_t>(k);
    injector.pass(FaultChannel::torque, k * kPeriod, k, {&byte, 1});
    injector.end_period(FaultChannel::torque);
    all.emplace_back();
    for (const auto& message : injector.arrivals(FaultChannel::torque)) all.back().push_back(message.sequence);
  }
  return all;
}

Fault fault(FaultKind kind, std::int64_t from, std::int64_t until) {
  Fault result;
  result.kind = kind;
  result.from = from * kPeriod;
  result.until = until * kPeriod;
  return result;
}

using Lists = std::vector<std::vector<std::int64_t>>;

TEST(FaultInjector, AProcessThatIsStoppedIsToldSoAndItsQuestionsGoOn) {
  FaultInjector injector({fault(FaultKind::controller_stopped, 1, 3)}, kPeriod, Stopping::process_stopped);
  std::string story;
  for (std::int64_t k = 0; k < 5; ++k) {
    for (const ControllerAction action : injector.controller_actions(k * kPeriod)) {
      story += action == ControllerAction::stop ? 'S' : action == ControllerAction::resume ? 'C' : '?';
    }
    injector.begin_period(FaultChannel::encoder, k * kPeriod);
    const std::uint8_t byte = 0;
    injector.pass(FaultChannel::encoder, k * kPeriod, k, {&byte, 1});
    injector.end_period(FaultChannel::encoder);
    for (const auto& message : injector.arrivals(FaultChannel::encoder)) story += std::to_string(message.sequence);
  }
  EXPECT_EQ(story, "0S12C34");
}

TEST(FaultInjector, WithoutFaultsEverythingPasses) { EXPECT_EQ(arrivals({}, 3), (Lists{{0}, {1}, {2}})); }

TEST(FaultInjector, LostFromItsBeginningToBeforeItsEnd) {
  EXPECT_EQ(arrivals({fault(FaultKind::message_lost, 1, 3)}, 4), (Lists{{0}, {}, {}, {3}}));
}

TEST(FaultInjector, DelayedArrivesBeforeThePeriodsOwn) {
  Fault delayed = fault(FaultKind::message_delayed, 1, 2);
  delayed.cycles = 2;
  EXPECT_EQ(arrivals({delayed}, 5), (Lists{{0}, {}, {2}, {1, 3}, {4}}));
}

TEST(FaultInjector, ReorderedArrivesBehindTheNext) {
  EXPECT_EQ(arrivals({fault(FaultKind::message_reordered, 1, 2)}, 4), (Lists{{0}, {}, {2, 1}, {3}}));
}

TEST(FaultInjector, DuplicatedArrivesTwice) {
  EXPECT_EQ(arrivals({fault(FaultKind::message_duplicated, 1, 2)}, 3), (Lists{{0}, {1, 1}, {2}}));
}

TEST(FaultInjector, ProbabilityAndSeedDecideMessageByMessage) {
  Fault lost = fault(FaultKind::message_lost, 0, 20'000);
  lost.probability = 0.3;
  lost.seed = 5;
  const Lists first = arrivals({lost}, 20'000);
  EXPECT_EQ(arrivals({lost}, 20'000), first);
  std::int64_t count = 0;
  for (const auto& list : first) count += list.empty();
  EXPECT_NEAR(static_cast<double>(count), 6000.0, 5.0 * std::sqrt(20'000 * 0.3 * 0.7));  // binomial
  lost.seed = 6;
  EXPECT_NE(arrivals({lost}, 20'000), first);
}

// What arrives in each of five periods at a controller that is stopped from the second one on; ended from outside at the beginning of a period, where one is given.
Lists questions_of_a_stopped_controller(Fault stopped, std::optional<std::int64_t> ended_in = {}) {
  FaultInjector injector({stopped}, kPeriod);
  Lists all;
  for (std::int64_t k = 0; k < 5; ++k) {
    if (k == ended_in) injector.end(0, k * kPeriod);
    injector.begin_period(FaultChannel::encoder, k * kPeriod);
    injector.pass(FaultChannel::encoder, k * kPeriod, k, {});
    injector.end_period(FaultChannel::encoder);
    all.emplace_back();
    for (const auto& message : injector.arrivals(FaultChannel::encoder)) all.back().push_back(message.sequence);
  }
  return all;
}

TEST(FaultInjector, AStoppedControllerFindsAllQuestionsInOrder) {
  EXPECT_EQ(questions_of_a_stopped_controller(fault(FaultKind::controller_stopped, 1, 3)), (Lists{{0}, {}, {}, {1, 2, 3}, {4}}));
}

// Switched off while it runs it does what a schedule with the same times does.
TEST(FaultInjector, AStoppedControllerThatIsSwitchedOnFindsTheSameQuestions) {
  Fault endless = fault(FaultKind::controller_stopped, 1, 3);
  endless.until = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(questions_of_a_stopped_controller(endless, 3), questions_of_a_stopped_controller(fault(FaultKind::controller_stopped, 1, 3)));
}

TEST(FaultInjector, TheControllerIsKilledAndStartedOnce) {
  FaultInjector injector({fault(FaultKind::controller_killed, 2, 4), fault(FaultKind::controller_killed, 6, 6)}, kPeriod);
  std::string story;
  for (std::int64_t k = 0; k < 8; ++k) {
    story += injector.controller_absent(k * kPeriod) ? 'x' : '.';
    for (const ControllerAction action : injector.controller_actions(k * kPeriod)) {
      story += action == ControllerAction::kill ? 'K' : 'S';
    }
  }
  EXPECT_EQ(story, "..xKx.S..KS.");
}

// Of a question that was held back for a controller that was killed meanwhile nobody knows: asked, it would be waited for without end.
TEST(FaultInjector, WhatIsHeldBackForAKilledControllerIsLost) {
  for (const FaultKind kind : {FaultKind::message_reordered, FaultKind::message_delayed}) {
    Fault late = fault(kind, 0, 9);
    late.channel = FaultChannel::encoder;
    late.probability = 1.0;
    late.cycles = 1;
    FaultInjector injector({late, fault(FaultKind::controller_killed, 3, 6)}, kPeriod);
    std::string heard;
    for (std::int64_t k = 0; k < 9; ++k) {
      injector.controller_actions(k * kPeriod);
      injector.begin_period(FaultChannel::encoder, k * kPeriod);
      if (!injector.controller_absent(k * kPeriod)) injector.pass(FaultChannel::encoder, k * kPeriod, k, std::vector<std::uint8_t>{1});
      injector.end_period(FaultChannel::encoder);
      heard += std::to_string(injector.arrivals(FaultChannel::encoder).size());
    }
    // One behind from the first period on, nothing while there is nobody, and behind again.
    EXPECT_EQ(heard, "011000011") << static_cast<int>(kind);
  }
}

// TORQUE number k, whose alive counter is 100 + k, as it comes out.
msgs::Torque passed(FaultInjector& injector, std::int64_t k) {
  msgs::Torque torque{};
  torque.answered_sequence = k;
  torque.alive_counter = 100 + k;
  torque.group_count = 1;
  torque.motor_torque = {1.0};
  std::vector<std::uint8_t> bytes;
  msgs::encode(torque, bytes);
  injector.begin_period(FaultChannel::torque, k * kPeriod);
  injector.pass(FaultChannel::torque, k * kPeriod, k, bytes);
  injector.end_period(FaultChannel::torque);
  EXPECT_EQ(msgs::decode(injector.arrivals(FaultChannel::torque).at(0).bytes, torque), msgs::DecodeStatus::ok);
  return torque;
}

Fault corrupted(Corruption corruption, std::int64_t from, std::int64_t until) {
  Fault result = fault(FaultKind::message_corrupted, from, until);
  result.corruption = corruption;
  return result;
}

// Each holds the counter that it found, whatever the other one in the schedule does.
TEST(FaultInjector, TwoFrozenAliveCountersDoNotDisturbEachOther) {
  for (const bool later_first : {false, true}) {
    std::vector<Fault> faults{corrupted(Corruption::alive_frozen, 1, 4), corrupted(Corruption::alive_frozen, 6, 9)};
    if (later_first) std::swap(faults[0], faults[1]);
    FaultInjector injector(faults, kPeriod);
    std::vector<std::int64_t> counters;
    for (std::int64_t k = 0; k < 10; ++k) counters.push_back(passed(injector, k).alive_counter);
    EXPECT_EQ(counters, (std::vector<std::int64_t>{100, 101, 101, 101, 104, 105, 106, 106, 106, 109})) << later_first;
  }
}

TEST(FaultInjector, ATorqueBeyondTheLimitIsTheFaultsOwn) {
  Fault beyond = corrupted(Corruption::torque_limit, 1, 2);
  beyond.torque = 7e4;
  FaultInjector injector({beyond}, kPeriod);
  EXPECT_EQ(passed(injector, 0).motor_torque.at(0), 1.0);
  EXPECT_EQ(passed(injector, 1).motor_torque.at(0), 7e4);
}

// A controller may send no bytes at all, or a TORQUE without torques.
TEST(FaultInjector, WhatHasNothingToCorruptPassesAsItIs) {
  for (std::size_t i = 0; i < kCorruptionNames.size(); ++i) {
    const auto corruption = static_cast<Corruption>(i);
    FaultInjector injector({corrupted(corruption, 0, 10)}, kPeriod);
    injector.begin_period(FaultChannel::torque, 0);
    injector.pass(FaultChannel::torque, 0, 0, {});
    msgs::Torque torque{};
    torque.answered_sequence = std::numeric_limits<std::int64_t>::max();
    torque.configuration_hash = std::numeric_limits<std::int64_t>::max();
    std::vector<std::uint8_t> bytes;
    msgs::encode(torque, bytes);
    injector.pass(FaultChannel::torque, 0, 1, bytes);
    injector.end_period(FaultChannel::torque);
    ASSERT_EQ(injector.arrivals(FaultChannel::torque).size(), 2U) << kCorruptionNames[i];
    EXPECT_TRUE(injector.arrivals(FaultChannel::torque)[0].bytes.empty()) << kCorruptionNames[i];
  }
}

TEST(FaultInjector, EncodersLieAsAsked) {
  Fault frozen = fault(FaultKind::encoder_frozen, 1, 3);
  frozen.group = 0;
  Fault offset = fault(FaultKind::encoder_offset, 2, 4);
  offset.group = 1;
  offset.speed = 0.5;
  offset.position = -2.0;
  FaultInjector injector({frozen, offset}, kPeriod);
  for (std::int64_t k = 0; k < 5; ++k) {
    msgs::Encoder message{};
    message.sequence = k;
    const double now = static_cast<double>(k);
    message.shaft_speed = {now, now};
    message.shaft_position = {10.0 * now, 10.0 * now};
    injector.alter(k * kPeriod, message);
    EXPECT_EQ(message.shaft_speed[0], k == 2 ? 1.0 : now);
    EXPECT_EQ(message.shaft_position[0], k == 2 ? 10.0 : 10.0 * now);
    EXPECT_EQ(message.shaft_speed[1], k == 2 || k == 3 ? now + 0.5 : now);
    EXPECT_EQ(message.shaft_position[1], k == 2 || k == 3 ? 10.0 * now - 2.0 : 10.0 * now);
  }
}

TEST(FaultInjector, NoiseHasTheStandardDeviationAskedForAndNoBias) {
  Fault noisy = fault(FaultKind::encoder_noisy, 0, 100'000);
  noisy.speed = 0.2;
  FaultInjector injector({noisy}, kPeriod);
  double sum = 0.0;
  double squares = 0.0;
  double product = 0.0;
  constexpr int kCount = 20'000;
  for (int k = 0; k < kCount; ++k) {
    msgs::Encoder message{};
    message.sequence = k;
    message.shaft_speed = {0.0, 0.0};
    message.shaft_position = {0.0, 0.0};
    injector.alter(k * kPeriod, message);
    sum += message.shaft_speed[0];
    squares += message.shaft_speed[0] * message.shaft_speed[0];
    product += message.shaft_speed[0] * message.shaft_speed[1];
    EXPECT_EQ(message.shaft_position[0], 0.0);
  }
  // Five standard deviations of mean, variance and covariance of 20 000 normal numbers.
  EXPECT_NEAR(sum / kCount, 0.0, 5.0 * 0.2 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 0.04, 5.0 * 0.04 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(product / kCount, 0.0, 5.0 * 0.04 / std::sqrt(kCount));
}

std::string complaint(const std::string& fault) {
  try {
    load_scenario_file(SLEWLAB_SOURCE_DIR "/config/scenarios/fault_manoeuvre.yaml", {{"faults", "[" + fault + "]"}});
  } catch (const common::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FaultFile, WrongEntriesAreExplained) {
  const std::string from = "from: {value: 1, unit: s, source: test}";
  EXPECT_NE(complaint("{fault: {value: gremlin, source: test}, " + from + "}").find("found gremlin, expected controller_killed or"),
            std::string::npos);
  EXPECT_NE(complaint("{fault: {value: main_power_lost, source: test}, from: {value: 1.001, unit: s, source: test}}")
                .find("found 1.001 s, expected a whole multiple of the controller period, 10 ms"),
            std::string::npos);
  EXPECT_NE(complaint("{fault: {value: message_lost, source: test}, " + from + "}").find("probability"), std::string::npos);
  EXPECT_NE(complaint("{fault: {value: motor_group_lost, source: test}, " + from + ", group: {value: 2, unit: '-', source: test}}")
                .find("group"),
            std::string::npos);
  EXPECT_EQ(complaint("{fault: {value: main_power_lost, source: test}, " + from + "}"), "");
}

}  // namespace
}  // namespace slewlab::sim
