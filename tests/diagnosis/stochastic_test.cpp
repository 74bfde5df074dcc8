// The truth is drawn: differences of unit noise plus a power of known shape and size.
#include "diagnosis/stochastic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <random>
#include <vector>

#include "sim/effects/catalogue.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kBins = 4000;

std::unique_ptr<Problem> one_channel() {
  auto problem = std::make_unique<Problem>();
  Whitening whitening;
  whitening.first_bin = 10;
  whitening.bin_width = 0.05;  // [Hz]
  whitening.bin_count = kBins;
  whitening.channels.push_back({true, 0});
  whitening.weight.push_back(Eigen::VectorXd::Ones(kBins));
  problem->whitening.push_back(whitening);
  return problem;
}

// A power that falls with frequency from 100 to 1.
Eigen::VectorXd shape() {
  Eigen::VectorXd power(2 * kBins);
  for (Eigen::Index i = 0; i < power.size(); ++i) {
    power(i) = 100.0 * std::pow(0.01, static_cast<double>(i) / static_cast<double>(power.size()));
  }
  return power;
}

Eigen::VectorXd drawn(const Eigen::VectorXd& variance, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd values(variance.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = std::sqrt(variance(i)) * normal(generator);
  return values;
}

// 8000 squares of normal numbers tell their scale within sqrt(2 / 8000) = 1.6 %; five times that is allowed.
TEST(Stochastic, FindsThePowerOfADraw) {
  const Eigen::VectorXd power = shape();
  const Eigen::VectorXd difference = drawn((1.0 + 3.0 * power.array()).matrix(), 1);
  const PowerFit fit = fit_power(difference, {power});
  EXPECT_NEAR(fit.scale, 3.0, 0.08 * 3.0);
  const Eigen::ArrayXd variance = 1.0 + fit.scale * power.array();
  EXPECT_NEAR(fit.cost, (variance.log() + difference.array().square() / variance).sum(), 1e-9 * fit.cost);
}

TEST(Stochastic, FindsNothingInNoise) {
  const Eigen::VectorXd noise = drawn(Eigen::VectorXd::Ones(2 * kBins), 2);
  const PowerFit fit = fit_power(noise, {shape()});
  EXPECT_GT(fit.cost, noise.squaredNorm() - 10.0);
}

// The profile of one draw's change, smoothed, is the power that it was drawn from: 2 * 13 squares at the lowest
// frequencies, so 28 % there; on the average much less.
TEST(Stochastic, ProfileIsTheSmoothedPower) {
  const Eigen::VectorXd power = shape();
  const std::vector<Eigen::VectorXd> changes{drawn(power, 3)};
  const Eigen::VectorXd profile = power_of(*one_channel(), changes).profile;
  const Eigen::ArrayXd ratio = profile.array() / power.array();
  EXPECT_NEAR(ratio.mean(), 1.0, 0.1);
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 1.2);
}

// What has the profile's power comes near the free one; a few lines at one place do not.
TEST(Stochastic, IsTakenOnlyForItsOwnPower) {
  const auto problem = one_channel();
  const Eigen::VectorXd power = shape();
  const Eigen::VectorXd same = drawn((1.0 + 3.0 * power.array()).matrix(), 4);
  EXPECT_LT(above_free_power(fit_power(same, {power}), free_power(*problem, same), same.size()), kNearFreePower);
  Eigen::VectorXd lines = drawn(Eigen::VectorXd::Ones(2 * kBins), 5);
  lines.segment(3000, 200) *= 50.0;
  EXPECT_GE(above_free_power(fit_power(lines, {power}), free_power(*problem, lines), lines.size()), kNearFreePower);
}

// Divided by what the effect adds, draws are noise again, and the cost is that of the divided differences.
TEST(Stochastic, DividedDifferencesAreNoise) {
  const Eigen::VectorXd difference = drawn((1.0 + 3.0 * shape().array()).matrix(), 7);
  const PowerFit fit = fit_power(difference, {shape()});
  const AddedPower added{{shape()}, fit.scale};
  const Eigen::VectorXd left = divided(added, difference);
  EXPECT_NEAR(left.squaredNorm() + logarithms(added), fit.cost, 1e-9 * fit.cost);
  EXPECT_NEAR(left.squaredNorm() / static_cast<double>(left.size()), 1.0, 0.05);  // 8000 squares: 1.6 %, three times that
}

// One force in two channels: in the second it shows twice as strong and 0.5 rad later, at every frequency.
class OneForce : public testing::Test {
 protected:
  static std::unique_ptr<Problem> two_channels() {
    std::unique_ptr<Problem> problem = one_channel();
    Whitening& whitening = problem->whitening[0];
    whitening.channels.push_back({true, 1});
    whitening.weight.push_back(whitening.weight[0]);
    return problem;
  }
  // What a draw adds, `angle` later in the second channel.
  static Eigen::VectorXd change(unsigned seed, double angle) {
    const Eigen::VectorXd first = drawn(shape(), seed);
    Eigen::VectorXd both(2 * first.size());
    for (Eigen::Index i = 0; i < first.size(); i += 2) {
      const std::complex<double> second = 2.0 * std::polar(1.0, angle) * std::complex<double>(first(i), first(i + 1));
      both.segment<2>(i) = first.segment<2>(i);
      both.segment<2>(first.size() + i) << second.real(), second.imag();
    }
    return both;
  }
  // Two forces of one power, each in a channel of its own.
  static Eigen::VectorXd two_forces(unsigned seed) {
    Eigen::VectorXd both(4 * kBins);
    both << drawn(shape(), seed), drawn(shape(), seed + 100);
    return both;
  }
  // The residual of another draw, of a force 1.5 times as strong, with unit noise.
  static Eigen::VectorXd left(double angle) {
    return 1.5 * change(11, angle) + drawn(Eigen::VectorXd::Ones(4 * kBins), 12);
  }
  const std::unique_ptr<Problem> problem_ = two_channels();
  const std::vector<Eigen::VectorXd> draw_{change(10, 0.5)};
  const Power power_ = power_of(*problem_, draw_);
};

// They have no axis of their own: whatever axes one draw seems to have, along each of them another one has the same power.
TEST_F(OneForce, AxesOfADrawHaveNotItsOwnPower) {
  const auto problem = two_channels();
  const std::vector<Eigen::VectorXd> changes{two_forces(21)};
  const Eigen::VectorXd profile = power_of(*problem, changes).profile;
  EXPECT_NEAR(profile.head(2 * kBins).mean() / profile.tail(2 * kBins).mean(), 1.0, 0.1);  // 4000 powers in each: 1.6 %, and shape()'s few largest weigh most
}

TEST_F(OneForce, IsTurnedIntoOneAxisAndBack) {
  const Eigen::VectorXd along = along_axes(power_.records, draw_[0]);
  EXPECT_NEAR(along.head(2 * kBins).squaredNorm(), 0.0, 1e-9 * along.squaredNorm());
  EXPECT_NEAR(along.squaredNorm(), draw_[0].squaredNorm(), 1e-9 * along.squaredNorm());
  const AddedPower added{power_, 2.0};
  EXPECT_LT((undivided(added, divided(added, draw_[0])) - draw_[0]).norm(), 1e-9 * draw_[0].norm());
}

// 8000 squares along the force's axis and as many across tell their variance within 1.6 %; five times that is allowed.
TEST_F(OneForce, IsExplainedAlongItsAxisOnly) {
  const Eigen::VectorXd difference = left(0.5);
  const PowerFit fit = fit_power(difference, power_);
  EXPECT_NEAR(fit.scale, 1.5 * 1.5, 0.08 * 1.5 * 1.5);
  const Eigen::VectorXd noise = divided({power_, fit.scale}, difference);
  EXPECT_NEAR(noise.squaredNorm() + logarithms({power_, fit.scale}), fit.cost, 1e-9 * fit.cost);
  EXPECT_NEAR(noise.squaredNorm() / static_cast<double>(noise.size()), 1.0, 0.08);
  // Free powers know nothing of the proportion.
  EXPECT_LT(above_free_power(fit, free_power(*problem_, difference), difference.size()), -0.2);
}

TEST_F(OneForce, IsNotTakenForAForceInOtherProportions) {
  const Eigen::VectorXd difference = left(-0.5);
  const PowerFit fit = fit_power(difference, power_);
  EXPECT_GT(above_free_power(fit, free_power(*problem_, difference), difference.size()), kNearFreePower);
}

// A power learned from one draw predicts another better than none does, and along the force's axis better than in each channel alone, which
// knows nothing of the proportion; but not as well as the power's own law does, which knows its shape within a third of an octave.
TEST_F(OneForce, UnknownPowerIsLearnedWhereItActs) {
  const Eigen::VectorXd seen = left(0.5);
  const Eigen::VectorXd unseen = 1.5 * change(21, 0.5) + drawn(Eigen::VectorXd::Ones(4 * kBins), 22);
  const Power plain = unknown_power(*problem_, {}, seen, *problem_, {});
  const Power along = unknown_power(*problem_, power_.records, seen, *problem_, power_.records);
  constexpr double kDeviation = 0.5;
  const double none = unseen.squaredNorm(), of_plain = predictive_cost(unseen, plain, kDeviation), of_along = predictive_cost(unseen, along, kDeviation);
  EXPECT_LT(of_plain, none);
  EXPECT_LT(of_along, of_plain);
  EXPECT_GT(of_along, fit_power(unseen, power_).cost);
}

// A scale that is known from elsewhere may be another one here, at the cost of its deviations.
TEST_F(OneForce, PredictedScaleIsPaidFor) {
  const Eigen::VectorXd difference = left(0.5);
  const PowerFit free = fit_power(difference, power_);
  const double off = std::log(free.scale), deviation = off / 2.0;
  EXPECT_NEAR(predictive_cost(difference, power_, deviation), free.cost + 4.0, 0.5);
  EXPECT_GE(power_at(difference, power_, 1.0).cost, free.cost);
  EXPECT_NEAR(power_at(difference, power_, free.scale).cost, free.cost, 1e-9 * std::fabs(free.cost));
}

// By the effects' own laws: delays' torque errors go with the spread, so power with its square; a share lost twice as often
// gives twice the power.
TEST(Stochastic, SizesFollowThePower) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::thesis_crane());
  EXPECT_NEAR(with_power(catalogue.at("command_jitter"), {"command_jitter", {0.01}}, 4.0).values[0], 0.02, 1e-12);
  EXPECT_NEAR(with_power(catalogue.at("command_loss"), {"command_loss", {0.1, 1.0}}, 4.0).values[0], 0.4, 1e-12);
  EXPECT_NEAR(with_power(catalogue.at("gusts"), {"gusts", {4.0, 12.0, 1.0, 5.0, 80.0, 20.0}}, 4.0).values[0], 8.0, 1e-12);
  // Up to its bound of 0.99.
  EXPECT_NEAR(largest_scale(catalogue.at("command_loss"), {"command_loss", {0.33, 1.0}}), 3.0, 1e-12);
  EXPECT_TRUE(is_stochastic(catalogue.at("command_loss")));
  EXPECT_TRUE(is_stochastic(catalogue.at("gusts")));
  EXPECT_TRUE(is_stochastic_delay(catalogue.at("command_loss")));
  EXPECT_FALSE(is_stochastic_delay(catalogue.at("gusts")));
  EXPECT_FALSE(is_stochastic(catalogue.at("command_delay")));
  EXPECT_TRUE(is_steady_delay(catalogue.at("command_delay")));
  EXPECT_FALSE(is_steady_delay(catalogue.at("command_loss")));
}

}  // namespace
}  // namespace slewlab::diagnosis
