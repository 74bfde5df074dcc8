#include "tools/soak/task_draw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "controller/controller_file.h"
#include "sim/machine/machine_file.h"
#include "sim/drive/scenario_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SLEWLAB_SOURCE_DIR) / "config";

class TaskDrawTest : public testing::Test {
 protected:
  TaskRanges ranges = load_soak_settings(kConfig / "soak/thesis.yaml").ranges;
  sim::CraneParameters crane = sim::load_machine_file(kConfig / "cranes/thesis.yaml").parameters;
  controller::RampSettings ramp = controller::load_controller_file(kConfig / "controllers/thesis.yaml").settings.ramp;
};

TEST_F(TaskDrawTest, StaysWithinTheCranesLimits) {
  int empty = 0, full = 0;
  for (int number = 0; number < 1000; ++number) {
    const SoakTask task = draw_task(ranges, crane, ramp, true, 3, number);
    EXPECT_GE(task.boom_angle, ranges.boom_angle.lowest);
    EXPECT_LE(task.boom_angle, ranges.boom_angle.highest);
    EXPECT_GE(task.rope_length, ranges.rope_length.lowest);
    EXPECT_LE(task.rope_length, ranges.rope_length.highest);
    const double radius = crane.boom.pivot_radius + crane.boom.length * std::cos(task.boom_angle);
    const double moment = task.load_mass * sim::kGravity * radius;
    EXPECT_LE(task.load_mass, ranges.largest_mass);
    EXPECT_LE(moment, ranges.largest_moment * (1.0 + 1e-12));
    empty += task.load_mass == 0.0;
    full += task.load_mass == ranges.largest_mass || moment > 0.9999 * ranges.largest_moment;
    std::int64_t last = -1;
    for (const sim::OperatorMove& move : task.moves) {
      EXPECT_GT(move.time, last);
      EXPECT_EQ(move.time % ranges.plant_step, 0);
      EXPECT_LE(std::fabs(move.speed_request), 1.0);
      last = move.time;
    }
    EXPECT_LT(last, ranges.duration);
    EXPECT_GE(task.faults.size(), 1u);
    EXPECT_LE(task.faults.size(), static_cast<std::size_t>(ranges.most_faults));
  }
  // 10 % without load, 20 % of the others with all that may be lifted: five standard deviations are 0.05 and 0.06.
  EXPECT_NEAR(empty, 100, 50);
  EXPECT_NEAR(full, 180, 60);
}

TEST_F(TaskDrawTest, DrawsEveryFaultAndEveryCorruption) {
  std::set<sim::FaultKind> kinds;
  std::set<sim::Corruption> corruptions;
  for (int number = 0; number < 1000; ++number) {
    for (const sim::Fault& fault : draw_task(ranges, crane, ramp, true, 3, number).faults) {
      kinds.insert(fault.kind);
      if (fault.kind == sim::FaultKind::message_corrupted) corruptions.insert(fault.corruption);
    }
  }
  EXPECT_EQ(kinds.size(), sim::kFaultKindNames.size());
  EXPECT_EQ(corruptions.size(), sim::kCorruptionNames.size());
}

// An encoder of a slow machine lies by as large a share of what it should say.
TEST_F(TaskDrawTest, WrongSpeedsAreAShareOfTheMachinesOwn) {
  sim::CraneParameters slow = crane;
  slow.drive.top_speed *= 0.01;
  const auto largest = [&](const sim::CraneParameters& machine) {
    double speed = 0.0;
    for (int number = 0; number < 200; ++number) {
      for (const sim::Fault& fault : draw_task(ranges, machine, ramp, true, 3, number).faults) speed = std::max(speed, std::fabs(fault.speed));
    }
    return speed;
  };
  const double of_thesis = largest(crane), motor_speed = crane.drive.top_speed * 215.4 * 12.7;  // [rad/s] thesis 2.10
  EXPECT_GT(of_thesis, 0.13 * motor_speed);
  EXPECT_LE(of_thesis, 0.15 * motor_speed);
  EXPECT_NEAR(largest(slow) / of_thesis, 0.01, 1e-12);
}

TEST_F(TaskDrawTest, DependsOnSeedAndNumberAlone) {
  const auto text = [&](std::uint64_t seed, std::int64_t number) {
    return task_scenario(draw_task(ranges, crane, ramp, true, seed, number), ranges, "crane", "controller");
  };
  const std::string first = text(3, 17);
  EXPECT_NE(first, text(3, 18));
  EXPECT_NE(first, text(4, 17));
  EXPECT_EQ(first, text(3, 17));
}

TEST_F(TaskDrawTest, WithoutFaultsDrawsNone) {
  for (int number = 0; number < 100; ++number) {
    EXPECT_TRUE(draw_task(ranges, crane, ramp, false, 3, number).faults.empty());
  }
}

// A point mass on a short rope under full reversals would be swung far by an operator who does not look.
TEST_F(TaskDrawTest, AnOperatorWhoWatchesMakesFewerMoves) {
  std::size_t watched = 0, blind = 0;
  TaskRanges careless = ranges;
  careless.watched_sidelead = 100.0;
  for (int number = 0; number < 100; ++number) {
    watched += draw_task(ranges, crane, ramp, false, 3, number).moves.size();
    blind += draw_task(careless, crane, ramp, false, 3, number).moves.size();
  }
  EXPECT_LT(watched, blind);
  EXPECT_GT(watched, blind / 2);
}

// The file says what was drawn: read by the reader of every scenario, it gives the same moves, faults and crane.
TEST_F(TaskDrawTest, TheScenarioSaysWhatWasDrawn) {
  const TemporaryFolder folder;
  for (int number = 0; number < 50; ++number) {
    const SoakTask task = draw_task(ranges, crane, ramp, true, 5, number);
    const fs::path file = folder.path() / "task.yaml";
    std::ofstream(file) << task_scenario(task, ranges, kConfig / "cranes/thesis.yaml", kConfig / "controllers/thesis.yaml");
    const sim::Scenario scenario = sim::load_scenario_file(file, task_overrides(task, crane));
    EXPECT_EQ(scenario.duration, ranges.duration);
    EXPECT_EQ(scenario.seed, task.scenario_seed);
    EXPECT_EQ(scenario.crane.parameters.load.mass, task.load_mass);
    EXPECT_EQ(scenario.crane.parameters.load.rope_length, task.rope_length);
    EXPECT_EQ(scenario.crane.parameters.boom.angle, task.boom_angle);
    ASSERT_EQ(scenario.moves.size(), task.moves.size());
    for (std::size_t i = 0; i < task.moves.size(); ++i) {
      EXPECT_EQ(scenario.moves[i].time, task.moves[i].time);
      EXPECT_EQ(scenario.moves[i].speed_request, task.moves[i].speed_request);
      EXPECT_EQ(scenario.moves[i].emergency_stop, task.moves[i].emergency_stop);
      EXPECT_EQ(scenario.moves[i].acknowledge, task.moves[i].acknowledge);
    }
    ASSERT_EQ(scenario.faults.size(), task.faults.size());
    for (std::size_t i = 0; i < task.faults.size(); ++i) {
      const sim::Fault& read = scenario.faults[i];
      const sim::Fault& drawn = task.faults[i];
      EXPECT_EQ(read.kind, drawn.kind);
      EXPECT_EQ(read.from, drawn.from);
      EXPECT_EQ(read.until, drawn.until);
      if (drawn.kind == sim::FaultKind::message_corrupted) {
        EXPECT_EQ(read.corruption, drawn.corruption);
        EXPECT_EQ(read.channel, drawn.channel);
        EXPECT_EQ(read.probability, drawn.probability);
        EXPECT_EQ(read.seed, drawn.seed);
      }
      if (drawn.kind == sim::FaultKind::encoder_frozen) { EXPECT_EQ(read.group, drawn.group); }
    }
  }
}

// A crane without boom or load has nothing there to be drawn.
TEST_F(TaskDrawTest, LeavesOutWhatTheCraneDoesNotHave) {
  crane.boom = {};
  crane.boom.element_count = 0;
  crane.load = {};
  const SoakTask task = draw_task(ranges, crane, ramp, false, 3, 0);
  EXPECT_EQ(task.load_mass, 0.0);
  EXPECT_TRUE(task_overrides(task, crane).empty());
}

}  // namespace
}  // namespace slewlab::tools
