// Four real machines whose data stand beside the project (SLEWLAB_SHARED_DATA, or ../shared/data from the source), never in it.
// Diagnosed on the records that are to be fitted, judged on those that are not, against what an engineer would do by hand
// (least_squares.h), fitted to the same data.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "diagnosis/balance/axis_diagnosis.h"
#include "sim/machine/machine_file.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"
#include "tests/diagnosis/balance/least_squares.h"

namespace slewlab::diagnosis {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = 3.14159265358979323846 / 180.0;  // [rad]
constexpr double kYardstick = 1.1;                          // times the error of least squares, that the answer's may be

fs::path data_folder() {
  const char* folder = std::getenv("SLEWLAB_SHARED_DATA");
  return folder != nullptr ? fs::path(folder) : fs::path(SLEWLAB_SOURCE_DIR) / ".." / "shared" / "data";
}

// How columns become position and effort on the axis; READMEs of the data.
struct Machine {
  std::vector<std::string> fitted, unseen;
  std::string position, effort;
  double position_factor = 1.0, effort_factor = 1.0;
};

const std::map<std::string, Machine>& machines() {
  static const std::map<std::string, Machine> all{
      {"motor_bench", {{"fit_a", "fit_b"}, {"unseen_a", "unseen_b"}, "position_rad", "torque_command_Nm"}},
      {"robot_axis", {{"fit_a", "fit_b"}, {"unseen"}, "motor_position_deg", "torque_Nm", kDegree, 256.8571}},
      {"belt_cart", {{"fit_a", "fit_b"}, {"unseen"}, "position_m", "current_command_A", 1.0, 0.0934 / 0.028}},
      {"servo_axis", {{"run_a"}, {}, "position_m", "force_command_N"}},
  };
  return all;
}

// The rows from `first` to `last` as shares of the file.
NamedRun load(const std::string& name, const std::string& file, const sim::MachineFile& axis, double first = 0.0, double last = 1.0) {
  const Machine& machine = machines().at(name);
  std::ifstream in(data_folder() / name / (file + ".csv"));
  std::string line;
  std::getline(in, line);
  std::vector<std::string> names;
  std::stringstream header(line);
  for (std::string column; std::getline(header, column, ',');) names.push_back(column);
  const auto column = [&](const std::string& wanted) { return static_cast<std::size_t>(std::find(names.begin(), names.end(), wanted) - names.begin()); };
  const std::size_t time_at = column("time_s"), position_at = column(machine.position), effort_at = column(machine.effort);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::stringstream row(line);
    rows.emplace_back();
    for (std::string value; std::getline(row, value, ',');) rows.back().push_back(std::stod(value));
  }
  const double step = (rows.back().at(time_at) - rows.front().at(time_at)) / static_cast<double>(rows.size() - 1);
  const double ratio = sim::total_ratio(axis.parameters.drive);
  const auto row_at = [&](double share) { return static_cast<std::size_t>(share * static_cast<double>(rows.size())); };
  NamedRun named{file, {}};
  for (std::size_t n = row_at(first); n < row_at(last); ++n) {
    msgs::Encoder encoder{};
    encoder.sequence = static_cast<std::int64_t>(n);
    encoder.simulated_time = std::llround(step * static_cast<double>(n) * 1e9);
    encoder.group_count = 1;
    encoder.shaft_position = {rows[n].at(position_at) * machine.position_factor * ratio};
    encoder.shaft_speed = {0.0};
    named.run.encoder.push_back(encoder);
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = encoder.sequence;
    torque.simulated_time = encoder.simulated_time;
    torque.group_count = 1;
    torque.motor_torque = {rows[n].at(effort_at) * machine.effort_factor / ratio};
    named.run.torque.push_back(torque);
  }
  return named;
}

struct Judged {
  AxisDiagnosis found;
  UnseenErrors ours, by_least_squares;
};

// Masses and forces times `factor`.
Judged judge(const std::string& name, double factor = 1.0) {
  const Machine& machine = machines().at(name);
  sim::MachineFile axis = sim::load_machine_file(fs::path(SLEWLAB_SOURCE_DIR) / "tests" / "diagnosis" / "machines" / name / "machine.yaml");
  axis.parameters.house.inertia *= factor;
  axis.parameters.drive.motor_inertia *= factor;
  axis.parameters.drive.rated_torque *= factor;
  std::vector<NamedRun> fitted, unseen;
  for (const std::string& file : machine.fitted) fitted.push_back(load(name, file, axis, 0.0, machine.unseen.empty() ? 0.5 : 1.0));
  for (const std::string& file : machine.unseen) unseen.push_back(load(name, file, axis));
  if (unseen.empty()) unseen.push_back(load(name, machine.fitted.front(), axis, 0.5, 1.0));
  for (std::vector<NamedRun>* runs : {&fitted, &unseen}) {
    for (NamedRun& one : *runs) {
      for (msgs::Torque& torque : one.run.torque) torque.motor_torque[0] *= factor;
    }
  }
  Judged judged{diagnose_axis(axis, fitted), {}, {}};
  const Split split = split_of(axis, fitted, unseen);
  judged.ours = predicted(split, judged.found);
  judged.by_least_squares = least_squares(split);
  return judged;
}

class RealMachine : public testing::TestWithParam<std::string> {};

TEST_P(RealMachine, FrictionIsNamedAndPredictsWhatWasNotFittedAsWellAsLeastSquares) {
  if (!fs::exists(data_folder())) GTEST_SKIP() << "no records of real machines at " << data_folder() << " (SLEWLAB_SHARED_DATA names another folder)";
  const Judged judged = judge(GetParam());
  const BalanceModel& best = judged.found.answer.best;
  EXPECT_EQ(judged.found.outcome, AxisOutcome::stated) << judged.found.verdict;
  for (const char* law : {"dry", "viscous"}) {
    EXPECT_TRUE(std::any_of(best.terms.begin(), best.terms.end(), [&](const BalanceTerm& term) { return term.law == law; })) << judged.found.verdict;
  }
  EXPECT_LT(judged.found.answer.probability_unknown, 0.02);
  EXPECT_LE(judged.ours.balance, kYardstick * judged.by_least_squares.balance) << judged.found.verdict;
  EXPECT_LE(judged.ours.forward, kYardstick * judged.by_least_squares.forward) << judged.found.verdict;
  std::cout << "  " << judged.found.verdict << "\n  of least squares: torque balance " << judged.ours.balance / judged.by_least_squares.balance << ", forward speed "
            << judged.ours.forward / judged.by_least_squares.forward << '\n';
}

TEST_P(RealMachine, OtherMassesAndForcesGiveTheSameAnswer) {
  if (!fs::exists(data_folder())) GTEST_SKIP() << "no records of real machines at " << data_folder() << " (SLEWLAB_SHARED_DATA names another folder)";
  const Judged one = judge(GetParam());
  for (const double factor : {1e3, 1e-6}) {
    const Judged other = judge(GetParam(), factor);
    EXPECT_EQ(other.found.outcome, one.found.outcome);
    EXPECT_EQ(other.found.has_remainder, one.found.has_remainder);
    EXPECT_NEAR(other.found.unexplained, one.found.unexplained, 1e-6);
    for (std::size_t l = 0; l < one.found.answer.laws.size(); ++l) EXPECT_NEAR(other.found.answer.laws[l].probability, one.found.answer.laws[l].probability, 1e-6);
    ASSERT_EQ(other.found.answer.best.words(), one.found.answer.best.words());
    EXPECT_NEAR(other.found.answer.best.probability, one.found.answer.best.probability, 1e-6);
    EXPECT_NEAR(other.ours.balance / one.ours.balance / factor, 1.0, 1e-6);
    EXPECT_NEAR(other.ours.forward / one.ours.forward, 1.0, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RealMachine, testing::Values("motor_bench", "robot_axis", "belt_cart", "servo_axis"),
                         [](const auto& machine) { return machine.param; });

}  // namespace
}  // namespace slewlab::diagnosis
