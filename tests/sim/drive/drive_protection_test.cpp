#include "sim/drive/drive_protection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/common/allocation_guard.h"

namespace slewlab::sim {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // [ns]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A drive of two groups under a controller that answers every 10 ms with what `answer` holds. Every expected number
// below follows from the settings here by hand.
class DriveProtectionTest : public testing::Test {
 protected:
  DriveProtectionTest() {
    settings_.torque_limit = 600.0;
    settings_.torque_rate_limit = 40'000.0;  // 400 Nm from one answer to the next
    settings_.alive_timeout = 50 * kMillisecond;
    settings_.silence_timeout = 100 * kMillisecond;
    settings_.answer_age_limit = 1;
    settings_.standstill_speed = 1.0;
    settings_.brake = {480.0, 20 * kMillisecond, 0.010, 30 * kMillisecond, 0.010};
    answer_.configuration_hash = run_.configuration_hash;
    answer_.enable = 1;
    answer_.group_count = 2;
    answer_.motor_torque = {100.0, -50.0};
  }

  void send(msgs::DecodeStatus status = msgs::DecodeStatus::ok) {
    receive(settings_, run_, state_, moment_, status, answer_);
  }

  // One controller period: ENCODER goes out, the answer comes or not, ten plant steps.
  void cycle(bool answered = true) {
    ++sequence_;
    begin_cycle(state_, sequence_);
    answer_.sequence = answer_.answered_sequence = sequence_ + sequence_offset_;
    if (alive_) ++answer_.alive_counter;
    if (answered) send(status_);
    for (int i = 0; i < 10; ++i) {
      command_ = drive_command(settings_, run_, state_, moment_, kMillisecond);
      moment_.time += kMillisecond;
    }
  }
  void cycles(int count, bool answered = true) {
    for (int i = 0; i < count; ++i) cycle(answered);
  }
  std::int64_t seen(DriveFault fault) const { return state_.faults[static_cast<std::size_t>(fault)]; }
  std::int64_t all_seen() const {
    std::int64_t sum = 0;
    for (const std::int64_t count : state_.faults) sum += count;
    return sum;
  }
  void expect_only(DriveFault fault) const { EXPECT_EQ(all_seen(), seen(fault)); }
  void expect_running(double torque) const {
    EXPECT_EQ(state_.state, DriveState::running);
    EXPECT_EQ(command_.motor_torque[0], torque);
    EXPECT_EQ(command_.brake_torque[0], 0.0);
    EXPECT_TRUE(command_.enable);
  }
  void expect_tripped_by(DriveFault fault) const {
    EXPECT_EQ(state_.state, DriveState::tripped) << name_of(state_.state);
    EXPECT_EQ(state_.trip_cause, fault) << name_of(state_.trip_cause);
    EXPECT_EQ(state_.trips, 1);
    EXPECT_FALSE(command_.enable);
    EXPECT_EQ(command_.motor_torque[0], 0.0);
    EXPECT_EQ(command_.motor_torque[1], 0.0);
  }
  void trip_while_moving() {
    cycles(3);
    moment_.shaft_speed = {100.0, 100.0};
    answer_.motor_torque = {kNan, 0.0};
    cycle();
    answer_.motor_torque = {100.0, -50.0};
  }
  void come_to_rest_braked() {
    trip_while_moving();
    cycles(10);
    moment_.shaft_speed = {};
    cycle();
  }

  DriveProtectionSettings settings_;
  DriveRun run_{2, 77, 10 * kMillisecond};
  DriveProtectionState state_;
  DriveMoment moment_;
  DriveCommand command_;
  msgs::Torque answer_{};
  std::int64_t sequence_ = -1;
  std::int64_t sequence_offset_ = 0;
  bool alive_ = true;
  msgs::DecodeStatus status_ = msgs::DecodeStatus::ok;
};

// --- the arrows of docs/drive.md ---

TEST_F(DriveProtectionTest, ArrowReadyToRunningOnEnable) {
  EXPECT_EQ(state_.state, DriveState::ready);
  cycle();
  expect_running(100.0);
  EXPECT_EQ(command_.motor_torque[1], -50.0);
  EXPECT_EQ(all_seen(), 0);
}

TEST_F(DriveProtectionTest, ArrowRunningToReadyWithoutEnable) {
  cycle();
  answer_.enable = 0;
  cycle();
  EXPECT_EQ(state_.state, DriveState::ready);
  EXPECT_FALSE(command_.enable);
  EXPECT_EQ(command_.motor_torque[0], 0.0);
  EXPECT_EQ(command_.brake_torque[0], 0.0);
}

TEST_F(DriveProtectionTest, ArrowReadyToBrakedOnBrake) {
  answer_.enable = 0;
  cycle();
  answer_.brake = 1;
  cycle();
  EXPECT_EQ(state_.state, DriveState::braked);
  EXPECT_EQ(state_.trip_cause, DriveFault::none);
}

TEST_F(DriveProtectionTest, ArrowRunningToBrakedOnBrakeTakesTheTorqueAway) {
  cycle();
  answer_.brake = 1;  // and still enables: the brake wins
  cycles(20);
  EXPECT_EQ(state_.state, DriveState::braked);
  EXPECT_EQ(command_.motor_torque[0], 0.0);
  EXPECT_NEAR(command_.brake_torque[0], 480.0, 1e-3);
}

TEST_F(DriveProtectionTest, ArrowBrakedToReadyAndOnToRunningWhenTheBrakeIsReleased) {
  answer_.brake = 1;
  cycles(5);
  answer_.brake = 0;
  cycle();
  EXPECT_EQ(state_.state, DriveState::ready);
  cycle();
  EXPECT_EQ(state_.state, DriveState::running);
}

TEST_F(DriveProtectionTest, ArrowReadyToTripped) {
  answer_.enable = 0;
  cycle();
  moment_.main_power = false;
  cycle();
  expect_tripped_by(DriveFault::power_lost);
}

TEST_F(DriveProtectionTest, ArrowRunningToTripped) {
  trip_while_moving();
  expect_tripped_by(DriveFault::not_a_number);
}

TEST_F(DriveProtectionTest, ArrowBrakedToTrippedAndBackToBrakedKeepsTheCause) {
  answer_.brake = 1;
  cycles(20);
  moment_.main_power = false;
  begin_cycle(state_, sequence_);
  drive_command(settings_, run_, state_, moment_, kMillisecond);
  EXPECT_EQ(state_.state, DriveState::braked);  // standing with the brakes closed: through tripped within the step
  EXPECT_EQ(state_.trip_cause, DriveFault::power_lost);
  EXPECT_EQ(state_.trips, 1);
}

TEST_F(DriveProtectionTest, ArrowTrippedToBrakedOnlyWhenTheBrakesHoldAndTheMotorsStand) {
  trip_while_moving();
  cycles(10);  // the brakes are closed long since
  EXPECT_EQ(state_.state, DriveState::tripped);
  moment_.shaft_speed = {0.0, -1.5};
  cycle();
  EXPECT_EQ(state_.state, DriveState::tripped);
  moment_.shaft_speed = {0.0, -0.5};
  cycle();
  EXPECT_EQ(state_.state, DriveState::braked);
  EXPECT_EQ(state_.trip_cause, DriveFault::not_a_number);
}

TEST_F(DriveProtectionTest, TrippedAtRestWaitsForTheBrakesToHold) {
  cycles(3);
  moment_.main_power = false;
  cycles(4);  // 20 ms of delay and 20 ms of rise: 1 - exp(-2) = 86 %, below the 95 % that hold
  EXPECT_EQ(state_.state, DriveState::tripped);
  cycles(2);
  EXPECT_EQ(state_.state, DriveState::braked);
}

TEST_F(DriveProtectionTest, ArrowBrakedToReadyOnTheRisingEdgeOfAcknowledge) {
  come_to_rest_braked();
  EXPECT_EQ(state_.state, DriveState::braked);
  cycles(100);  // enabling and asking for torque all the time
  EXPECT_EQ(state_.state, DriveState::braked);
  EXPECT_EQ(command_.motor_torque[0], 0.0);
  answer_.acknowledge = 1;
  cycle();
  EXPECT_EQ(state_.state, DriveState::ready);
  EXPECT_EQ(state_.trip_cause, DriveFault::none);
  cycles(20);
  expect_running(100.0);
}

TEST_F(DriveProtectionTest, ArrowTrippedStaysTrippedWhenAcknowledgedWhileMoving) {
  trip_while_moving();
  answer_.acknowledge = 1;
  cycles(10);
  EXPECT_EQ(state_.state, DriveState::tripped);
  moment_.shaft_speed = {};
  cycles(10);  // the acknowledgement still stands, but it never rose at rest
  EXPECT_EQ(state_.state, DriveState::braked);
  answer_.acknowledge = 0;
  cycle();
  answer_.acknowledge = 1;
  cycle();
  EXPECT_EQ(state_.state, DriveState::ready);
}

TEST_F(DriveProtectionTest, AcknowledgingWhileTheCauseLastsIsWorthNothing) {
  cycles(3);
  moment_.main_power = false;
  cycles(10);
  answer_.acknowledge = 1;
  cycles(2);
  EXPECT_EQ(state_.state, DriveState::braked);
  moment_.main_power = true;
  cycles(2);
  EXPECT_EQ(state_.state, DriveState::braked);
  answer_.acknowledge = 0;
  cycle();
  answer_.acknowledge = 1;
  cycle();
  EXPECT_EQ(state_.state, DriveState::ready);
}

TEST_F(DriveProtectionTest, AcknowledgedUnderABrakeRequestItStaysBrakedWithoutACause) {
  come_to_rest_braked();
  answer_.acknowledge = 1;
  answer_.brake = 1;
  cycle();
  EXPECT_EQ(state_.state, DriveState::braked);
  EXPECT_EQ(state_.trip_cause, DriveFault::none);
}

// --- the causes of docs/wire.md ---

TEST_F(DriveProtectionTest, BytesThatAreNoTorqueAreHeldOverAndTripAfterTheTimeout) {
  for (const auto& [status, fault] : {std::pair{msgs::DecodeStatus::truncated, DriveFault::truncated},
                                      std::pair{msgs::DecodeStatus::other_version, DriveFault::other_version},
                                      std::pair{msgs::DecodeStatus::garbage, DriveFault::garbage}}) {
    state_ = {};
    moment_ = {};
    sequence_ = -1;
    status_ = msgs::DecodeStatus::ok;
    cycle();  // the last good command comes at 0 ms
    status_ = status;
    cycles(9);  // until 100 ms
    expect_running(100.0);
    EXPECT_EQ(seen(fault), 9);
    EXPECT_EQ(state_.stale_commands, 8);  // the ninth cycle has not ended yet
    cycle();
    expect_tripped_by(fault);
    EXPECT_EQ(seen(fault), 10);
    expect_only(fault);
  }
}

TEST_F(DriveProtectionTest, AMessageOfAnotherConfigurationIsHeldOverAndTripsAfterTheTimeout) {
  cycle();
  answer_.configuration_hash = 78;
  answer_.motor_torque = {500.0, 500.0};
  cycles(9);
  expect_running(100.0);
  cycle();
  expect_tripped_by(DriveFault::other_configuration);
  EXPECT_EQ(seen(DriveFault::other_configuration), 10);
  expect_only(DriveFault::other_configuration);
}

TEST_F(DriveProtectionTest, AMessageOfAnotherRunIsHeldOverAndTripsAfterTheTimeout) {
  cycle();
  answer_.run_identity = run_.run_identity + 1;
  answer_.motor_torque = {500.0, 500.0};
  cycles(9);
  expect_running(100.0);
  EXPECT_EQ(state_.trip_time, -1);
  cycle();
  expect_tripped_by(DriveFault::other_configuration);
  expect_only(DriveFault::other_configuration);
  // The last good command came at 0 ms; silence_timeout is 100 ms.
  EXPECT_EQ(state_.trip_time, 100 * kMillisecond);
}

TEST_F(DriveProtectionTest, AnAnswerToAWrongSequenceNumberIsHeldOverAndTripsAfterTheTimeout) {
  for (const std::int64_t offset : {1, 1000, -1000}) {
    state_ = {};
    moment_ = {};
    sequence_ = 2000;
    sequence_offset_ = 0;
    cycle();
    sequence_offset_ = offset;
    cycles(9);
    EXPECT_EQ(state_.state, DriveState::running) << offset;
    cycle();
    expect_tripped_by(DriveFault::wrong_sequence);
    EXPECT_EQ(seen(DriveFault::wrong_sequence), 10) << offset;
  }
}

TEST_F(DriveProtectionTest, AnAnswerAsOldAsAllowedIsTaken) {
  cycles(2);
  sequence_offset_ = -1;
  cycle(false);  // its answer comes a cycle late
  answer_.motor_torque = {120.0, 0.0};
  cycle();
  expect_running(120.0);
  EXPECT_EQ(all_seen(), 0);
  EXPECT_EQ(state_.stale_commands, 1);
}

TEST_F(DriveProtectionTest, ARepeatedAnswerIsCountedAndChangesNothing) {
  cycle();
  answer_.motor_torque = {500.0, 500.0};
  send();
  send();
  cycle(false);
  expect_running(100.0);
  EXPECT_EQ(seen(DriveFault::repeated_answer), 2);
  expect_only(DriveFault::repeated_answer);
}

TEST_F(DriveProtectionTest, AnOlderAnswerBehindANewerOneIsRefused) {
  settings_.answer_age_limit = 5;
  cycles(5);
  answer_.answered_sequence -= 2;
  answer_.motor_torque = {0.0, 0.0};
  send();
  cycle(false);
  expect_running(100.0);
  EXPECT_EQ(seen(DriveFault::wrong_sequence), 1);
}

TEST_F(DriveProtectionTest, AWrongNumberOfGroupsTripsAtOnce) {
  cycle();
  answer_.group_count = 3;
  answer_.motor_torque = {1.0, 2.0, 3.0};
  cycle();
  expect_tripped_by(DriveFault::group_count);
  EXPECT_EQ(seen(DriveFault::group_count), 1);
  expect_only(DriveFault::group_count);
}

TEST_F(DriveProtectionTest, NotANumberTripsAtOnce) {
  cycle();
  answer_.motor_torque = {0.0, kNan};
  cycle();
  expect_tripped_by(DriveFault::not_a_number);
  expect_only(DriveFault::not_a_number);
}

TEST_F(DriveProtectionTest, InfinityTripsAtOnceAndIsToldFromNotANumber) {
  for (const double value : {kInfinity, -kInfinity}) {
    state_ = {};
    moment_ = {};
    sequence_ = -1;
    answer_.motor_torque = {0.0, 0.0};
    cycle();
    answer_.motor_torque = {0.0, value};
    cycle();
    expect_tripped_by(DriveFault::infinite);
    expect_only(DriveFault::infinite);
  }
}

TEST_F(DriveProtectionTest, TorqueBeyondTheLimitIsBroughtWithinIt) {
  answer_.motor_torque = {300.0, -300.0};
  cycle();
  answer_.motor_torque = {650.0, -601.0};
  cycle();
  EXPECT_EQ(command_.motor_torque[0], 600.0);
  EXPECT_EQ(command_.motor_torque[1], -600.0);
  EXPECT_EQ(state_.state, DriveState::running);
  EXPECT_EQ(seen(DriveFault::torque_limit), 1);  // once for the message
  expect_only(DriveFault::torque_limit);
}

TEST_F(DriveProtectionTest, TorqueThatChangesTooFastIsBroughtWithinTheRate) {
  answer_.motor_torque = {0.0, 0.0};
  cycle();
  answer_.motor_torque = {450.0, -10.0};  // 450 Nm in 10 ms are 45 kNm/s
  cycle();
  EXPECT_DOUBLE_EQ(command_.motor_torque[0], 400.0);
  EXPECT_EQ(command_.motor_torque[1], -10.0);
  EXPECT_EQ(seen(DriveFault::torque_rate), 1);
  cycle();
  expect_running(450.0);
  expect_only(DriveFault::torque_rate);
}

TEST_F(DriveProtectionTest, TheRateIsJudgedOverAllCyclesSinceTheLastAnswer) {
  answer_.motor_torque = {0.0, 0.0};
  cycle();
  cycle(false);
  answer_.motor_torque = {450.0, 0.0};
  cycle();  // 450 Nm in 20 ms
  expect_running(450.0);
  EXPECT_EQ(all_seen(), 0);
}

TEST_F(DriveProtectionTest, AFrozenAliveCounterTripsAfterItsTimeout) {
  cycle();  // at 0 ms
  alive_ = false;
  cycles(4);  // at 10, 20, 30, 40 ms
  expect_running(100.0);
  EXPECT_EQ(seen(DriveFault::alive_frozen), 4);
  cycle();  // at 50 ms
  expect_tripped_by(DriveFault::alive_frozen);
  expect_only(DriveFault::alive_frozen);
}

TEST_F(DriveProtectionTest, AnAliveCounterThatGoesOnInTimeDoesNotTrip) {
  for (int i = 0; i < 10; ++i) {
    alive_ = i % 5 == 0;
    cycle();
  }
  EXPECT_EQ(state_.state, DriveState::running);
  EXPECT_EQ(seen(DriveFault::alive_frozen), 8);
}

TEST_F(DriveProtectionTest, SilenceHoldsTheLastCommandAndTripsAfterItsTimeout) {
  cycle();
  cycles(9, false);  // until 100 ms
  expect_running(100.0);
  EXPECT_EQ(all_seen(), 0);
  EXPECT_EQ(state_.stale_commands, 8);
  cycle(false);
  expect_tripped_by(DriveFault::silence);
  cycles(50, false);
  EXPECT_EQ(seen(DriveFault::silence), 1);  // one silence, however long
  expect_only(DriveFault::silence);
}

TEST_F(DriveProtectionTest, SilenceFromTheStartTripsToo) {
  cycles(11, false);
  expect_tripped_by(DriveFault::silence);
}

TEST_F(DriveProtectionTest, ALostMotorGroupTrips) {
  cycles(2);
  moment_.group_lost[1] = true;
  cycles(2);
  expect_tripped_by(DriveFault::group_lost);
  EXPECT_EQ(seen(DriveFault::group_lost), 1);
  expect_only(DriveFault::group_lost);
}

TEST_F(DriveProtectionTest, ALostMotorGroupIsDraggedAlongWhereTheDriveMayCarryOn) {
  settings_.trip_on_group_lost = false;
  cycles(2);
  moment_.group_lost[1] = true;
  cycles(2);
  expect_running(100.0);
  EXPECT_EQ(command_.motor_torque[1], 0.0);
  EXPECT_EQ(seen(DriveFault::group_lost), 1);
}

TEST_F(DriveProtectionTest, LostMainPowerTripsWithinTheStep) {
  cycles(2);
  moment_.main_power = false;
  command_ = drive_command(settings_, run_, state_, moment_, kMillisecond);
  expect_tripped_by(DriveFault::power_lost);
  expect_only(DriveFault::power_lost);
}

TEST_F(DriveProtectionTest, TheFirstCauseOfATripStands) {
  trip_while_moving();
  moment_.main_power = false;
  cycles(20, false);
  expect_tripped_by(DriveFault::not_a_number);
  EXPECT_EQ(seen(DriveFault::power_lost), 1);
  EXPECT_EQ(seen(DriveFault::silence), 1);
}

TEST_F(DriveProtectionTest, AllCausesHaveANameOfTheirOwn) {
  for (int a = 0; a < kDriveFaultCount; ++a) {
    for (int b = 0; b < a; ++b) {
      EXPECT_STRNE(name_of(static_cast<DriveFault>(a)), name_of(static_cast<DriveFault>(b)));
    }
  }
}

// --- the brake ---

TEST_F(DriveProtectionTest, TheBrakeClosesAfterItsDelayByItsTimeConstant) {
  BrakeState brake;
  double impulse = 0.0;  // [Nm s]
  for (std::int64_t t = 0; t < 20 * kMillisecond; t += kMillisecond) {
    EXPECT_EQ(brake_torque(settings_.brake, brake, true, t, kMillisecond), 0.0);
  }
  for (std::int64_t t = 20 * kMillisecond; t < 50 * kMillisecond; t += kMillisecond) {
    impulse += 1e-3 * brake_torque(settings_.brake, brake, true, t, kMillisecond);
  }
  // T = 480 (1 - exp(-t / 10 ms)) for 30 ms behind the delay; its integral in closed form.
  EXPECT_NEAR(brake.torque, 480.0 * (1.0 - std::exp(-3.0)), 1e-9);
  EXPECT_NEAR(impulse, 480.0 * (0.030 - 0.010 * (1.0 - std::exp(-3.0))), 1e-12);
}

TEST_F(DriveProtectionTest, TheBrakeOpensAfterItsDelayByItsTimeConstantAndLetsGoWholly) {
  BrakeState brake{true, 0, true, 480.0};
  std::int64_t t = 0;
  for (; t < 30 * kMillisecond; t += kMillisecond) {
    EXPECT_EQ(brake_torque(settings_.brake, brake, false, t, kMillisecond), 480.0);
  }
  for (; t < 50 * kMillisecond; t += kMillisecond) brake_torque(settings_.brake, brake, false, t, kMillisecond);
  EXPECT_NEAR(brake.torque, 480.0 * std::exp(-2.0), 1e-9);
  for (; t < 150 * kMillisecond; t += kMillisecond) brake_torque(settings_.brake, brake, false, t, kMillisecond);
  EXPECT_EQ(brake.torque, 0.0);
}

TEST_F(DriveProtectionTest, TheBrakeDoesNotDependOnTheStep) {
  BrakeState fine;
  BrakeState coarse;
  for (std::int64_t t = 0; t < 60 * kMillisecond; t += kMillisecond) {
    brake_torque(settings_.brake, fine, true, t, kMillisecond);
  }
  for (std::int64_t t = 0; t < 60 * kMillisecond; t += 5 * kMillisecond) {
    brake_torque(settings_.brake, coarse, true, t, 5 * kMillisecond);
  }
  EXPECT_NEAR(fine.torque, coarse.torque, 1e-10);
}

TEST_F(DriveProtectionTest, NothingIsAllocatedWhereMessagesAreJudged) {
  trip_while_moving();
  const tests::AllocationGuard guard;
  cycles(100);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace slewlab::sim
