#include "diagnosis/validate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/judged_grid.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// A cause is asked to predict the record that it did not see: the true one does, one that merely bends what it was fitted to does not.
TEST(HeldOutData, TellsWhatPredictsFromWhatDoesNot) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(34);
  truth.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 34), "a", bench().admission));
  problem.add(make_record(simulated_log(truth, bench().controller, kInching, kDuration, 35), "b", bench().admission));
  HeldOutData data(problem, problem.thresholds.whitening, HeldOutPart::last);
  const std::optional<controller::ControllerSettings> controller = bench().controller;
  const HeldOut none = data.fit({});
  EXPECT_EQ(none.record, "b");
  const ValidationError parameters = data.error(none, controller);
  Point right, wrong;
  right.effects = truth.effects;
  wrong.effects = {{"torque_lag", {0.02, 0.0}}};
  const ValidationError with_right = data.error(data.fit(right), controller), with_wrong = data.error(data.fit(wrong), controller);
  EXPECT_TRUE(is_better(with_right, parameters)) << with_right.residual_ratio << " " << parameters.residual_ratio;
  EXPECT_FALSE(is_better(parameters, with_right));
  EXPECT_FALSE(is_better(parameters, parameters));
  EXPECT_FALSE(is_better(with_wrong, with_right));
  ValidationError worse_loop = with_right;
  worse_loop.closed_loop = 2.0 * *parameters.closed_loop;
  EXPECT_FALSE(is_better(worse_loop, parameters)) << "a closed loop that gets worse";
}

// A record that is given to be predicted alone is judged as one of the fitted ones is when it is held out: the same numbers, by either way.
TEST(HeldOutData, ARecordWithoutPartIsJudgedAsOneHeldOut) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(34);
  truth.effects = {{"bearing_coulomb", {1e5, 0.0, 3e-5}}};
  const Record first = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 34), "a", bench().admission);
  const Record second = make_record(simulated_log(truth, bench().controller, kInching, kDuration, 35), "b", bench().admission);
  BenchProblem both, alone;
  const auto judged = [](const Record& record) { return on_judged_grid(record, bench().thresholds.whitening.highest_frequency); };
  both.add(judged(first));
  both.add(judged(second));
  alone.add(judged(first));
  std::vector<std::string> remarks;
  HeldOutData held(both, both.thresholds.whitening, HeldOutPart::last), unseen(alone, alone.thresholds.whitening, second, remarks);
  const std::optional<controller::ControllerSettings> controller = bench().controller;
  Point friction;
  friction.effects = truth.effects;
  const HeldOut none_held = held.fit({}), none_unseen = unseen.fit({}), right_unseen = unseen.fit(friction);
  EXPECT_EQ(none_unseen.record, "b");
  for (const auto& [one, other] : {std::pair(held.error(none_held, controller), unseen.error(none_unseen, controller)),
                                   std::pair(held.error(held.fit(friction), controller), unseen.error(right_unseen, controller))}) {
    EXPECT_NEAR(other.residual_ratio, one.residual_ratio, 1e-9 * one.residual_ratio);
    ASSERT_TRUE(one.closed_loop && other.closed_loop);
    EXPECT_NEAR(*other.closed_loop, *one.closed_loop, 1e-9 * *one.closed_loop);
  }
  EXPECT_LT(unseen.missing_torque(right_unseen), 0.5 * unseen.missing_torque(none_unseen)) << "beside the friction there is the encoders' noise";
}

// Messages late at random, and a bearing that sticks: the stochastic effect predicts the power of the record that it did not see where it is the truth,
// and better than a power that nobody knows; where friction is the truth it does not, though it explains what it fits.
TEST(HeldOutData, TellsAPowerThatPredictsFromOneThatOnlyExplains) {
  const auto validation_of_jitter = [](const common::EffectInstance& truth_effect) {
    sim::MachineSettings truth;
    truth.crane = spread_crane(36);
    truth.effects = {truth_effect};
    truth.seed = 98;
    BenchProblem problem;
    problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 36), "a", bench().admission));
    problem.add(make_record(simulated_log(truth, bench().controller, kInching, kDuration, 37), "b", bench().admission));
    HeldOutData data(problem, problem.thresholds.whitening, HeldOutPart::last);
    const std::optional<controller::ControllerSettings> controller = bench().controller;
    const HeldOut none = data.fit({});
    Point jitter;
    jitter.effects = {{"command_jitter", {0.027}}};
    const HeldOut fitted = data.fit(jitter);
    Validation validation{data.error({}, controller), data.error(none, controller), data.error(fitted, controller), {}, false};
    validation.unknown_cost = std::min(data.unknown_cost(none.point), data.unknown_cost(without_stochastic(problem.catalogue, fitted.point)));
    EXPECT_FALSE(validation.cause.closed_loop.has_value()) << "its closed loop is another draw's";
    EXPECT_EQ(fitted.point.effects.size(), 1u);
    return std::pair(validation, fitted.point.effects[0].values[0]);
  };
  const auto [of_jitter, size] = validation_of_jitter({"command_jitter", {0.03}});
  EXPECT_TRUE(holds(of_jitter)) << of_jitter.cause.cost << " against " << *of_jitter.unknown_cost;
  EXPECT_NEAR(size, 0.03, 0.3 * 0.03);  // the relative deviation of a size that is read off the power of few draws
  const auto [of_friction, unused] = validation_of_jitter({"bearing_coulomb", {1e5, 0.0, 3e-5}});
  EXPECT_FALSE(holds(of_friction)) << of_friction.cause.cost << " against " << *of_friction.unknown_cost;
}

// A record that takes its groups across the play has impacts that come or do not, according to parameters that lie within what the other record leaves open; between the two lies no
// slope that a descent could follow. The machine that both records were fitted to stands on the right side, at a distance that costs what it costs.
TEST(HeldOutData, FindsTheSideOfAnImpactOnWhichTheFitOfAllRecordsStands) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(14);
  truth.effects = {{"larger_play", {5e-4}}};
  BenchProblem problem;
  unsigned noise = 14;
  for (const auto& [name, moves] : {std::pair("a", kThereAndBack), std::pair("b", kAcrossThePlay)}) {
    const Record record = make_record(simulated_log(truth, bench().controller, moves, kDuration, noise++), name, bench().admission);
    problem.add(on_judged_grid(record, bench().thresholds.whitening.highest_frequency));
  }
  Point start;
  start.effects = truth.effects;
  start.nuisance.assign(nuisance_count(problem), 0.0);
  FitResult of_both = fit(problem, Eigen::MatrixXd::Zero(difference_count(problem), static_cast<Eigen::Index>(start.nuisance.size())), start);
  constexpr int kRounds = 4;
  settle(problem, of_both, kRounds);
  HeldOutData data(problem, problem.thresholds.whitening, HeldOutPart::last);
  HeldOut fitted = data.fit(of_both.point);
  ASSERT_TRUE(fitted.of_all);
  const ValidationError found = data.error(fitted, {});
  fitted.of_all.reset();
  EXPECT_LT(found.cost + 100.0, data.error(fitted, {}).cost) << "where only the first record's fit is known";
  EXPECT_LT(found.residual_ratio, 1.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
