// The loop in one process against the lockstep with its wire: the same messages, to the last bit.
#include "diagnosis/loop/loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "diagnosis/loop/loop_log.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/codec.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "tests/common/allocation_guard.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

namespace fs = std::filesystem;

const fs::path kScenarios = fs::path(SLEWLAB_SOURCE_DIR) / "config/scenarios";

struct Case {
  sim::Scenario scenario;
  sim::MachineSettings machine;
  NewController controller;
};

controller::ControllerSettings controller_of(const sim::Scenario& scenario) {
  controller::ControllerSettings settings =
      controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
  settings.period = 1e-9 * static_cast<double>(scenario.controller_period);
  return settings;
}

Case case_of(const std::string& scenario, std::int64_t seconds, const std::vector<common::Override>& overrides = {}) {
  Case one{sim::load_scenario_file(kScenarios / (scenario + ".yaml"), overrides), {}, {}};
  one.scenario.duration = seconds * 1'000'000'000;
  one.machine = sim::machine_settings(one.scenario);
  one.controller = [settings = controller_of(one.scenario)] { return controller::computed_answer(settings); };
  return one;
}

LoopSettings loop_settings(const sim::Scenario& scenario) {
  LoopSettings settings;
  settings.machine = sim::machine_settings(scenario);
  settings.controller = controller_of(scenario);
  settings.operator_moves = scenario.moves;
  settings.duration = 1e-9 * static_cast<double>(scenario.duration);
  return settings;
}

msgs::RunLog over_the_wire(const Case& one) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.lcmlog";
  sim::CranePlant plant(one.machine, sim::drive_run(one.scenario));
  msgs::LogWriter log(file);
  run_wire_loop(sim::lockstep_settings(one.scenario), one.controller, plant,
                [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) { log.append(channel, timestamp_us, bytes); });
  log.finish();
  const msgs::RunLogs logs = msgs::read_run_logs(file);
  EXPECT_EQ(logs.runs.size(), 1u);
  return logs.runs.at(0);
}

msgs::RunLog in_the_loop(const Case& one) {
  LoopCourse course = course_of(loop_settings(one.scenario));
  course.configuration_hash = sim::drive_run(one.scenario).configuration_hash;
  course.run_identity = sim::drive_run(one.scenario).run_identity;
  sim::CranePlant plant(one.machine, drive_run(course, one.scenario.crane.parameters.drive.group_count));
  ControllerAnswer answer(one.controller());
  LoopLog recorder(course, plant, {one.scenario.sensors_period, one.scenario.truth_period, one.scenario.status_period}, &answer);
  run_loop(course, plant, std::ref(answer), recorder.hooks());
  return std::move(recorder.log);
}

template <class Message>
void expect_same_bits(const char* channel, const std::vector<Message>& wire, const std::vector<Message>& loop) {
  ASSERT_EQ(wire.size(), loop.size()) << channel;
  std::vector<std::uint8_t> wire_bytes, loop_bytes;
  for (std::size_t n = 0; n < wire.size(); ++n) {
    msgs::encode(wire[n], wire_bytes);
    msgs::encode(loop[n], loop_bytes);
    ASSERT_EQ(wire_bytes, loop_bytes) << channel << " " << n << " at " << 1e-9 * static_cast<double>(wire[n].simulated_time) << " s";
  }
}

msgs::RunLog expect_the_same(const Case& one) {
  const msgs::RunLog wire = over_the_wire(one), loop = in_the_loop(one);
  EXPECT_GT(wire.encoder.size(), 100u);
  expect_same_bits("OPERATOR", wire.operator_moves, loop.operator_moves);
  expect_same_bits("ENCODER", wire.encoder, loop.encoder);
  expect_same_bits("TORQUE", wire.torque, loop.torque);
  expect_same_bits("CONTROLLER_STATE", wire.controller_state, loop.controller_state);
  expect_same_bits("SENSORS", wire.sensors, loop.sensors);
  expect_same_bits("TRUTH", wire.truth, loop.truth);
  expect_same_bits("PLANT_STATUS", wire.plant_status, loop.plant_status);
  return loop;
}

std::int64_t fault_count(const msgs::RunLog& run, sim::DriveFault fault) {
  return run.plant_status.back().faults.at(static_cast<std::size_t>(fault));
}

TEST(Loop, SaysWhatTheWireSaysOfTheThesisSlew) {
  const msgs::RunLog run = expect_the_same(case_of("thesis_slew", 40));
  EXPECT_EQ(run.plant_status.back().drive_state, static_cast<std::int8_t>(sim::DriveState::running));
  EXPECT_EQ(fault_count(run, sim::DriveFault::torque_limit), 0);
}

TEST(Loop, SaysWhatTheWireSaysOfInching) { expect_the_same(case_of("inching", 30)); }

TEST(Loop, SaysWhatTheWireSaysWithEffectsThatDrawNumbers) {
  Case one = case_of("slew_there_and_back", 12);
  for (const char* effect : {"gusts", "command_jitter", "torque_limit"}) {
    one.machine.effects.push_back(common::typical_instance(sim::effects_for(one.machine).at(effect)));
  }
  expect_the_same(one);
}

TEST(Loop, SaysWhatTheWireSaysWhereTheDriveLimitsTheTorque) {
  Case one = case_of("thesis_slew", 12);
  one.machine.drive_protection.torque_limit = 90.0;
  const msgs::RunLog run = expect_the_same(one);
  EXPECT_GT(fault_count(run, sim::DriveFault::torque_limit), 0);
}

TEST(Loop, SaysWhatTheWireSaysWhereTheDriveLimitsTheRate) {
  Case one = case_of("thesis_slew", 12);
  one.machine.drive_protection.torque_rate_limit = 60.0;
  const msgs::RunLog run = expect_the_same(one);
  EXPECT_GT(fault_count(run, sim::DriveFault::torque_rate), 0);
}

TEST(Loop, SaysWhatTheWireSaysWhereTheDriveTrips) {
  // A controller of one group: the drive of two trips at its first answer, and the brakes fall in.
  const msgs::RunLog run =
      expect_the_same(case_of("thesis_slew", 3, {{"controller", (kScenarios / "../controllers/one_group.yaml").string()}}));
  EXPECT_EQ(run.plant_status.back().trip_cause, static_cast<std::int8_t>(sim::DriveFault::group_count));
  EXPECT_EQ(run.plant_status.back().drive_state, static_cast<std::int8_t>(sim::DriveState::braked));
}

// A controller that leaves an emergency stop to the brakes.
TEST(Loop, SaysWhatTheWireSaysOfAnEmergencyStopWithBrakes) {
  Case one = case_of("thesis_slew", 40);
  one.controller = [compute = one.controller] {
    return [answer = compute()](const msgs::Encoder& encoder, const msgs::Operator& operator_move, msgs::Torque& torque,
                                msgs::ControllerState& state) {
      answer(encoder, operator_move, torque, state);
      torque.brake = operator_move.emergency_stop;
      torque.enable = !operator_move.emergency_stop;
    };
  };
  const msgs::RunLog run = expect_the_same(one);
  EXPECT_EQ(run.plant_status.back().drive_state, static_cast<std::int8_t>(sim::DriveState::braked));
  EXPECT_LT(std::fabs(run.truth.back().house_speed), 1e-3);  // from 0.05 rad/s: the brakes have stopped it
}

TEST(Loop, WrongPeriodsAreRefused) {
  LoopSettings settings = loop_settings(sim::load_scenario_file(kScenarios / "thesis_slew.yaml"));
  settings.machine.step = 0.003;
  EXPECT_THROW(course_of(settings), std::invalid_argument);
}

TEST(Loop, EndsWhereItIsTold) {
  LoopSettings settings = loop_settings(sim::load_scenario_file(kScenarios / "thesis_slew.yaml"));
  settings.duration = 1.0;
  MachineLoop loop(settings);
  int periods = 0;
  LoopHooks hooks;
  hooks.stop = [&] { return ++periods > 3; };
  EXPECT_EQ(loop.run(hooks), 3 * 10);  // 10 ms periods of 1 ms steps
}

TEST(Loop, HasItsInstantsOnceEach) {
  LoopSettings settings = loop_settings(sim::load_scenario_file(kScenarios / "thesis_slew.yaml"));
  settings.duration = 0.1;
  for (const bool ends_with_answer : {false, true}) {
    MachineLoop loop(settings);
    loop.course.ends_with_answer = ends_with_answer;
    int answered = 0, instants = 0, steps = 0;
    LoopHooks hooks;
    hooks.answered = [&](const LoopMoment& moment) {
      EXPECT_EQ(moment.encoder.sequence, answered++);
      EXPECT_EQ(moment.encoder.simulated_time, moment.time);
    };
    hooks.instant = [&](const LoopMoment& moment) { EXPECT_EQ(moment.step, instants++); };
    hooks.stepped = [&](const LoopMoment& moment) { EXPECT_EQ(moment.step, ++steps); };
    EXPECT_EQ(loop.run(hooks), 100);
    EXPECT_EQ(steps, 100);
    EXPECT_EQ(instants, 101);
    EXPECT_EQ(answered, ends_with_answer ? 11 : 10);
  }
}

TEST(Loop, AllocatesNothingAfterTheFirstPeriod) {
  LoopSettings settings = loop_settings(sim::load_scenario_file(kScenarios / "thesis_slew.yaml"));
  settings.duration = 6.0;  // from rest into the acceleration that begins at 5 s
  MachineLoop loop(settings);
  std::int64_t periods = 0;
  long first = 0, last = 0;
  LoopHooks hooks;
  hooks.answered = [&](const LoopMoment&) {
    (++periods == 1 ? first : last) = tests::allocation_count;
  };
  loop.run(hooks);
  EXPECT_EQ(periods, 600);
  EXPECT_EQ(last, first);
}

}  // namespace
}  // namespace slewlab::diagnosis
