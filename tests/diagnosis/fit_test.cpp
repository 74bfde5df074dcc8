#include "diagnosis/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

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

// A factor is judged by how far it is from 1, where the effect is absent: an unchanged inertia costs nothing, and factors
// of e^0.5 and e^-0.5 as much as each other. Where absent is infinite, by how far it is from its typical size.
TEST(Coordinates, OfALogarithmicParameterAreZeroWhereTheEffectIsAbsent) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters);
  const common::EffectParameter& factor = catalogue.at("house_inertia").parameters[common::kSize];
  EXPECT_EQ(to_coordinate(factor, 1.0), 0.0);
  EXPECT_EQ(value_at(factor, 0.0), 1.0);
  EXPECT_NEAR(to_coordinate(factor, std::exp(0.5)), 1.0, 1e-12);  // its prior's width is 0.5
  EXPECT_NEAR(to_coordinate(factor, std::exp(-0.5)), -1.0, 1e-12);
  EXPECT_NEAR(value_at(factor, to_coordinate(factor, 2.5)), 2.5, 1e-12);
  const common::EffectParameter& limit = catalogue.at("torque_limit").parameters[common::kSize];
  EXPECT_EQ(to_coordinate(limit, limit.typical), 0.0);
  for (const common::EffectAbout& about : catalogue.effects) {
    for (const common::EffectParameter& parameter : about.parameters) {
      if (!parameter.absent || !std::isfinite(*parameter.absent)) continue;
      EXPECT_EQ(to_coordinate(parameter, *parameter.absent), 0.0) << about.name << " " << parameter.name;
    }
  }
}

// Limits of L(c) = nu ln(1 + c / nu): c where it is small, ratios count where it is large, and no discount below 0.
TEST(Discount, HasItsLimits) {
  EXPECT_NEAR(discounted(0.01, 100.0), 0.01, 1e-6);
  EXPECT_EQ(discounted(-50.0, 100.0), -50.0);
  EXPECT_NEAR(discounted(2e9, 100.0) - discounted(1e9, 100.0), 100.0 * std::log(2.0), 1e-4);
}

TEST(Discount, WeightIsItsSlope) {
  for (const double c : {-3.0, 1.0, 80.0, 5000.0}) {
    const double h = 1e-4 * std::fabs(c);
    EXPECT_NEAR(discounted_weight(c, 100.0), (discounted(c + h, 100.0) - discounted(c - h, 100.0)) / (2.0 * h), 1e-6) << c;
  }
}

TEST(Excess, IsWhatStandsAboveTheNoise) {
  FitSettings settings;
  settings.independent_share = 0.5;
  EXPECT_NEAR(excess(Eigen::VectorXd::Constant(10, 2.0), settings), 0.5 * (40.0 - 10.0), 1e-12);
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

// One nuisance (the first) moves one difference; the fit stands at z = 3, far beyond the bound at 2, where nothing is left.
class Relaxation : public testing::Test {
 protected:
  // 100 ln(1 + c / usual).
  static MisfitCost misfit_cost(double usual) {
    EvidenceSettings settings;
    settings.law_freedom = 100.0;
    settings.law_share = 1.0;
    settings.near_freedom = 0.0;
    return {settings, usual - 100.0};
  }
  Relaxation() {
    problem_.nuisances.parameters.resize(16);  // with bounds, and the latency behind them
    result_.point.nuisance.assign(17, 0.0);
    result_.point.nuisance[0] = 3.0;
    result_.difference = Eigen::VectorXd::Zero(40);
    result_.columns = Eigen::MatrixXd::Zero(40, 17);
    result_.columns(0, 0) = 10.0;
    result_.excess = 0.0;
    result_.prior = 9.0 + 30.0;  // z^2 and beyond the bound 30 (z - 2)^2, nuisance.h
  }
  Problem problem_;
  FitResult result_;
};

// Limits: where misfits cost nothing the parameter goes back to 0 and leaves s (10 * 3)^2; where they cost all it stays.
TEST_F(Relaxation, TradesMisfitForLikelyValues) {
  const Relaxed discounted = relax(problem_, result_, misfit_cost(1e12), 0.0);
  EXPECT_NEAR(discounted.prior, 0.0, 1e-6);
  EXPECT_NEAR(discounted.excess, problem_.settings.independent_share * 900.0, 1e-3);
  const Relaxed charged = relax(problem_, result_, misfit_cost(1e-3), 0.0);
  EXPECT_NEAR(charged.prior, result_.prior, 0.05);
  EXPECT_NEAR(charged.excess, 0.0, 1e-3);
}

// A cost that does not go with where the parameters stand stays wherever they go.
TEST_F(Relaxation, KeepsWhatIsChargedBesides) {
  result_.prior += 25.0;
  EXPECT_NEAR(relax(problem_, result_, misfit_cost(1e12), 0.0).prior, 25.0, 1e-6);
}

// The minimum of 100 ln(1 + 0.3 (10 (z - 3))^2 / 1000) + z^2 + 30 max(0, z - 2)^2, by search over z.
TEST_F(Relaxation, FindsTheLeastOfBoth) {
  double least = 1e300, prior = 0.0;
  for (double z = 0.0; z < 3.0; z += 1e-4) {
    const double p = z * z + 30.0 * std::pow(std::max(0.0, z - 2.0), 2.0);
    const double cost = 100.0 * std::log1p(0.3 * 100.0 * (z - 3.0) * (z - 3.0) / 1000.0) + p;
    if (cost >= least) continue;
    least = cost;
    prior = p;
  }
  const Relaxed relaxed = relax(problem_, result_, misfit_cost(1000.0), 0.0);
  EXPECT_NEAR(100.0 * std::log1p(relaxed.excess / 1000.0) + relaxed.prior, least, 0.02);
  EXPECT_NEAR(relaxed.prior, prior, 0.3);
}

// Columns that promise less than the fit has reached are not believed: they are those of a fit that has not settled.
TEST_F(Relaxation, PromisesNothingThatWasNotReached) {
  result_.difference(0) = 30.0;
  result_.excess = 500.0;
  EXPECT_GE(relax(problem_, result_, misfit_cost(1e-3), 0.0).excess, 500.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
