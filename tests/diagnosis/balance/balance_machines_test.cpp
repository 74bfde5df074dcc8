// Four real machines whose data stand beside the project (SLEWLAB_SHARED_DATA, or ../shared/data from the source), never in it.
// Judged on records that were not fitted, against plain least squares with inertia, dry and viscous friction (each direction its
// own) and a constant torque fitted on the same data: what an engineer would do by hand.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "diagnosis/balance/balance_fit.h"

namespace slewlab::diagnosis {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = 3.14159265358979323846 / 180.0;  // [rad]

fs::path data_folder() {
  const char* folder = std::getenv("SLEWLAB_SHARED_DATA");
  return folder != nullptr ? fs::path(folder) : fs::path(SLEWLAB_SOURCE_DIR) / ".." / "shared" / "data";
}

// How columns become position and effort on the axis.
struct Machine {
  const char* folder;
  std::vector<std::string> fitted, unseen;
  std::string position, effort;
  double position_factor, effort_factor;
  double inertia, top_speed;
  bool is_rotary;
  // Of the hand-made least squares, that the answer may reach on data that were not fitted. The bench's records hold two speeds in
  // each direction: left-out blocks cannot tell a viscous friction of each direction's own from a common one.
  double most_of_least_squares = 1.1;
};

const std::map<std::string, Machine>& machines() {
  static const std::map<std::string, Machine> all{
      {"motor_bench", {"motor_bench", {"fit_a.csv", "fit_b.csv"}, {"unseen_a.csv", "unseen_b.csv"}, "position_rad", "torque_command_Nm", 1.0, 1.0, 1.2e-4, 300.0, true, 1.15}},
      {"robot_axis", {"robot_axis", {"fit_a.csv", "fit_b.csv"}, {"unseen.csv"}, "motor_position_deg", "torque_Nm", kDegree, 256.8571, 1308.0, 0.5, true}},
      {"belt_cart", {"belt_cart", {"fit_a.csv", "fit_b.csv"}, {"unseen.csv"}, "position_m", "current_command_A", 1.0, 0.0934 / 0.028, 6.0, 1.0, false}},
      {"servo_axis", {"servo_axis", {"run_a.csv"}, {}, "position_m", "force_command_N", 1.0, 1.0, 95.0, 0.15, false}},
  };
  return all;
}

AxisRecord load(const Machine& machine, const std::string& file) {
  std::ifstream in(data_folder() / machine.folder / file);
  std::string line;
  std::getline(in, line);
  std::vector<std::string> names;
  std::stringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  const auto column = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  const auto time_at = column("time_s"), position_at = column(machine.position), effort_at = column(machine.effort);
  AxisRecord record;
  record.name = machine.folder + ("/" + file);
  std::vector<double> time;
  while (std::getline(in, line)) {
    std::stringstream row(line);
    std::vector<double> values;
    for (std::string value; std::getline(row, value, ',');) values.push_back(std::stod(value));
    time.push_back(values.at(static_cast<std::size_t>(time_at)));
    record.position.push_back(machine.position_factor * values.at(static_cast<std::size_t>(position_at)));
    record.effort.push_back(machine.effort_factor * values.at(static_cast<std::size_t>(effort_at)));
  }
  record.step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  return record;
}

// The first or second half of a record.
AxisRecord half_of(const AxisRecord& record, bool second) {
  const auto middle = static_cast<std::ptrdiff_t>(record.position.size() / 2);
  const auto part = [&](const std::vector<double>& values) {
    return second ? std::vector<double>(values.begin() + middle, values.end()) : std::vector<double>(values.begin(), values.begin() + middle);
  };
  return {record.name, record.step, part(record.position), part(record.effort)};
}

struct Judged {
  BalanceAnswer answer;
  double unseen = 0.0, by_least_squares = 0.0;  // root mean square of the balance's residual on what was not fitted
};

double root_mean_square(const std::vector<std::vector<double>>& parts) {
  double square = 0.0, count = 0.0;
  for (const auto& part : parts) {
    for (const double value : part) square += value * value;
    count += static_cast<double>(part.size());
  }
  return std::sqrt(square / count);
}

Judged judge(const Machine& machine, double factor = 1.0) {
  std::vector<AxisRecord> fitted, unseen;
  for (const std::string& file : machine.fitted) fitted.push_back(load(machine, file));
  for (const std::string& file : machine.unseen) unseen.push_back(load(machine, file));
  if (unseen.empty()) {
    unseen.push_back(half_of(fitted[0], true));
    fitted[0] = half_of(fitted[0], false);
  }
  for (auto* records : {&fitted, &unseen}) {
    for (AxisRecord& record : *records) {
      for (double& effort : record.effort) effort *= factor;
    }
  }
  const double inertia = machine.inertia * factor;
  const Balance balance = balance_of(fitted, inertia, machine.top_speed, machine.is_rotary);
  const double resolved = balance.resolved_speed;
  const std::vector<BalanceRecord> records = smoothed(fitted, balance), others = smoothed(unseen, balance);
  const std::vector<BalanceLaw>& laws = balance.laws;
  Judged judged;
  judged.answer = fit_balance(records, laws, inertia, resolved);
  std::vector<std::vector<double>> residuals;
  for (const BalanceRecord& record : others) residuals.push_back(balance_residual(record, laws, judged.answer.best, resolved));
  judged.unseen = root_mean_square(residuals);

  // By hand: all six columns, no choice.
  const auto rows_of = [&](const BalanceRecord& record) {
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> efforts;
    for (std::size_t n = 0; n < record.speed.size(); ++n) {
      const double v = record.speed[n];
      if (std::fabs(v) <= resolved) continue;
      Eigen::VectorXd row(6);
      row << record.acceleration[n], std::max(0.0, v), std::min(0.0, v), v > 0.0 ? 1.0 : 0.0, v < 0.0 ? -1.0 : 0.0, 1.0;
      rows.push_back(row);
      efforts.push_back(record.effort[n]);
    }
    return std::pair(rows, efforts);
  };
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd with = Eigen::VectorXd::Zero(6);
  for (const BalanceRecord& record : records) {
    const auto [rows, efforts] = rows_of(record);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      products += rows[i] * rows[i].transpose();
      with += rows[i] * efforts[i];
    }
  }
  const Eigen::VectorXd sizes = products.completeOrthogonalDecomposition().solve(with);
  residuals.clear();
  for (const BalanceRecord& record : others) {
    const auto [rows, efforts] = rows_of(record);
    residuals.emplace_back();
    for (std::size_t i = 0; i < rows.size(); ++i) residuals.back().push_back(efforts[i] - rows[i].dot(sizes));
  }
  judged.by_least_squares = root_mean_square(residuals);
  return judged;
}

class RealMachine : public testing::TestWithParam<std::string> {};

TEST_P(RealMachine, FrictionIsNamedAndHoldsOnDataThatWereNotFitted) {
  if (!fs::exists(data_folder())) GTEST_SKIP() << "no records of real machines at " << data_folder() << " (SLEWLAB_SHARED_DATA names another folder)";
  const Machine& machine = machines().at(GetParam());
  const Judged judged = judge(machine);
  const BalanceModel& best = judged.answer.best;
  EXPECT_TRUE(std::any_of(best.terms.begin(), best.terms.end(), [](const BalanceTerm& term) { return term.law == "dry"; })) << best.words();
  EXPECT_TRUE(std::any_of(best.terms.begin(), best.terms.end(), [](const BalanceTerm& term) { return term.law == "viscous"; })) << best.words();
  EXPECT_LT(judged.answer.probability_unknown, 0.02);
  EXPECT_LE(judged.unseen, machine.most_of_least_squares * judged.by_least_squares) << best.words();
  EXPECT_LT(judged.unseen * judged.unseen, judged.answer.nominal);
}

TEST_P(RealMachine, AThousandTimesHeavierGivesTheSameAnswer) {
  if (!fs::exists(data_folder())) GTEST_SKIP() << "no records of real machines at " << data_folder() << " (SLEWLAB_SHARED_DATA names another folder)";
  const Machine& machine = machines().at(GetParam());
  const Judged one = judge(machine), heavy = judge(machine, 1000.0);
  EXPECT_EQ(heavy.answer.best.words(), one.answer.best.words());
  EXPECT_NEAR(heavy.answer.best.probability, one.answer.best.probability, 1e-6);
  EXPECT_NEAR(heavy.unseen / one.unseen, 1000.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, RealMachine, testing::Values("motor_bench", "robot_axis", "belt_cart", "servo_axis"),
                         [](const auto& machine) { return machine.param; });

}  // namespace
}  // namespace slewlab::diagnosis
