#include "diagnosis/problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kShaking = 16.0;  // times the gain of the speed

// Each share once, and never more at work than `threads`, also where a share shares out itself.
TEST(ShareOut, DoesEveryShareOnceOnAsManyThreadsAsAllowed) {
  for (const int threads : {1, 2, 3}) {
    Problem problem;
    problem.threads = threads;
    std::vector<std::atomic<int>> done(5 * 7);
    std::atomic<int> working{0}, most{0};
    share_out(problem, 5, [&](std::size_t outer) {
      share_out(problem, 7, [&](std::size_t inner) {
        const int now = ++working;
        int before = most;
        while (before < now && !most.compare_exchange_weak(before, now)) {
        }
        ++done[7 * outer + inner];
        std::this_thread::yield();
        --working;
      });
    });
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
    EXPECT_LE(most, threads);
    EXPECT_EQ(problem.helpers, 0);
  }
}

TEST(ShareOut, ThrowsAgainWhatAShareThrewAndBeginsNoOther) {
  Problem problem;
  int begun = 0;
  EXPECT_THROW(share_out(problem, 10,
                         [&](std::size_t i) {
                           ++begun;
                           if (i == 3) throw std::invalid_argument("the fourth");
                         }),
               std::invalid_argument);
  EXPECT_EQ(begun, 4);
  problem.threads = 2;
  EXPECT_THROW(share_out(problem, 10, [](std::size_t) { throw Interrupted{}; }), Interrupted);
  EXPECT_EQ(problem.helpers, 0);
}

// As fine as kBoomElements, finer where the crane file is, and a rigid boom stays one.
TEST(BoomElements, CutAFlexibleBoomFinelyEnough) {
  sim::MachineSettings nominal;
  for (const auto& [given, cut] : {std::pair(6, kBoomElements), std::pair(24, 24), std::pair(0, 0)}) {
    nominal.crane.boom.element_count = given;
    EXPECT_EQ(with_boom_elements(nominal, kBoomElements).crane.boom.element_count, cut);
  }
}

// A boom that buckles is a point to step back from. A point that names no effect, or an effect without its values, is an error of
// the program, which a fit that took it for a bad point would hide.
TEST(Differences, OnlyAMachineThatCannotBeBuiltCountsAsFarOff) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  BenchProblem problem;
  problem.add(make_record(simulated_log(sim::make_machine(truth), bench().controller, kThereAndBack, 12.0, 3), "log", bench().admission));
  problem.nominal.crane.boom.youngs_modulus *= 1e-3;  // whose Euler load is beyond 4 MN no more
  Point point;
  point.effects = {{"compression_softening", {4e6}}};
  EXPECT_GT(differences(problem, point).minCoeff(), 100.0);
  point.effects = {{"compression_softening", {}}};
  EXPECT_THROW(differences(problem, point), std::invalid_argument);
  point.effects = {{"no_such_effect", {1.0}}};
  EXPECT_THROW(differences(problem, point), std::invalid_argument);
}

// The columns of a fit are simulated side by side, whatever parameters and effects each machine has beside the others.
TEST(Differences, OfManyPointsAreThoseOfEachAlone) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  BenchProblem problem;
  for (const unsigned seed : {3u, 4u}) {
    problem.add(make_record(simulated_log(sim::make_machine(truth), bench().controller, kThereAndBack, 8.0, seed), "log", bench().admission));
  }
  std::vector<Point> points(11);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].nuisance.assign(nuisance_count(problem), 0.0);
    points[i].nuisance[i] = 1.0;
  }
  points[2].effects = {common::typical_instance(problem.catalogue.at("torque_lag"))};
  points[5].effects = {common::typical_instance(problem.catalogue.at("wind"))};
  points[7].effects = {common::typical_instance(problem.catalogue.at("house_inertia"))};
  points[9].effects = {common::typical_instance(problem.catalogue.at("hoisting"))};
  const std::vector<Eigen::VectorXd> together = differences(problem, points);
  ASSERT_EQ(together.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(together[i], differences(problem, points[i])) << i;
}

// Led by gains that shake it more at every step, a machine's motion grows by hundreds of orders of magnitude and is a number all the same. It counts as very far off, as one does whose motion
// is no number, and no difference quotient beside it is more than what that leaves.
TEST(Differences, OfAMachineThatIsNotStableAreVeryFarOff) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  BenchProblem problem;
  problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 3), "a", bench().admission));
  const Point nominal{std::vector<double>(nuisance_count(problem), 0.0), {}};
  EXPECT_LT(differences(problem, nominal).cwiseAbs().maxCoeff(), 100.0);
  problem.gains.speed *= kShaking;
  const Shadow shaken = shadow_at(problem, nominal, 0);
  double largest = 0.0;
  for (const double torque : shaken.missing_torque[0]) largest = std::max(largest, std::fabs(torque));
  EXPECT_TRUE(std::isfinite(largest));
  EXPECT_GT(largest, 1e30) << "[Nm]; else nothing is shown";
  const Eigen::VectorXd far = differences(problem, nominal);
  EXPECT_EQ(far, Eigen::VectorXd::Constant(far.size(), far(0)));
  EXPECT_LT(far(0), 1e4);
}

}  // namespace
}  // namespace slewlab::diagnosis
