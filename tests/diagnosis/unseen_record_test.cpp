#include "diagnosis/unseen_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/fit.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// A dragging bearing, known from one record, predicts another; without it the nominal machine and its parameters do not. One whose torques are no such crane's is told, and left out.
TEST(UnseenRecord, IsPredictedByTheCauseThatActs) {
  constexpr double kOfAnotherCrane = 5.0;  // times what moves this one
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 34), "a", bench().admission));
  const FitResult parameters = fit_nuisances(problem, nominal_fit(problem));
  const msgs::RunLog inching = simulated_log(truth, bench().controller, kInching, kDuration, 35);
  msgs::RunLog foreign = inching;
  for (msgs::Torque& torque : foreign.torque) {
    for (double& one : torque.motor_torque) one *= kOfAnotherCrane;
  }
  const auto judged = [&](const Cause* lead, const msgs::RunLog& log, std::vector<std::string>& remarks) {
    std::vector<Record> unseen;
    unseen.push_back(make_record(log, "unseen", bench().admission));
    return judge_unseen(problem, problem.thresholds.whitening, bench().controller, parameters.point, lead, std::move(unseen), remarks);
  };
  std::vector<std::string> remarks;
  Cause lead;
  lead.effects = {"bearing_coulomb"};
  lead.point.effects = truth.effects;
  const std::vector<UnseenRecord> by_cause = judged(&lead, inching, remarks), by_parameters = judged(nullptr, inching, remarks);
  ASSERT_EQ(by_cause.size(), 1U);
  EXPECT_EQ(by_cause[0].record, "unseen");
  EXPECT_EQ(by_cause[0].cause, "bearing_coulomb");
  EXPECT_EQ(by_parameters[0].cause, "");
  EXPECT_TRUE(by_cause[0].validation.holds);
  EXPECT_LT(by_cause[0].validation.cause.residual_ratio, 1.2);  // of noise
  EXPECT_GT(by_cause[0].validation.parameters.residual_ratio, 2.0);
  EXPECT_LT(by_cause[0].cause_torque, by_cause[0].parameters_torque);
  // Where no known effect is the answer, parameters alone stand in its place, and nothing holds.
  ASSERT_EQ(by_parameters.size(), 1U);
  EXPECT_FALSE(by_parameters[0].validation.holds);
  EXPECT_EQ(by_parameters[0].validation.cause.residual_ratio, by_parameters[0].validation.parameters.residual_ratio);
  EXPECT_EQ(by_parameters[0].cause_torque, by_parameters[0].parameters_torque);
  const auto is_told = [&] { return std::any_of(remarks.begin(), remarks.end(), [](const std::string& remark) { return remark.find("unseen could not be predicted") != std::string::npos; }); };
  EXPECT_FALSE(is_told());
  EXPECT_TRUE(judged(nullptr, foreign, remarks).empty());
  EXPECT_TRUE(is_told());
}

}  // namespace
}  // namespace slewlab::diagnosis
