#include "diagnosis/unseen_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// A machine with dry friction in its bearing, known from one record.
struct DraggingBearing {
  explicit DraggingBearing(double torque) {
    truth.crane = bench().crane;
    truth.effects = {{"bearing_coulomb", {torque, 0.0, 3e-5}}};
    problem.add(make_record(log(kThereAndBack, 34), "a", bench().admission));
    parameters = fit_parameters_alone(problem, nominal_fit(problem));
  }
  msgs::RunLog log(const std::vector<Move>& moves, unsigned seed) const { return simulated_log(truth, bench().controller, moves, kDuration, seed); }
  UnseenRecords unseen(const msgs::RunLog& log, std::vector<std::string>& remarks) {
    std::vector<Record> records;
    records.push_back(make_record(log, "unseen", bench().admission));
    return {problem, problem.thresholds.whitening, bench().controller, parameters.point, std::move(records), remarks};
  }

  sim::MachineSettings truth;
  BenchProblem problem;
  FitResult parameters;
};

// A dragging bearing, known from one record, predicts another; without it the nominal machine and its parameters do not. One whose torques are no such crane's is told, and left out.
TEST(UnseenRecord, IsPredictedByTheCauseThatActs) {
  constexpr double kOfAnotherCrane = 5.0;  // times what moves this one
  DraggingBearing machine(1e5);
  const msgs::RunLog inching = machine.log(kInching, 35);
  msgs::RunLog foreign = inching;
  for (msgs::Torque& torque : foreign.torque) {
    for (double& one : torque.motor_torque) one *= kOfAnotherCrane;
  }
  const auto judged = [&](const Cause* lead, const msgs::RunLog& log, std::vector<std::string>& remarks) { return machine.unseen(log, remarks).judge(lead); };
  std::vector<std::string> remarks;
  Cause lead;
  lead.effects = {"bearing_coulomb"};
  lead.point.effects = machine.truth.effects;
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

// A cause that leaves noise alone of the fitted records, and of others half of what parameters alone leave, says what holds for the fitted ones; not one that leaves a fiftieth there, nor one that leaves as much of those.
TEST(UnseenRecord, LeadsAstrayWhereItLeavesMuchMoreThanOfTheFittedOnes) {
  Cause cause;
  UnseenRecord unseen;
  unseen.cause = "some";
  unseen.validation.parameters.residual_ratio = 80.0;
  const auto leads = [&](double fitted, double there) {
    cause.mean_square = fitted;
    unseen.validation.cause.residual_ratio = there;
    return leads_astray(cause, 180.0, unseen);
  };
  EXPECT_TRUE(leads(0.8, 40.0));
  EXPECT_FALSE(leads(0.8, 1.6));
  EXPECT_FALSE(leads(90.0, 40.0));
}

// Dry friction that a fast manoeuvre tells from viscous friction no better than another law may: where both explain nearly as much of it, and a slow one is predicted by dry friction alone, dry friction leads, and is not sure.
TEST(UnseenRecord, IsLedByTheCauseThatPredictsIt) {
  DraggingBearing machine(4e5);
  std::vector<std::string> remarks;
  UnseenRecords records = machine.unseen(machine.log(kInching, 35), remarks);
  remarks.clear();
  Cause viscous, dry;
  viscous.effects = {"bearing_viscous"};
  viscous.point.effects = {{"bearing_viscous", {8e6, 0.0}}};
  viscous.probability = 0.9;
  viscous.explained = 1.0;
  viscous.mean_square = 0.8;  // as if its law had one shape more
  dry.effects = {"bearing_coulomb"};
  dry.point.effects = machine.truth.effects;
  dry.explained = 0.98;
  dry.mean_square = 1.9;
  std::vector<Cause> causes{viscous, dry};
  double unknown = 0.1;
  std::vector<UnseenRecord> judged = records.judge(&causes.front());
  lead_by_what_is_unseen(records, machine.parameters.mean_square, causes, unknown, judged, remarks);
  EXPECT_EQ(causes.front().effects, dry.effects);
  EXPECT_NEAR(causes.front().probability, 0.54, 1e-12);
  EXPECT_NEAR(causes.back().probability, 0.36, 1e-12);
  EXPECT_EQ(unknown, 0.1);
  EXPECT_EQ(judged.front().cause, "bearing_coulomb");
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks.front().find("bearing_viscous leaves"), std::string::npos);
  // Where no other predicts it, nobody knows.
  causes = {viscous};
  judged = records.judge(&causes.front());
  lead_by_what_is_unseen(records, machine.parameters.mean_square, causes, unknown, judged, remarks);
  EXPECT_NEAR(causes.front().probability, 0.54, 1e-12);
  EXPECT_NEAR(unknown, 0.46, 1e-12);
  // The true one leads as it did.
  causes = {dry};
  judged = records.judge(&causes.front());
  lead_by_what_is_unseen(records, machine.parameters.mean_square, causes, unknown, judged, remarks);
  EXPECT_EQ(causes.front().probability, 0.0);
  EXPECT_EQ(remarks.size(), 2U);
}

}  // namespace
}  // namespace slewlab::diagnosis
