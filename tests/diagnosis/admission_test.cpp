// What is no log to judge is refused, with the place, the reason and what would fit; and each time what would have been answered
// otherwise is wrong: nothing is missing in the crane of these logs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "diagnosis/controller_replay.h"
#include "diagnosis/parameters_alone.h"
#include "diagnosis/plausibility.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

class Admission : public testing::Test {
 protected:
  // A sound one, of one run for all tests.
  static const msgs::RunLog& sound_log() {
    static const msgs::RunLog kLog = [] {
      sim::MachineSettings truth;
      truth.crane = bench().crane;
      return simulated_log(truth, bench().controller, kThereAndBack, 12.0, 3);
    }();
    return kLog;
  }
  // As diagnose() admits it.
  std::string refusal() const {
    try {
      const Record record = make_record(log_, "log", bench().admission);
      sim::MachineSettings nominal;
      nominal.crane = bench().crane;
      check_groups(record, nominal.crane);
      check_torques(record, shadow(nominal, record, bench_gains()), nominal, bench().admission);
      check_replayable(record);
    } catch (const NotAdmitted& problem) {
      return problem.what();
    }
    return "";
  }
  // The log as it is from its 5000th message of each channel on: in the middle of a ramp.
  void begin_in_motion() {
    leave_out_beginning(log_, 5000);
  }
  msgs::RunLog log_ = sound_log();
};

// One member of all groups, in every message.
template <typename Message, typename Member>
void scale(std::vector<Message>& messages, Member member, double factor) {
  for (Message& message : messages) {
    for (double& number : message.*member) number *= factor;
  }
}

TEST_F(Admission, TakesASoundLog) { EXPECT_EQ(refusal(), ""); }

// Behind a stop boom and load swing on, and draw the motors to and fro: no sensor is wrong there.
TEST_F(Admission, OfACraneThatStandsNoSensorIsBlamed) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  log_ = simulated_log(truth, bench().controller, {{2.0, 1.0}, {10.0, 0.0}}, 45.0, 3);
  leave_out_beginning(log_, 20000);
  EXPECT_NE(refusal().find("log: the crane stands, and boom and load swing on: its motors turn with"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesMissingEncoders) {
  log_.encoder.clear();
  EXPECT_NE(refusal().find("no ENCODER"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesMissingTorques) {
  log_.torque.clear();
  EXPECT_NE(refusal().find("no TORQUE"), std::string::npos);
}

TEST_F(Admission, RefusesMessagesForAnotherNumberOfMotorGroups) {
  log_.torque[7000].motor_torque.resize(1);
  log_.torque[7000].group_count = 1;
  EXPECT_NE(refusal().find("is for 1 motor groups, the crane has 2"), std::string::npos) << refusal();
  log_.encoder[7000].shaft_speed.resize(1);
  log_.encoder[7000].shaft_position.resize(1);
  log_.encoder[7000].group_count = 1;
  EXPECT_NE(refusal().find("the number of motor groups changes"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesAGapAndSaysWhere) {
  log_.encoder.erase(log_.encoder.begin() + 5000, log_.encoder.begin() + 5100);
  EXPECT_NE(refusal().find("gap of 0.101 s in ENCODER at 4.999 s"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesAGapInTheCommands) {
  log_.torque.erase(log_.torque.begin() + 5000, log_.torque.begin() + 6000);
  EXPECT_NE(refusal().find("gap of 1.001 s in TORQUE at 4.999 s"), std::string::npos) << refusal();
}

// A channel's clock that is set back by more than a second ends up in another part of the log than ENCODER's (msgs/run_log.h): the part
// then has sensors of another time than its encoders.
TEST_F(Admission, RefusesChannelsThatCoverDifferentTimes) {
  for (msgs::Sensors& sensors : log_.sensors) sensors.simulated_time -= 2'000'000'000;
  EXPECT_NE(refusal().find("SENSORS goes from -1.999 s to 9.999 s, ENCODER from 0.000 s to 11.999 s"), std::string::npos) << refusal();
  for (msgs::Sensors& sensors : log_.sensors) sensors.simulated_time += 2'000'000'000;
  log_.torque.resize(9000);
  EXPECT_NE(refusal().find("TORQUE goes from 0.000 s to 8.999 s"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesAClockThatJumpsBack) {
  for (std::size_t n = 6000; n < log_.sensors.size(); ++n) log_.sensors[n].simulated_time -= 500000000;
  EXPECT_NE(refusal().find("clock of SENSORS jumps back"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesAFrozenAccelerometer) {
  for (std::size_t n = 4000; n < log_.sensors.size(); ++n) log_.sensors[n].tip_acceleration = log_.sensors[4000].tip_acceleration;
  EXPECT_NE(refusal().find("acceleration at the tip is frozen"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesAFrozenSpeed) {
  for (std::size_t n = 4000; n < log_.encoder.size(); ++n) log_.encoder[n].shaft_speed[1] = log_.encoder[4000].shaft_speed[1];
  EXPECT_NE(refusal().find("shaft speed of group 2 is frozen"), std::string::npos) << refusal();
}

// A drive that tells its speed in coarse steps says the same for seconds, and is right.
TEST_F(Admission, TakesACoarseSpeed) {
  constexpr double kSpeedStep = 2.0;  // [rad/s] 3 % of what is reached here
  for (msgs::Encoder& encoder : log_.encoder) {
    for (double& speed : encoder.shaft_speed) speed = kSpeedStep * std::round(speed / kSpeedStep);
  }
  EXPECT_EQ(refusal(), "");
}

// What was rounded when it was written down shows in the record; a test signal's few torques were not.
TEST_F(Admission, KnowsInWhichStepsTorquesWereWrittenDown) {
  EXPECT_EQ(make_record(log_, "log", bench().admission).torque_rounding.step, 0.0);
  const auto written_in_steps_of = [&](double quantum) {
    msgs::RunLog run = log_;
    for (msgs::Torque& message : run.torque) {
      for (double& torque : message.motor_torque) torque = quantum * std::round(torque / quantum);
    }
    return make_record(run, "log", bench().admission).torque_rounding.step;
  };
  EXPECT_NEAR(written_in_steps_of(0.1), 0.1, 1e-9);
  const double rated = bench().admission.rated_torque;
  EXPECT_EQ(written_in_steps_of(0.1 * rated), 0.0);
}

// A sensor that is coarser than most of what it reads stands for seconds and holds its crests, and is neither frozen nor clipped.
TEST_F(Admission, TakesACoarseAccelerometer) {
  constexpr double kSteps = 0.05;  // [m/s^2] 5 mg: ten times the sensors' noise
  for (msgs::Sensors& sensors : log_.sensors) {
    for (double* value : {&sensors.house_acceleration, &sensors.pivot_acceleration, &sensors.middle_acceleration, &sensors.tip_acceleration}) *value = kSteps * std::round(*value / kSteps);
  }
  EXPECT_EQ(refusal(), "");
  const Record record = make_record(log_, "log", bench().admission);
  EXPECT_NEAR(record.acceleration_rounding[kTip].step, kSteps, 1e-9);
  EXPECT_TRUE(record.acceleration_rounding[kTip].is_slow);
  EXPECT_TRUE(std::any_of(record.remarks.begin(), record.remarks.end(), [](const std::string& remark) { return remark.find("in steps of 0.05 m/s^2") != std::string::npos; }));
}

TEST_F(Admission, RefusesAFrozenPosition) {
  for (std::size_t n = 4000; n < log_.encoder.size(); ++n) log_.encoder[n].shaft_position[0] = log_.encoder[4000].shaft_position[0];
  EXPECT_NE(refusal().find("shaft position of group 1 is frozen"), std::string::npos) << refusal();
  for (msgs::Encoder& encoder : log_.encoder) encoder.shaft_position[0] = 0.0;
  EXPECT_NE(refusal().find("shaft position of group 1 is frozen at 0"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesACounterThatIsSetAnew) {
  for (std::size_t n = 6000; n < log_.encoder.size(); ++n) log_.encoder[n].shaft_position[0] -= 3.0;
  EXPECT_NE(refusal().find("shaft position of group 1 jumps"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("at 6.000 s"), std::string::npos) << refusal();
  for (std::size_t n = 6000; n < log_.encoder.size(); ++n) log_.encoder[n].shaft_position[0] -= log_.encoder[5999].shaft_position[0];  // to 0
  EXPECT_NE(refusal().find("shaft position of group 1 jumps"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesFrozenCommands) {
  for (std::size_t n = 3500; n < 9000; ++n) log_.torque[n].motor_torque = log_.torque[3500].motor_torque;
  EXPECT_NE(refusal().find("the torque command, mean of the groups, is frozen"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("from 3.500 s to 8.999 s"), std::string::npos) << refusal();
}

TEST_F(Admission, RefusesOneGroupsFrozenCommand) {
  for (std::size_t n = 3500; n < log_.torque.size(); ++n) log_.torque[n].motor_torque[0] = log_.torque[3500].motor_torque[0];
  EXPECT_NE(refusal().find("the torque command of group 1 is frozen"), std::string::npos) << refusal();
}

// Play compensation lets one group press with what the other one drives against: a level to which it comes back, of this group or the other one. What stands once is
// frozen.
TEST_F(Admission, TakesAGroupThatPressesAtItsLevel) {
  const double level = log_.torque[3500].motor_torque[0];
  const auto hold = [&](std::size_t group, std::size_t first, std::size_t last, double torque) {
    for (std::size_t n = first; n < last; ++n) log_.torque[n].motor_torque[group] = torque;
  };
  hold(0, 3500, log_.torque.size() - 1000, level);
  EXPECT_NE(refusal().find("the torque command of group 1 is frozen"), std::string::npos) << refusal();
  const msgs::RunLog stands_once = log_;
  for (const std::size_t group : {0u, 1u}) {
    log_ = stands_once;
    hold(group, 1000, 2000, -level);
    EXPECT_EQ(refusal(), "") << group;
  }
}

// A controller that stands at its torque limit for seconds, there and back, says what it does. Here with edges as steep as its rate allows.
TEST_F(Admission, TakesCommandsThatStandAtTheirLimit) {
  controller::ControllerSettings weak = bench().controller;
  weak.limits.torque = 70.0;
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const std::vector<Move> hard{{2.0, 1.0}, {10.0, -1.0}, {18.0, 0.0}};
  weak.ramp.acceleration_time = weak.ramp.deceleration_time = 1.5;
  log_ = simulated_log(truth, weak, hard, kDuration, 4);
  std::size_t longest = 0, run = 0;
  for (std::size_t n = 1; n < log_.torque.size(); ++n) {
    run = log_.torque[n].motor_torque == log_.torque[n - 1].motor_torque ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  ASSERT_GT(longest, 1500u) << "it must stand there for the test to say anything";
  EXPECT_EQ(refusal(), "");
}

TEST_F(Admission, RefusesCommandsThatDoNotDrive) {
  const msgs::RunLog sound = log_;
  log_.torque[5000].enable = false;
  EXPECT_NE(refusal().find("TORQUE does not enable the drives at 5.000 s"), std::string::npos) << refusal();
  log_ = sound;
  log_.torque[5000].brake = true;
  EXPECT_NE(refusal().find("TORQUE applies the brakes at 5.000 s"), std::string::npos) << refusal();
  log_ = sound;
  msgs::PlantStatus tripped{};
  tripped.simulated_time = 5'000'000'000;
  tripped.drive_state = 2;  // docs/wire.md
  log_.plant_status.push_back(tripped);
  EXPECT_NE(refusal().find("the drives are tripped at 5.000 s"), std::string::npos) << refusal();
  log_.plant_status.back().drive_state = 3;
  EXPECT_NE(refusal().find("the brakes are on at 5.000 s"), std::string::npos) << refusal();
  log_.plant_status.back().simulated_time = -1'000'000'000;  // before the record
  EXPECT_EQ(refusal(), "");
  log_ = sound;
  for (std::size_t n = 0; n < 1000; ++n) log_.torque[n].enable = false;  // standing: nothing to drive
  EXPECT_EQ(refusal(), "");
}

TEST_F(Admission, RefusesAControllersLogWithoutTheOperator) {
  for (msgs::Operator& move : log_.operator_moves) move.speed_request = 0.0;  // as an import without speed_request writes it
  EXPECT_NE(refusal().find("no OPERATOR message asks for it"), std::string::npos) << refusal();
  log_.operator_moves.clear();
  EXPECT_NE(refusal().find("no OPERATOR message asks for it"), std::string::npos) << refusal();
}

// Wherever a record begins in motion: once the controller counts as known, the ramp is at its end and what is recorded from there on is answered as it was. Also of a
// controller whose ramp takes twice as long as the settings say.
TEST_F(Admission, AControllerIsKnownOnceItsSpeedShowsThatTheRampIsAtItsEnd) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  controller::ControllerSettings slow = bench().controller;
  slow.ramp.acceleration_time *= 2.0;
  slow.ramp.deceleration_time *= 2.0;
  const msgs::RunLog slow_log = simulated_log(truth, slow, {{0.5, 0.5}, {9.0, 0.0}}, 18.0, 3);
  for (const auto& [whole, with] : {std::pair(sound_log(), bench().controller), std::pair(slow_log, slow)}) {
    for (const int first : {2200, 2600, 3200, 4000, 5000}) {
      log_ = whole;
      leave_out_beginning(log_, first);
      const Record record = make_record(log_, "log", bench().admission);
      ASSERT_TRUE(record.begins_in_motion) << first;
      const std::optional<double> known_from = controller_known_from(record, bench().controller);
      ASSERT_TRUE(known_from) << first;
      const ControllerReplay replay = replay_controller(record, with, known_from);
      ASSERT_FALSE(replay.difference.empty());
      EXPECT_LT(replay.difference_rms, 1e-9 * replay.torque_rms) << first;
      controller::ControllerSettings other = with;
      other.speed_control.proportional_gain *= 1.1;
      const ControllerReplay differs = replay_controller(record, other, known_from);
      EXPECT_GT(differs.difference_rms, 1e-3 * differs.torque_rms) << first;
    }
  }
}

// Coarse counts, by which commands jump from one limit of their change to the other: the moment from which a controller is known lies between two of them, and no rounding of a clock's times
// decides on which side a cycle is that does not tell the integrals.
TEST_F(Admission, FromWhenAControllerIsKnownDoesNotHangOnTheClock) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"encoder_quantisation", {0.0165, 0.006}}};
  controller::ControllerSettings slow = bench().controller;
  slow.limits.rate = 2000.0;  // [N m/s] half of what a count more asks for
  constexpr std::int64_t kPeriod = 10'000'000;  // [ns]
  const msgs::RunLog whole = simulated_log(truth, slow, {{0.5, 0.5}, {9.0, 0.0}}, 18.0, 3, 1e-9 * kPeriod);
  for (const int first : {220, 260, 320, 400, 500}) {
    log_ = whole;
    leave_out_beginning(log_, first);
    Record record = make_record(log_, "log", bench().admission);
    for (int cycles = 0; cycles < 100; ++cycles) {
      const std::int64_t later = kPeriod * (cycles == 0 ? 2000 : 1);  // the clock of a recorder that has run before
      for (msgs::Encoder& message : record.encoder) message.simulated_time += later;
      for (msgs::Torque& message : record.torque) message.simulated_time += later;
      for (OperatorMove& move : record.operator_moves) move.simulated_time += later;
      record.start_time += 1e-9 * static_cast<double>(later);
      const ControllerReplay replay = replay_controller(record, slow);
      ASSERT_FALSE(replay.difference.empty());
      ASSERT_LT(replay.difference_rms, 1e-9 * replay.torque_rms) << first << ", " << cycles << " cycles later";
    }
  }
}

// A speed that does not come to rest shows no end of a ramp: then it is known once no ramp can take longer, or never.
TEST_F(Admission, AControllerIsKnownOnceNoRampCanTakeLonger) {
  begin_in_motion();
  EXPECT_EQ(refusal(), "");
  Record record = make_record(log_, "log", bench().admission);
  const double top_speed = bench().controller.ramp.top_speed * bench().controller.total_ratio;
  for (msgs::Encoder& reading : record.encoder) {
    for (double& speed : reading.shaft_speed) speed += 0.1 * top_speed * 1e-9 * static_cast<double>(reading.simulated_time - record.encoder.front().simulated_time);
  }
  EXPECT_FALSE(controller_known_from(record, bench().controller));
  EXPECT_TRUE(replay_controller(record, bench().controller).difference.empty());
  controller::ControllerSettings quick = bench().controller;
  quick.ramp.acceleration_time = quick.ramp.deceleration_time = quick.ramp.emergency_stop_time = 1.0;
  for (msgs::Encoder& reading : record.encoder) {
    for (double& speed : reading.shaft_speed) speed *= 2.0;
  }
  // The ramps there and back take two seconds; half as long again.
  const std::optional<double> known_from = controller_known_from(record, quick);
  ASSERT_TRUE(known_from);
  EXPECT_NEAR(*known_from, record.start_time + 3.0, 1e-9);
}

// A recorder that was started after the drives: what the controller's integrals and filters held by then is in its first answers.
// A small drive stands at its limit while it accelerates; what is needed changes meanwhile, by what the boom swings.
TEST_F(Admission, TakesALimitForNoFrozenCommand) {
  const auto hold = [&](double torque, double seconds, double from) {
    for (msgs::Torque& message : log_.torque) {
      const double at = 1e-9 * static_cast<double>(message.simulated_time) - from;
      if (at >= 0.0 && at < seconds) std::fill(message.motor_torque.begin(), message.motor_torque.end(), torque);
    }
  };
  const msgs::RunLog sound = log_;
  hold(260.0, 3.0, 3.0);
  EXPECT_NE(refusal().find("frozen at 260"), std::string::npos) << refusal();
  log_ = sound;
  hold(260.0, 3.0, 3.0);
  hold(-260.0, 1.0, 10.0);
  EXPECT_EQ(refusal().find("frozen at 260"), std::string::npos) << refusal();
  log_ = sound;
  // The controller's own limit, which no file tells: met once, and left as it was come to.
  double largest = 0.0;
  for (const msgs::Torque& message : log_.torque) largest = std::max(largest, message.motor_torque[0] + message.motor_torque[1]);
  for (msgs::Torque& message : log_.torque) {
    if (message.motor_torque[0] + message.motor_torque[1] > 0.6 * largest) message.motor_torque = {0.3 * largest, 0.3 * largest};
  }
  EXPECT_EQ(refusal().find("mean of the groups, is frozen"), std::string::npos) << refusal();
  log_ = sound;
  hold(bench().admission.rated_torque, 3.0, 3.0);  // the limit that the machine's file tells: once is enough
  EXPECT_EQ(refusal().find("frozen"), std::string::npos) << refusal();
}

// A recorder that is switched on a moment after the lever was moved finds the machine still slow, but its ramp on the way and its boom bent: it begins
// in motion. One that runs from the beginning of a run whose lever is moved at once does not: nothing pushes yet.
TEST_F(Admission, ARecordThatBeginsOnTheWayToASpeedBeginsInMotion) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const msgs::RunLog from_the_start = simulated_log(truth, bench().controller, {{0.0, 0.6}}, 6.0, 3);
  EXPECT_FALSE(make_record(from_the_start, "log", bench().admission).begins_in_motion);
  log_ = from_the_start;
  leave_out_beginning(log_, 200);
  log_.operator_moves.resize(1);
  log_.operator_moves[0].simulated_time = log_.encoder[0].simulated_time;
  const Record record = make_record(log_, "log", bench().admission);
  double first = 0.0, largest = 0.0;
  for (const double rate : record.position_rate[0]) largest = std::max(largest, std::fabs(rate));
  for (int n = 0; n < 50; ++n) first += record.position_rate[0][static_cast<std::size_t>(n)] / 50.0;
  EXPECT_LT(std::fabs(first), 0.05 * largest);  // nearly at rest
  EXPECT_TRUE(record.begins_in_motion);
  const std::optional<double> known_from = controller_known_from(record, bench().controller);
  ASSERT_TRUE(known_from);
  EXPECT_GT(*known_from, 0.6 * bench().controller.ramp.acceleration_time);  // the ramp's length, to 0.6 of the top speed
}

TEST_F(Admission, AControllerThatWasOnBeforeIsKnownAfterAFewCycles) {
  leave_out_beginning(log_, 1500);
  const Record record = make_record(log_, "log", bench().admission);
  ASSERT_FALSE(record.begins_in_motion);
  const std::optional<double> known_from = controller_known_from(record, bench().controller);
  ASSERT_TRUE(known_from);
  EXPECT_GT(*known_from, record.start_time);
  EXPECT_LT(*known_from, record.start_time + 0.1);
  const ControllerReplay replay = replay_controller(record, bench().controller);
  EXPECT_LT(replay.difference_rms, 1e-9 * replay.torque_rms);
}

// A command that may change by less per cycle than the first one is large does not wind the integrals up.
TEST_F(Admission, AControllerWhoseCommandsChangeSlowlyIsKnownAfterAFewCyclesToo) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  controller::ControllerSettings slow = bench().controller;
  slow.limits.rate = 2000.0;  // [N m/s] 2 N m per cycle, of offsets of some 31
  log_ = simulated_log(truth, slow, kThereAndBack, 12.0, 3);
  leave_out_beginning(log_, 1500);
  const Record record = make_record(log_, "log", bench().admission);
  const std::optional<double> known_from = controller_known_from(record, slow);
  ASSERT_TRUE(known_from);
  const ControllerReplay replay = replay_controller(record, slow);
  EXPECT_LT(replay.difference_rms, 1e-9 * replay.torque_rms);
}

TEST_F(Admission, RefusesAClippedAccelerometer) {
  for (auto& sensors : log_.sensors) sensors.tip_acceleration = std::clamp(sensors.tip_acceleration, -0.1, 0.1);
  EXPECT_NE(refusal().find("clipped"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesTheUnitThatWouldFit) {
  scale(log_.encoder, &msgs::Encoder::shaft_speed, 60.0 / (2.0 * std::numbers::pi));
  EXPECT_NE(refusal().find("revolutions per minute"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesTheUnitOfAPosition) {
  const msgs::RunLog sound = log_;
  const auto with_positions = [&](double factor) {
    log_ = sound;
    scale(log_.encoder, &msgs::Encoder::shaft_position, factor);
    return refusal();
  };
  EXPECT_NE(with_positions(180.0 / std::numbers::pi).find("the position looks like degrees"), std::string::npos) << refusal();
  EXPECT_NE(with_positions(0.5 / std::numbers::pi).find("the position looks like revolutions"), std::string::npos) << refusal();
  EXPECT_NE(with_positions(1.0 / bench().admission.total_ratio).find("the position looks like the slew axis's"), std::string::npos) << refusal();
}

// At a PLC's rate a motor turns many degrees from one reading to the next: that is no counter that was set anew.
TEST_F(Admission, NamesTheUnitOfAPositionThatIsReadSlowly) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  log_ = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 4, 0.01);
  scale(log_.encoder, &msgs::Encoder::shaft_position, 180.0 / std::numbers::pi);
  EXPECT_NE(refusal().find("the position looks like degrees"), std::string::npos) << refusal();
}

// A row that has a turn too much, which the next one gives back, was read at another time; one that all later rows keep is a counter's.
TEST_F(Admission, TellsACounterThatIsSetAnewFromARowOfAnotherTime) {
  constexpr double kTurn = 6.0;  // [rad]
  constexpr std::size_t kAt = 700;
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  const msgs::RunLog sound = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 4, 0.01);
  log_ = sound;
  log_.encoder[kAt].shaft_position[0] += kTurn;
  EXPECT_NE(refusal().find("was read later or earlier than its time says"), std::string::npos) << refusal();
  log_ = sound;
  for (std::size_t n = kAt; n < log_.encoder.size(); ++n) log_.encoder[n].shaft_position[0] += kTurn;
  EXPECT_NE(refusal().find("a counter that was set anew?"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesGroupsWhoseTorquesAreExchanged) {
  for (msgs::Torque& torque : log_.torque) std::swap(torque.motor_torque[0], torque.motor_torque[1]);
  EXPECT_NE(refusal().find("goes with the torque commands of group 2"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesTheUnitOfAnAcceleration) {
  for (msgs::Sensors& sensors : log_.sensors) sensors.tip_acceleration /= 9.81;
  EXPECT_NE(refusal().find("acceleration at the tip"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("multiples of g"), std::string::npos) << refusal();
  for (msgs::Sensors& sensors : log_.sensors) sensors.tip_acceleration *= 9.81 * 9.81;
  EXPECT_NE(refusal().find("multiplied by g"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesTheSignAndUnitOfTheCommands) {
  const msgs::RunLog sound = log_;
  const auto with_torques = [&](double factor) {
    log_ = sound;
    scale(log_.torque, &msgs::Torque::motor_torque, factor);
    return refusal();
  };
  EXPECT_NE(with_torques(-1.0).find("its sign is turned"), std::string::npos) << refusal();
  EXPECT_NE(with_torques(1e-3).find("it looks like kN m"), std::string::npos) << refusal();
  EXPECT_NE(with_torques(3.0).find("it looks like the sum over a group's 3 motors"), std::string::npos) << refusal();
  EXPECT_NE(with_torques(6.0).find("it looks like the sum over all 6 motors"), std::string::npos) << refusal();
  // Half or twice the torque may be a crane's own: another inertia.
  EXPECT_EQ(with_torques(0.5), "");
  EXPECT_EQ(with_torques(2.0), "");
}

// What large friction, wind or an eccentric load add to the torques is the diagnosis's to find, and no wrong unit.
TEST_F(Admission, TakesTorquesOfACraneThatMissesMuch) {
  const std::vector<std::vector<common::EffectInstance>> machines{{{"dragging_brake", {80.0, 0.0, 0.02}}}, {{"heel", {0.05, 1.0}}}, {{"house_inertia", {1.0}}}};
  for (const std::vector<common::EffectInstance>& effects : machines) {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    truth.effects = effects;
    log_ = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 4);
    EXPECT_EQ(refusal(), "") << effects[0].name;
  }
}

TEST_F(Admission, NamesATurnedSign) {
  scale(log_.encoder, &msgs::Encoder::shaft_speed, -1.0);
  EXPECT_NE(refusal().find("sign is turned"), std::string::npos) << refusal();
}

// Of one group alone: its commands, its positions and speeds, or all of them.
TEST_F(Admission, NamesTheGroupWhoseSignIsTurned) {
  const auto turn = [](msgs::RunLog& log, bool torques, bool positions) {
    for (auto& torque : log.torque) torque.motor_torque[1] *= torques ? -1.0 : 1.0;
    for (auto& encoder : log.encoder) {
      encoder.shaft_position[1] *= positions ? -1.0 : 1.0;
      encoder.shaft_speed[1] *= positions ? -1.0 : 1.0;
    }
  };
  const msgs::RunLog sound = log_;
  turn(log_, true, false);
  EXPECT_NE(refusal().find("torque commands of group 2"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("its sign is turned"), std::string::npos) << refusal();
  for (const bool torques : {false, true}) {
    log_ = sound;
    turn(log_, torques, true);
    EXPECT_NE(refusal().find("group 2 turns against group 1"), std::string::npos) << refusal();
  }
}

TEST_F(Admission, NamesATurnedAccelerometer) {
  for (auto& sensors : log_.sensors) sensors.house_acceleration = -sensors.house_acceleration;
  EXPECT_NE(refusal().find("acceleration at the house"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("sign is turned"), std::string::npos) << refusal();
  for (auto& sensors : log_.sensors) {
    sensors.house_acceleration = -sensors.house_acceleration;
    sensors.tip_acceleration = -sensors.tip_acceleration;
  }
  EXPECT_NE(refusal().find("acceleration at the tip"), std::string::npos) << refusal();
}

TEST_F(Admission, NamesATurnedAccelerometerThatHasAnOffset) {
  for (msgs::Sensors& sensors : log_.sensors) sensors.house_acceleration = 0.2 - sensors.house_acceleration;
  EXPECT_NE(refusal().find("acceleration at the house"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("sign is turned"), std::string::npos) << refusal();
}

// On a vessel that rolls the accelerometers weigh gravity: what stands near the slew axis shows more of it than of slewing, and
// that is no turned sign.
TEST_F(Admission, TakesARollForNoTurnedSign) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"vessel_roll", {0.007, 8.0, 0.0, 1.57, 18.0}}};
  const std::vector<Move> in_its_rhythm{{2.0, 0.5}, {6.0, 0.0}, {10.0, 0.5}, {14.0, 0.0}, {18.0, 0.5}, {22.0, 0.0}};
  for (int eighth = -3; eighth <= 4; ++eighth) {
    truth.effects[0].values[2] = 0.25 * std::numbers::pi * eighth;
    log_ = simulated_log(truth, bench().controller, in_its_rhythm, kDuration, 4);
    EXPECT_EQ(refusal(), "") << eighth;
  }
}

TEST_F(Admission, RefusesNotANumber) {
  log_.encoder[100].shaft_speed[1] = std::nan("");
  EXPECT_NE(refusal().find("shaft speed of group 2 is not a number at 0.100 s"), std::string::npos) << refusal();
}

// The residual variance ratio (1 = noise only) of parameters alone on a record, taken as it is.
double left_by_parameters(const Record& record) {
  BenchProblem problem;
  problem.add(record);
  return fit_parameters_alone(problem, nominal_fit(problem)).mean_square;
}

// What is refused would indeed have been answered wrongly. In the crane of this log nothing is missing. With each of these faults
// bridged in silence the residual variance ratio (1 = noise only) of parameters would be several, which is a gap that no crane has.
TEST_F(Admission, WhatIsRefusedWouldHaveLookedLikeAGap) {
  const Record sound = make_record(log_, "log", bench().admission);
  EXPECT_LT(left_by_parameters(sound), 1.2);
  const auto left_with = [&](const std::function<void(Record&)>& fault) {
    Record record = sound;
    fault(record);
    return left_by_parameters(record);
  };
  const auto each_torque = [](Record& record, auto&& change) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t n = 0; n < record.size(); ++n) change(record.motor_torque[g], n);
    }
  };
  EXPECT_GT(left_with([&](Record& late) {  // a clock that jumps back by half a second
    for (std::size_t n = late.size() / 2; n < late.size(); ++n) late.acceleration[kTip][n] = sound.acceleration[kTip][n - 500];
  }), 3.0);
  EXPECT_GT(left_with([&](Record& gap) {  // a second without sensors, the last value held
    for (std::size_t n = 4000; n < 5000; ++n) gap.acceleration[kTip][n] = sound.acceleration[kTip][3999];
  }), 3.0);
  EXPECT_GT(left_with([&](Record& gap) {  // a second without commands, the last one held
    each_torque(gap, [](std::vector<double>& torque, std::size_t n) { if (n >= 5000 && n < 6000) torque[n] = torque[4999]; });
  }), 3.0);
  EXPECT_GT(left_with([&](Record& apart) {  // sensors of two seconds later than the encoders
    for (std::size_t n = 0; n + 2000 < apart.size(); ++n) apart.acceleration[kTip][n] = sound.acceleration[kTip][n + 2000];
  }), 3.0);
  EXPECT_GT(left_with([&](Record& frozen) {
    for (std::size_t n = 4000; n < frozen.size(); ++n) frozen.acceleration[kTip][n] = sound.acceleration[kTip][4000];
  }), 3.0);
  EXPECT_GT(left_with([&](Record& frozen) {
    for (std::size_t n = 4000; n < frozen.size(); ++n) {
      frozen.shaft_position[0][n] = sound.shaft_position[0][4000];
      frozen.position_rate[0][n] = 0.0;
    }
  }), 3.0);
  EXPECT_GT(left_with([&](Record& frozen) {
    each_torque(frozen, [](std::vector<double>& torque, std::size_t n) { if (n >= 4000 && n < 9000) torque[n] = torque[4000]; });
  }), 3.0);
  EXPECT_GT(left_with([&](Record& jumping) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t n = 6000; n < jumping.size(); ++n) jumping.shaft_position[g][n] -= 0.6;
    }
  }), 3.0);
  EXPECT_GT(left_with([&](Record& off) {  // commands that were not driven from 3 s on, as if the drive had followed them
    each_torque(off, [](std::vector<double>& torque, std::size_t n) { if (n >= 3000) torque[n] += 50.0; });
  }), 3.0);
  EXPECT_GT(left_with([&](Record& clipped) {
    for (double& acceleration : clipped.acceleration[kTip]) acceleration = std::clamp(acceleration, -0.1, 0.1);
  }), 3.0);
  EXPECT_GT(left_with([&](Record& turned) {
    for (double& acceleration : turned.acceleration[kTip]) acceleration = -acceleration;
  }), 3.0);
  EXPECT_GT(left_with([&](Record& turned) {
    each_torque(turned, [](std::vector<double>& torque, std::size_t n) { torque[n] = -torque[n]; });
  }), 3.0);
  EXPECT_GT(left_with([&](Record& turns) {  // positions in revolutions
    for (std::size_t g = 0; g < 2; ++g) {
      for (double& position : turns.shaft_position[g]) position *= 0.5 / std::numbers::pi;
      for (double& rate : turns.position_rate[g]) rate *= 0.5 / std::numbers::pi;
    }
  }), 3.0);
}

// The same for the controller's side: it answers as its settings say, and would have been blamed. 0.001 is the share of the torques from
// which diagnose() says that it answers otherwise.
TEST_F(Admission, WhatIsRefusedWouldHaveBlamedTheController) {
  const auto difference = [&] {
    const ControllerReplay replay = replay_controller(make_record(log_, "log", bench().admission), bench().controller);
    return replay.difference_rms / replay.torque_rms;
  };
  const msgs::RunLog sound = log_;
  EXPECT_LT(difference(), 1e-9);
  log_.operator_moves.clear();
  EXPECT_GT(difference(), 0.1);
  log_ = sound;
  Record in_rpm = make_record(log_, "log", bench().admission);
  scale(in_rpm.encoder, &msgs::Encoder::shaft_speed, 30.0 / std::numbers::pi);
  const ControllerReplay replay = replay_controller(in_rpm, bench().controller);
  EXPECT_GT(replay.difference_rms, 0.1 * replay.torque_rms);
}

// A log that lost an ENCODER of a ramp, which is bridged: the controller had it, and computed.
TEST_F(Admission, AMissingEncoderDoesNotBlameTheController) {
  log_.encoder.erase(log_.encoder.begin() + 4000);
  const ControllerReplay replay = replay_controller(make_record(log_, "log", bench().admission), bench().controller);
  EXPECT_LT(replay.difference_rms, 1e-3 * replay.torque_rms);
}

// A sensor that is mounted out of the level, or has a zero of its own, tells nothing wrong of the crane.
TEST_F(Admission, AnAccelerometersOffsetIsNoGap) {
  for (msgs::Sensors& sensors : log_.sensors) {
    sensors.house_acceleration += 0.05;
    sensors.pivot_acceleration -= 0.2;
    sensors.middle_acceleration += 0.1;
    sensors.tip_acceleration += 0.3;
  }
  EXPECT_LT(left_by_parameters(make_record(log_, "log", bench().admission)), 1.2);
}

// Accelerometers at a rate and at instants of their own. Lines between their samples are damped and noiseless; they are compared with
// an observer that is sampled alike.
TEST_F(Admission, SlowerSensorsAreNoGap) {
  std::vector<msgs::Sensors> slow;
  for (std::size_t n = 0; n + 1 < log_.sensors.size(); n += 10) {
    msgs::Sensors sensors = log_.sensors[n];
    const double share = 0.3;  // of a step later, straight between the two
    sensors.simulated_time += 300'000;
    sensors.tip_acceleration += share * (log_.sensors[n + 1].tip_acceleration - sensors.tip_acceleration);
    sensors.middle_acceleration += share * (log_.sensors[n + 1].middle_acceleration - sensors.middle_acceleration);
    sensors.pivot_acceleration += share * (log_.sensors[n + 1].pivot_acceleration - sensors.pivot_acceleration);
    sensors.house_acceleration += share * (log_.sensors[n + 1].house_acceleration - sensors.house_acceleration);
    slow.push_back(sensors);
  }
  log_.sensors = slow;
  const Record record = make_record(log_, "log", bench().admission);
  EXPECT_DOUBLE_EQ(record.step, 1e-3);
  EXPECT_LT(left_by_parameters(record), 1.2);
  Record as_on_grid = record;  // for the residual if the lines were taken for measurements
  as_on_grid.sampled_at.clear();
  EXPECT_GT(left_by_parameters(as_on_grid), 3.0);
}

// The controller's cycle is a whole number of steps of the grid, or closed loops would run at another rate.
TEST_F(Admission, TheGridDividesTheControllersCycle) {
  std::vector<msgs::Encoder> slow;
  std::vector<msgs::Sensors> sensors;
  std::vector<msgs::Torque> torque;
  for (std::size_t n = 0; n < log_.encoder.size(); n += 5) slow.push_back(log_.encoder[n]);
  for (std::size_t n = 0; n < log_.torque.size(); n += 5) torque.push_back(log_.torque[n]);
  for (std::size_t n = 1; n < log_.sensors.size(); n += 2) sensors.push_back(log_.sensors[n]);
  log_.encoder = slow;
  log_.torque = torque;
  log_.sensors = sensors;
  const Record record = make_record(log_, "log", bench().admission);
  EXPECT_DOUBLE_EQ(record.encoder_period, 5e-3);
  EXPECT_DOUBLE_EQ(record.step, 5e-3 / 3.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
