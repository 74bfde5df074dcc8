#include "diagnosis/unseen_record.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/fit.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// A dragging bearing, known from one record, predicts another; without it the nominal machine and its parameters do not. One whose torques are no such crane's is told, and left out.
TEST(UnseenRecord, IsPredictedByTheCauseThatActs) {
  constexpr double kMillinewton = 1e3;  // a slip of unit
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 34), "a", bench().admission));
  const FitResult parameters = fit_nuisances(problem, nominal_fit(problem));
  const msgs::RunLog inching = simulated_log(truth, bench().controller, kInching, kDuration, 35);
  msgs::RunLog slipped = inching;
  for (msgs::Torque& torque : slipped.torque) {
    for (double& one : torque.motor_torque) one *= kMillinewton;
  }
  const auto judged = [&](const std::optional<Point>& answer, const msgs::RunLog& log, std::vector<std::string>& remarks) {
    std::vector<Record> unseen;
    unseen.push_back(make_record(log, "unseen", bench().admission));
    return judge_unseen(problem, problem.thresholds.whitening, bench().controller, parameters.point, answer, std::move(unseen), remarks);
  };
  std::vector<std::string> remarks;
  const std::vector<UnseenRecord> by_cause = judged(Point{{}, truth.effects, 0}, inching, remarks), by_parameters = judged({}, inching, remarks);
  EXPECT_TRUE(remarks.empty());
  ASSERT_EQ(by_cause.size(), 1U);
  EXPECT_EQ(by_cause[0].record, "unseen");
  EXPECT_TRUE(by_cause[0].validation.holds);
  EXPECT_LT(by_cause[0].validation.cause.residual_ratio, 1.2);  // of noise
  EXPECT_GT(by_cause[0].validation.parameters.residual_ratio, 2.0);
  EXPECT_LT(by_cause[0].cause_torque, by_cause[0].parameters_torque);
  // Where no known effect is the answer, parameters alone stand in its place, and nothing holds.
  ASSERT_EQ(by_parameters.size(), 1U);
  EXPECT_FALSE(by_parameters[0].validation.holds);
  EXPECT_EQ(by_parameters[0].validation.cause.residual_ratio, by_parameters[0].validation.parameters.residual_ratio);
  EXPECT_EQ(by_parameters[0].cause_torque, by_parameters[0].parameters_torque);
  EXPECT_TRUE(judged({}, slipped, remarks).empty());
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("unseen could not be predicted"), std::string::npos) << remarks[0];
}

}  // namespace
}  // namespace slewlab::diagnosis
