// Steps between readings at a PLC's rate, of logs without noise: as many as a law needs, and with them a machine follows its own log.
#include "diagnosis/model_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diagnosis/admit.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPlcPeriod = 0.01;  // [s]
constexpr int kFinest = 10;          // steps of a thousandth of the characteristic time (1.007 s) in one period of the PLC

sim::MachineSettings sticking_crane() {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  return machine;
}

Record plc_record(const sim::MachineSettings& machine) {
  return make_record(quiet_log(machine, bench().controller, kThereAndBack, kDuration, kPlcPeriod), "plc", bench().admission);
}

void take(const sim::MachineSettings& nominal, Record record, Problem& problem) {
  std::vector<Record> records{std::move(record)};
  set_machine(nominal, records, problem);
  std::vector<std::string> remarks;
  admit(std::move(records), whitening_for(problem.thresholds, false), problem, remarks);
}

ForceSteps steps_of(Problem& problem) { return steps_for_forces(problem, {}, {}).of_differences; }

double mean_square(const sim::MachineSettings& nominal, const ForceSteps& steps) {
  Problem problem;
  take(nominal, plc_record(sticking_crane()), problem);
  problem.force_steps = steps;
  const Eigen::VectorXd found = differences(problem, Point{});
  return found.squaredNorm() / static_cast<double>(found.size());
}

TEST(ModelStep, AMachineFollowsItsOwnLogAtThePlcsRate) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const double without = mean_square(nominal, {}), coarse = mean_square(sticking_crane(), {{"bearing_coulomb", 1}}), own = mean_square(sticking_crane(), {});
  EXPECT_GT(coarse, 1.0) << "one step per reading is not what the log was made with";
  EXPECT_LT(own, 0.01 * coarse);
  EXPECT_LT(own, 0.001 * without);
}

TEST(ModelStep, EachLawGetsWhatItNeedsAndNoMore) {
  Problem problem;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  take(nominal, plc_record(sticking_crane()), problem);
  const ForceSteps steps = steps_of(problem);
  for (const auto& [effect, count] : steps) {
    EXPECT_TRUE(acts_by_force(effect)) << effect;
    EXPECT_GE(count, 1) << effect;
    EXPECT_LE(count, kFinest) << effect;
  }
  // A friction whose size changes every few degrees needs more than a film of grease.
  EXPECT_GT(steps.at("bearing_uneven"), steps.at("bearing_viscous"));
  EXPECT_FALSE(steps.contains("boom_stiffness"));
  EXPECT_TRUE(problem.force_steps.empty()) << "asking changes nothing";
}

// What every machine does is no cause, but where the records show it every simulation has it: it is asked like every law. Of ordinary sensors the pull of a load that
// swings in ten seconds needs no more than every other step.
TEST(ModelStep, WhatEveryMachineDoesGetsWhatItNeedsAsWell) {
  Problem problem;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  take(nominal, make_record(simulated_log(nominal, bench().controller, kThereAndBack, kDuration, 3, kPlcPeriod), "plc", bench().admission), problem);
  const ForceSteps steps = steps_of(problem);
  ASSERT_TRUE(steps.contains("large_angles"));
  EXPECT_LE(steps.at("large_angles"), kFinest / 2);
  EXPECT_FALSE(steps_for_forces(problem, std::vector<std::string>{"large_angles"}, {}).of_differences.contains("large_angles"));
}

// Columns of the parameters of a machine that sticks, by as few steps as are enough for columns: within a tenth of those that are taken as finely as its differences. Without such steps
// they are those.
TEST(ModelStep, ColumnsAskForLess) {
  Problem problem;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  take(nominal, plc_record(sticking_crane()), problem);
  ModelSteps steps = steps_for_forces(problem, {}, {});
  ASSERT_LT(steps.of_columns.at("bearing_coulomb"), steps.of_differences.at("bearing_coulomb"));
  problem.force_steps = steps.of_differences;
  const Point from{std::vector<double>(nuisance_count(problem), 0.0), sticking_crane().effects, 0};
  std::vector<Point> points(problem.nuisances.parameters.size(), from);
  for (std::size_t k = 0; k < points.size(); ++k) points[k].nuisance[k] = 0.3;
  const Eigen::VectorXd difference = differences(problem, from);
  const std::vector<Eigen::VectorXd> fine = changes(problem, column_base(problem, from, difference), points);
  problem.column_steps = steps.of_columns;
  const std::vector<Eigen::VectorXd> coarse = changes(problem, column_base(problem, from, difference), points);
  ASSERT_EQ(coarse.size(), points.size());
  double of_fine = 0.0, of_error = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_EQ(fine[k], differences(problem, points[k]) - difference) << k;
    of_fine += fine[k].squaredNorm();
    of_error += (coarse[k] - fine[k]).squaredNorm();
  }
  EXPECT_LT(std::sqrt(of_error / of_fine), 0.1);
  EXPECT_GT(of_error, 0.0);
}

// Judged on a grid of 5 ms (judged_grid.h), into which five of the model's steps go.
TEST(ModelStep, RecordsOfTheModelsOwnRateNeedNoShorterSteps) {
  Problem problem;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  take(nominal, make_record(simulated_log(sticking_crane(), bench().controller, kThereAndBack, kDuration, 3), "fine", bench().admission), problem);
  for (const auto& [effect, count] : steps_of(problem)) {
    EXPECT_LE(count, 5) << effect;
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
