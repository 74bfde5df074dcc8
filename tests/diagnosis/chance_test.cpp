// The truth is drawn: differences of unit noise plus a power of known shape and size.
#include "diagnosis/chance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <random>
#include <vector>

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kBins = 4000;

std::unique_ptr<Problem> one_channel() {
  auto problem = std::make_unique<Problem>();
  Whitening whitening;
  whitening.first_bin = 10;
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
TEST(Chance, FindsThePowerOfADraw) {
  const Eigen::VectorXd power = shape();
  const Eigen::VectorXd difference = drawn((1.0 + 3.0 * power.array()).matrix(), 1);
  const ChanceFit fit = fit_chance(*one_channel(), difference, {power, {}});
  EXPECT_NEAR(fit.scale, 3.0, 0.08 * 3.0);
  const Eigen::ArrayXd variance = 1.0 + fit.scale * power.array();
  EXPECT_NEAR(fit.cost, (variance.log() + difference.array().square() / variance).sum(), 1e-9 * fit.cost);
}

TEST(Chance, FindsNothingInNoise) {
  const Eigen::VectorXd noise = drawn(Eigen::VectorXd::Ones(2 * kBins), 2);
  const ChanceFit fit = fit_chance(*one_channel(), noise, {shape(), {}});
  EXPECT_GT(fit.cost, noise.squaredNorm() - 10.0);
}

// The profile of one draw's change, smoothed, is the power that it was drawn from: 2 * 13 squares at the lowest
// frequencies, so 28 % there; on the average much less.
TEST(Chance, ProfileIsTheSmoothedPower) {
  const Eigen::VectorXd power = shape();
  const std::vector<Eigen::VectorXd> changes{drawn(power, 3)};
  const Eigen::VectorXd profile = power_profile(*one_channel(), changes).power;
  const Eigen::ArrayXd ratio = profile.array() / power.array();
  EXPECT_NEAR(ratio.mean(), 1.0, 0.1);
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 1.2);
}

// What has the profile's power comes near the free one; a few lines at one place do not.
TEST(Chance, IsTakenOnlyForItsOwnPower) {
  const auto problem = one_channel();
  const Eigen::VectorXd power = shape();
  const Eigen::VectorXd same = drawn((1.0 + 3.0 * power.array()).matrix(), 4);
  EXPECT_TRUE(is_near_free_power(fit_chance(*problem, same, {power, {}}), free_power(*problem, same), same.size(), false));
  Eigen::VectorXd lines = drawn(Eigen::VectorXd::Ones(2 * kBins), 5);
  lines.segment(3000, 200) *= 50.0;
  EXPECT_FALSE(is_near_free_power(fit_chance(*problem, lines, {power, {}}), free_power(*problem, lines), lines.size(), false));
}

// A force of power 400 that three sensors see, each in its own way at each frequency, beside their noise.
class Force : public testing::Test {
 protected:
  static constexpr std::size_t kForceBins = 600, kSensors = 3;
  Force() {
    Whitening whitening;
    whitening.first_bin = 10;
    whitening.bin_count = kForceBins;
    for (std::size_t c = 0; c < kSensors; ++c) {
      whitening.channels.push_back({false, static_cast<int>(c)});
      whitening.weight.push_back(Eigen::VectorXd::Ones(kForceBins));
    }
    problem_.whitening.push_back(whitening);
    way_ = drawn(Eigen::VectorXd::Ones(2 * kForceBins * kSensors), 6);
    constexpr auto kStride = static_cast<Eigen::Index>(2 * kForceBins);
    for (Eigen::Index b = 0; b < kStride; b += 2) {
      double square = 0.0;
      for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(kSensors); ++c) square += way_.segment<2>(c * kStride + b).squaredNorm();
      for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(kSensors); ++c) way_.segment<2>(c * kStride + b) /= std::sqrt(square);
    }
  }
  // h F at each frequency.
  Eigen::VectorXd seen(unsigned seed, double power) const {
    const Eigen::VectorXd force = drawn(Eigen::VectorXd::Constant(2 * kForceBins, power), seed);
    Eigen::VectorXd values(way_.size());
    for (Eigen::Index b = 0; b < static_cast<Eigen::Index>(kForceBins); ++b) {
      for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(kSensors); ++c) {
        const Eigen::Index row = 2 * (c * static_cast<Eigen::Index>(kForceBins) + b);
        const std::complex<double> value = std::complex<double>(way_(row), way_(row + 1)) * std::complex<double>(force(2 * b), force(2 * b + 1));
        values(row) = value.real();
        values(row + 1) = value.imag();
      }
    }
    return values;
  }
  Problem problem_;
  Eigen::VectorXd way_;
};

TEST_F(Force, IsFoundAlongItsDirection) {
  const std::vector<Eigen::VectorXd> draws{seen(1, 1.0), seen(2, 1.0), seen(3, 1.0), seen(4, 1.0)};
  const ChanceProfile profile = force_profile(problem_, draws);
  // Beside the direction stand the noise and the 2 % of the power that a force is allowed there (chance.h).
  const Eigen::VectorXd difference = seen(9, 400.0) + drawn(Eigen::VectorXd::Constant(way_.size(), 1.0 + 0.02 * 400.0), 10);
  const ChanceFit fit = fit_chance(problem_, difference, profile);
  // 1200 squares along and 2400 beside tell the scale within 2.4 %, the power of four draws is known as well: five times both.
  EXPECT_NEAR(fit.scale, 400.0, 0.17 * 400.0);
  // Divided by what the force adds, only the noise is left, and the cost is that of the divided differences.
  const Chance chance{profile, fit.scale};
  const Eigen::VectorXd left = divided(problem_, chance, difference);
  EXPECT_NEAR(left.squaredNorm() + logarithms(problem_, chance), fit.cost, 1e-9 * fit.cost);
  EXPECT_NEAR(left.squaredNorm() / static_cast<double>(left.size()), 1.0, 0.12);
  EXPECT_GT(difference.squaredNorm() / static_cast<double>(left.size()), 100.0);
}

// The same power without the one direction, as jitter's has none, costs more than it does as power of each sensor.
TEST_F(Force, IsNotWhatHasNoDirection) {
  const std::vector<Eigen::VectorXd> draws{seen(1, 1.0), seen(2, 1.0), seen(3, 1.0), seen(4, 1.0)};
  const Eigen::VectorXd difference = drawn(Eigen::VectorXd::Constant(way_.size(), 400.0), 11);
  EXPECT_GT(fit_chance(problem_, difference, force_profile(problem_, draws)).cost,
            fit_chance(problem_, difference, power_profile(problem_, draws)).cost + 1000.0);
}

// By the effects' own laws: delays' torque errors go with the spread, so power with its square; a share lost twice as often
// gives twice the power.
TEST(Chance, SizesFollowThePower) {
  EXPECT_NEAR(with_power({"command_jitter", {0.01}}, 4.0).values[0], 0.02, 1e-12);
  EXPECT_NEAR(with_power({"command_loss", {0.1, 1.0}}, 4.0).values[0], 0.4, 1e-12);
  EXPECT_TRUE(comes_by_chance("command_loss"));
  EXPECT_TRUE(is_one_force("gusts"));
  EXPECT_FALSE(comes_by_chance("command_delay"));
  EXPECT_TRUE(is_mean_of_chance("command_delay"));
  EXPECT_FALSE(is_mean_of_chance("command_loss"));
}

}  // namespace
}  // namespace slewlab::diagnosis
