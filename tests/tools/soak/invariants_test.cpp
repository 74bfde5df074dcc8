// Every check is fed a record as it should be, and doctored ones: each must notice its own fault and keep still
// otherwise. Expected values come from the laws themselves (docs/soak.md).

#include "tools/soak/invariants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "tests/msgs/example_messages.h"

namespace slewlab::tools {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

SoakFacts facts() {
  SoakFacts facts;
  facts.group_count = 2;
  facts.motors_per_group = 3;
  facts.ratio = 2735.58;
  facts.axis_energy = 1e5;
  facts.top_speed = 0.05;
  facts.step = 1e-3;
  facts.gear.fill({.stiffness = 3.3e9, .damping = 6e6, .half_play = 2.5e-4});
  facts.protection.torque_limit = 400.0;
  facts.protection.torque_rate_limit = 40000.0;
  facts.protection.brake.torque = 400.0;
  facts.configuration_hash = 77;
  facts.plant_step = 1'000'000;
  facts.controller_period = facts.sensors_period = facts.truth_period = 10'000'000;
  facts.status_period = 100'000'000;
  return facts;
}

SoakLimits limits() {
  SoakLimits limits;
  limits.house_speed = 0.075;
  limits.sidelead = 0.7;
  limits.rod_angle = 1.0;
  limits.energy_error = 1e-3;
  limits.heap_growth = 256;
  limits.resident_growth = 16384;
  return limits;
}

// Group 0 pushes forwards, group 1 is inside its play.
StepRecord good() {
  StepRecord record;
  record.time = 5'000'000'000;
  record.drive_state = sim::DriveState::running;
  record.house_speed = 0.05;
  record.motor_speed = {0.051, 0.05};
  record.motor_angle = {3.5e-4, 1e-4};
  record.contact = {1, 0};
  record.gear_torque = {3.3e9 * 1e-4 + 6e6 * 0.001, 0.0};
  record.commanded_torque = record.applied_torque = {120.0, -20.0};
  record.answered_sequence = 500;
  record.mechanical_energy = 1000.0;
  return record;
}

// What the checks of one record find.
std::vector<Violation> found(const SoakFacts& facts, const StepRecord& before, const StepRecord& record) {
  Findings findings;
  check_finite(facts, record, findings);
  check_torque_limit(facts, record, findings);
  check_torque_rate(facts, before, record, findings);
  check_speed(facts, limits(), record, findings);
  check_angles(facts, limits(), record, findings);
  check_contact(facts, before, record, findings);
  check_friction(facts, before, record, findings);
  check_drive(facts, before, record, false, findings);
  return findings.violations();
}
std::vector<Violation> found(const StepRecord& record) { return found(facts(), good(), record); }

void expect_only(Invariant invariant, const std::vector<Violation>& violations) {
  ASSERT_EQ(violations.size(), 1u) << (violations.empty() ? "nothing noticed" : violations.back().what);
  EXPECT_EQ(name_of(violations[0].invariant), std::string(name_of(invariant)));
  EXPECT_EQ(violations[0].time, 5'000'000'000);
}

TEST(Invariants, AGoodRecordBreaksNone) {
  for (const Violation& one : found(good())) ADD_FAILURE() << name_of(one.invariant) << ": " << one.what;
}

TEST(Invariants, NoticeAStateThatIsNotFinite) {
  StepRecord record = good();
  record.state_sum = kNotANumber;
  expect_only(Invariant::finite, found(record));
  record = good();
  record.supplied_work = std::numeric_limits<double>::infinity();
  expect_only(Invariant::finite, found(record));
}

TEST(Invariants, NoticeTorqueBeyondTheDrivesLimit) {
  StepRecord record = good();
  record.commanded_torque[0] = record.applied_torque[0] = 400.1;
  SoakFacts slow = facts();
  slow.protection.torque_rate_limit = std::numeric_limits<double>::infinity();
  expect_only(Invariant::torque_limit, found(slow, good(), record));
}

TEST(Invariants, NoticeTorqueOfADriveThatIsNotRunning) {
  StepRecord record = good();
  record.drive_state = sim::DriveState::tripped;
  record.trip_cause = sim::DriveFault::silence;
  expect_only(Invariant::torque_limit, found(record));
  record.applied_torque = {};
  EXPECT_TRUE(found(record).empty());
}

TEST(Invariants, NoticeTorqueOfALostGroup) {
  SoakFacts carries_on = facts();
  carries_on.protection.trip_on_group_lost = false;
  StepRecord record = good();
  record.conditions.group_lost[1] = true;
  expect_only(Invariant::torque_limit, found(carries_on, good(), record));
}

TEST(Invariants, NoticeBrakesStrongerThanTheyAre) {
  StepRecord record = good();
  record.brake_torque = 401.0;
  expect_only(Invariant::torque_limit, found(record));
}

// 40 000 Nm/s are 400 Nm in a period of 10 ms; with no new answer the torque stands.
TEST(Invariants, NoticeTorqueThatChangesTooFast) {
  StepRecord before = good();
  StepRecord record = good();
  before.answered_sequence = 499;
  before.commanded_torque[0] = -285.0;
  expect_only(Invariant::torque_rate, found(facts(), before, record));
  before.commanded_torque[0] = -275.0;
  EXPECT_TRUE(found(facts(), before, record).empty());
  before = good();
  before.commanded_torque[0] = 119.0;
  expect_only(Invariant::torque_rate, found(facts(), before, record));
}

// While ENCODER lies the motors may drive the crane by their limit: 2 groups of 3 motors with 400 Nm at 2735.58 are 6.565e6 Nm on
// 2 * 1e5 J / (0.05 rad/s)^2 = 8e7 kg m^2, 0.0821 rad/s^2; twice that for half a second is 0.0821 rad/s above the limit of 0.075.
TEST(Invariants, NoticeASpeedThatNoLyingEncoderExplains) {
  SoakFacts lied_to = facts();
  lied_to.encoder_untrue = true;
  lied_to.untrue_encoders = {{4'000'000'000, 4'500'000'000}};
  StepRecord record = good();
  const auto at = [&](double speed, std::int64_t time) {
    record.time = time;
    record.house_speed = speed;
    record.motor_speed = {speed + 0.001, speed};
    return found(lied_to, good(), record);
  };
  EXPECT_TRUE(at(0.157, 5'000'000'000).empty());
  expect_only(Invariant::speed_limit, at(0.1575, 5'000'000'000));
  EXPECT_TRUE(at(-0.115, 4'250'000'000).empty());
  EXPECT_EQ(at(-0.117, 4'250'000'000).size(), 1u);
  EXPECT_EQ(at(0.076, 4'000'000'000).size(), 1u);
}

TEST(Invariants, NoticeSpeedAndAnglesBeyondTheirLimits) {
  StepRecord record = good();
  record.house_speed = 0.076;
  record.motor_speed = {0.077, 0.076};
  expect_only(Invariant::speed_limit, found(record));
  record = good();
  record.rope_angle = -0.71;
  expect_only(Invariant::angle_limit, found(record));
  record = good();
  record.rod_angle = 1.01;
  expect_only(Invariant::angle_limit, found(record));
}

TEST(Invariants, NoticeTeethThatPull) {
  StepRecord record = good();
  record.gear_torque[0] = -record.gear_torque[0];
  expect_only(Invariant::contact_law, found(record));
}

TEST(Invariants, NoticeTorqueInsideThePlay) {
  StepRecord record = good();
  record.contact[1] = 1;
  record.gear_torque[1] = 1000.0;
  expect_only(Invariant::contact_law, found(record));
}

TEST(Invariants, NoticeTorqueThatTheLawDoesNotGive) {
  StepRecord record = good();
  record.gear_torque[0] *= 1.0 + 1e-6;
  expect_only(Invariant::contact_law, found(record));
  record = good();
  record.contact[0] = 0;
  record.gear_torque[0] = 0.0;  // pressed together, and no torque
  expect_only(Invariant::contact_law, found(record));
}

TEST(Invariants, NoticeCountsOfCrossingsThatFallAndStepsThatCouldNotBeSplit) {
  StepRecord before = good();
  before.play_crossings[1] = 3;
  expect_only(Invariant::contact_law, found(facts(), before, good()));
  StepRecord record = good();
  record.unsplit_steps = 1;
  expect_only(Invariant::contact_law, found(record));
}

TEST(Invariants, NoticeFrictionsThatWereNotFound) {
  StepRecord record = good();
  record.unsolved_frictions = 1;
  expect_only(Invariant::friction_law, found(record));
}

TEST(Invariants, NoticeBrakesThatDriveOrAreTooStrong) {
  StepRecord record = good();
  record.motor_friction[0] = -1e6;  // against 0.051 rad/s
  EXPECT_TRUE(found(record).empty());
  record.motor_friction[0] = 1e6;
  expect_only(Invariant::friction_law, found(record));
  record.motor_friction[0] = -400.1 * 3 * 2735.58;
  expect_only(Invariant::friction_law, found(record));
}

// Every pair of states, at a message and at a step: the arrows of docs/drive.md and no other.
TEST(Invariants, KnowTheArrowsOfTheDrive) {
  using sim::DriveState;
  const auto legal = [](DriveState from, DriveState to, bool by_message) {
    StepRecord before = good(), record = good();
    before.drive_state = from;
    record.drive_state = to;
    const bool latched = to == DriveState::tripped || (to == DriveState::braked && !by_message);
    record.trip_cause = latched ? sim::DriveFault::silence : sim::DriveFault::none;
    Findings findings;
    check_drive(facts(), before, record, by_message, findings);
    return findings.empty();
  };
  const DriveState all[] = {DriveState::ready, DriveState::running, DriveState::tripped, DriveState::braked};
  for (const DriveState from : all) {
    for (const DriveState to : all) {
      const bool trip = to == DriveState::tripped;
      const bool enable = from == DriveState::ready && to == DriveState::running;
      const bool disable = from == DriveState::running && to == DriveState::ready;
      const bool brake = from != DriveState::tripped && to == DriveState::braked;
      const bool release = from == DriveState::braked && to == DriveState::ready;
      const std::string arrow = std::string(name_of(from)) + " to " + name_of(to);
      EXPECT_EQ(legal(from, to, true), from == to || trip || enable || disable || brake || release) << arrow;
      // A step trips, and lets the brakes hold behind a trip.
      EXPECT_EQ(legal(from, to, false), from == to || trip || to == DriveState::braked) << arrow;
    }
  }
}

TEST(Invariants, NoticeADriveThatRunsWithATripLatchedOrWithoutPower) {
  StepRecord record = good();
  record.trip_cause = sim::DriveFault::infinite;
  expect_only(Invariant::drive_state, found(record));
  record = good();
  record.conditions.main_power = false;
  record.applied_torque = {};
  expect_only(Invariant::drive_state, found(record));
}

// A crane that gains 1 J per step from 1 J of work, and dissipates 0.25 W h = 0.25 mJ in each.
TEST(EnergyBalance, HoldsWhereWorkIsEnergyAndHeatAndNoticesADifference) {
  StepRecord record = good();
  record.dissipated_power = 250.0;
  const SoakFacts machine = facts();
  const SoakLimits bounds = limits();
  EnergyBalance balance(machine, bounds, record);
  Findings findings;
  for (int i = 0; i < 1000; ++i) {
    record.supplied_work += 1.0;
    record.mechanical_energy += 1.0 - 0.25;
    balance.check(record, findings);
  }
  EXPECT_TRUE(findings.empty());
  EXPECT_LT(balance.largest_error(), 1e-12);
  // Turned over: 1000 J at the start, 1000 J of work, 250 J of heat; 0.1 % of them is 2.25 J.
  record.mechanical_energy += 1.9;  // and 0.25 J of heat that was not paid for
  balance.check(record, findings);
  EXPECT_TRUE(findings.empty());
  record.mechanical_energy += 0.1;  // and another 0.25 J
  balance.check(record, findings);
  expect_only(Invariant::energy_balance, findings.violations());
}

TEST(EnergyBalance, GrantsWhatAnImpactInsideAStepHides) {
  StepRecord record = good();
  const SoakFacts machine = facts();
  const SoakLimits bounds = limits();
  EnergyBalance balance(machine, bounds, record);
  Findings findings;
  record.motor_speed[1] = 0.06;  // 0.01 rad/s against the house: at most 1 ms * 6e6 * 1e-4 = 0.6 J, and 0.006 J of group 0
  record.contact_changes = 1;
  record.mechanical_energy -= 0.6 + 1.0;  // and 0.1 % of 1000 J
  balance.check(record, findings);
  EXPECT_TRUE(findings.empty());
  record.mechanical_energy -= 0.1;
  balance.check(record, findings);
  expect_only(Invariant::energy_balance, findings.violations());
}

// Messages as a run without faults has them, one period after the other.
class MessagesTest : public testing::Test {
 protected:
  template <class Message>
  void head(Message& message, std::int64_t sequence, std::int64_t period) {
    message.sequence = sequence;
    message.simulated_time = sequence * period;
    message.configuration_hash = 77;
  }
  MessagesTest() {
    encoder.group_count = 2;
    encoder.shaft_speed = encoder.shaft_position = {1.0, 2.0};
    torque.group_count = 2;
    torque.motor_torque = {10.0, -10.0};
    state.group_count = 2;
    state.proportional_torque = state.integral_torque = {1.0, 2.0};
    status.fault_count = sim::kDriveFaultCount;
    status.faults.assign(sim::kDriveFaultCount, 0);
    status.drive_state = 1;
    for (int i = 0; i < 3; ++i) period();
    EXPECT_TRUE(findings.empty()) << findings.violations()[0].what;
  }
  void period() {
    head(encoder, next, 10'000'000);
    head(torque, next, 10'000'000);
    head(state, next, 10'000'000);
    head(sensors, next, 10'000'000);
    head(truth, next, 10'000'000);
    torque.answered_sequence = state.answered_sequence = torque.alive_counter = next;
    send_period();
  }
  void send_period() {
    send("SENSORS", sensors);
    send("TRUTH", truth);
    if (next % 10 == 0) {
      head(status, next / 10, 100'000'000);
      send("PLANT_STATUS", status);
    }
    if (next == 0) {
      head(operator_move, 0, 0);
      send("OPERATOR", operator_move);
    }
    send("ENCODER", encoder);
    send("CONTROLLER_STATE", state);
    send("TORQUE", torque);
    ++next;
  }
  template <class Message>
  void send(const char* channel, const Message& message) {
    msgs::encode(message, bytes);
    messages.look(channel, next * 10'000, bytes, findings);
  }
  // The head of the next period's messages, to be doctored.
  void prepare() {
    head(encoder, next, 10'000'000);
    head(torque, next, 10'000'000);
    head(state, next, 10'000'000);
    head(sensors, next, 10'000'000);
    head(truth, next, 10'000'000);
    torque.answered_sequence = state.answered_sequence = torque.alive_counter = next;
  }
  void expect_first(Invariant invariant) {
    ASSERT_FALSE(findings.empty());
    EXPECT_EQ(name_of(findings.violations()[0].invariant), std::string(name_of(invariant)))
        << findings.violations()[0].what;
  }

  SoakFacts run = facts();
  MessageInvariants messages{run};
  Findings findings;
  std::int64_t next = 0;
  std::vector<std::uint8_t> bytes;
  msgs::Encoder encoder{};
  msgs::Torque torque{};
  msgs::ControllerState state{};
  msgs::Operator operator_move{};
  msgs::Sensors sensors{};
  msgs::Truth truth{};
  msgs::PlantStatus status{};
};

TEST_F(MessagesTest, GoodOnesBreakNothing) {
  for (int i = 0; i < 50; ++i) period();
  EXPECT_TRUE(findings.empty());
}

TEST_F(MessagesTest, NoticeASequenceNumberLeftOut) {
  for (auto* number : {&encoder.sequence, &torque.sequence, &state.sequence, &sensors.sequence, &truth.sequence}) {
    findings = {};
    prepare();
    ++*number;
    send_period();
    expect_first(Invariant::sequence);
  }
}

TEST_F(MessagesTest, NoticeSimulatedTimeThatDoesNotFollowFromTheNumber) {
  for (auto* time : {&encoder.simulated_time, &sensors.simulated_time, &truth.simulated_time, &state.simulated_time}) {
    findings = {};
    prepare();
    *time += 1;
    send_period();
    expect_first(Invariant::clock);
  }
}

TEST_F(MessagesTest, NoticeAnEventStampedBeforeTheLast) {
  next = 1;
  prepare();
  send("SENSORS", sensors);
  expect_first(Invariant::clock);
}

TEST_F(MessagesTest, NoticeAnAnswerToAnotherQuestion) {
  prepare();
  torque.answered_sequence -= 1;
  send_period();
  expect_first(Invariant::sequence);
}

TEST_F(MessagesTest, NoticeAnAliveCounterThatStands) {
  prepare();
  torque.alive_counter -= 1;
  send_period();
  expect_first(Invariant::sequence);
}

TEST_F(MessagesTest, NoticeAnotherConfiguration) {
  prepare();
  truth.configuration_hash = 78;
  send_period();
  expect_first(Invariant::sequence);
}

TEST_F(MessagesTest, NoticeNumbersThatAreNotFinite) {
  prepare();
  encoder.shaft_speed[1] = kNotANumber;
  send_period();
  expect_first(Invariant::finite);
  encoder.shaft_speed[1] = 0.0;
  findings = {};
  prepare();
  torque.motor_torque[0] = std::numeric_limits<double>::infinity();
  send_period();
  expect_first(Invariant::finite);
  torque.motor_torque[0] = 0.0;
  findings = {};
  prepare();
  truth.tip_velocity = kNotANumber;
  send_period();
  expect_first(Invariant::finite);
  truth.tip_velocity = 0.0;
  findings = {};
  prepare();
  state.integral_torque[0] = kNotANumber;
  send_period();
  expect_first(Invariant::finite);
  state.integral_torque[0] = 0.0;
  findings = {};
  prepare();
  sensors.tip_acceleration = kNotANumber;
  send_period();
  expect_first(Invariant::finite);
}

TEST_F(MessagesTest, NoticeBytesThatAreNoMessage) {
  prepare();
  msgs::encode(truth, bytes);
  bytes.pop_back();
  messages.look("TRUTH", next * 10'000, bytes, findings);
  expect_first(Invariant::sequence);
}

TEST_F(MessagesTest, NoticeFaultsThatNobodyScheduled) {
  while (next % 10 != 0) period();
  status.faults[static_cast<std::size_t>(sim::DriveFault::torque_rate)] = 1;
  period();
  expect_first(Invariant::untroubled);
}

TEST_F(MessagesTest, NoticeATripAndStaleCommandsThatNobodyScheduled) {
  while (next % 10 != 0) period();
  status.stale_commands = 1;
  period();
  expect_first(Invariant::untroubled);
}

TEST_F(MessagesTest, NoticeCountsThatFall) {
  run.faults = true;
  status.faults[3] = 5;
  while (next % 10 != 0) period();
  period();
  ASSERT_TRUE(findings.empty());
  status.faults[3] = 4;
  while (next % 10 != 0) period();
  period();
  expect_first(Invariant::sequence);
}

// What each fault on purpose may change, and nothing more: docs/soak.md's table.
TEST(Facts, FaultsSilenceOnlyWhatTheyMustChange) {
  const auto after = [](sim::FaultKind kind, sim::FaultChannel channel = sim::FaultChannel::torque) {
    sim::Fault fault;
    fault.kind = kind;
    fault.channel = channel;
    SoakFacts result;
    take_faults({fault}, result);
    return result;
  };
  const SoakFacts power = after(sim::FaultKind::main_power_lost);
  EXPECT_TRUE(power.faults);
  EXPECT_FALSE(power.torque_altered || power.encoder_untrue || power.encoder_unusable || power.controller_restarts);
  const SoakFacts lost = after(sim::FaultKind::message_lost);
  EXPECT_TRUE(lost.torque_altered);
  EXPECT_FALSE(lost.encoder_untrue || lost.encoder_unusable || lost.encoder_corrupted);
  const SoakFacts dropped = after(sim::FaultKind::encoder_dropped);
  EXPECT_TRUE(dropped.encoder_unusable);
  EXPECT_FALSE(dropped.torque_altered || dropped.encoder_untrue);
  const SoakFacts frozen = after(sim::FaultKind::encoder_frozen);
  EXPECT_TRUE(frozen.encoder_untrue);
  EXPECT_FALSE(frozen.torque_altered);
  const SoakFacts corrupted = after(sim::FaultKind::message_corrupted, sim::FaultChannel::encoder);
  EXPECT_TRUE(corrupted.encoder_corrupted && corrupted.encoder_untrue);
  EXPECT_TRUE(after(sim::FaultKind::controller_killed).controller_restarts);
}

TEST(Memory, GrowthIsNoticedAndItsBoundHolds) {
  Findings findings;
  check_memory(limits(), {.heap = 100, .resident = 5000}, {.heap = 356, .resident = 21384}, "before", 0, findings);
  EXPECT_TRUE(findings.empty());
  check_memory(limits(), {.heap = 100, .resident = 5000}, {.heap = 357, .resident = 5000}, "before", 0, findings);
  ASSERT_EQ(findings.violations().size(), 1u);
  check_memory(limits(), {.heap = 100, .resident = 5000}, {.heap = 100, .resident = 21385}, "before", 0, findings);
  EXPECT_EQ(findings.violations()[0].count, 2);
}

TEST(Memory, WhatIsAllocatedAndUsedShows) {
#ifdef SLEWLAB_SANITIZED
  GTEST_SKIP() << "the sanitizer's allocator does not count here";
#endif
  const MemoryUse before = memory_use();
  constexpr std::size_t kBytes = 4 << 20;
  auto block = std::make_unique<std::vector<char>>(kBytes, 'x');
  const MemoryUse now = memory_use();
  EXPECT_GE(now.heap - before.heap, static_cast<std::int64_t>(kBytes / 1024));
  EXPECT_EQ(block->back(), 'x');
}

}  // namespace
}  // namespace slewlab::tools
