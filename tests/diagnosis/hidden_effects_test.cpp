#include "diagnosis/hidden_effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slewlab::diagnosis {
namespace {

constexpr double kFar = 1e9;  // bounds behind which the prior has nothing

// A size of zero where the effect is absent, with a standard deviation of 2.
common::EffectParameter linear_size(double lower) {
  return {.name = "size", .unit = common::Unit::newton_metre, .per = common::ScaleOf::one, .meaning = "", .lower = lower, .upper = kFar, .typical = 4.0, .prior_scale = 2.0,
          .scale = common::ParameterScale::linear, .absent = 0.0};
}

// By the evidence itself: what makes a single effect with no residual as likely as nothing missing.
TEST(HiddenEffects, AnEffectIsToldFromWhereItIsAsLikelyAsNothingMissing) {
  const EvidenceSettings settings;
  for (const int effects : {1, 20, 50}) {
    const Probabilities p = weigh({{{}, told_from(effects, settings)}, {{"a"}, 0.0}}, effects, settings);
    EXPECT_NEAR(p.candidate[0], p.candidate[1], 1e-6) << effects;
  }
}

// Of Student's t with 2 degrees of freedom, in proportion to (1 + x^2 / 3)^(-3/2), the share 1 / sqrt(1 + 3 / x^2) lies below x: a half within one deviation.
TEST(HiddenEffects, TheShareIsThatOfTheSizesBelow) {
  constexpr double kToldFrom = 60.0, kShare = 0.3;
  for (const double lower : {0.0, -kFar}) {
    const common::EffectParameter size = linear_size(lower);
    for (const double deviations : {0.1, 1.0, 3.0}) {
      // The start tells as much as is needed at so many deviations.
      const double start = 4.0, square = kToldFrom / kShare * std::pow(start / (2.0 * deviations), 2);
      EXPECT_NEAR(share_hidden(size, start, square, kToldFrom, kShare), 1.0 / std::sqrt(1.0 + 3.0 / (deviations * deviations)), 1e-6) << deviations;
    }
    EXPECT_NEAR(share_hidden(size, 4.0, 0.0, kToldFrom, kShare), 1.0, 1e-6);  // changes nothing that is recorded
  }
}

// A limit is absent where it is endless: hidden are the large ones, here all above twice the one that was tried.
TEST(HiddenEffects, OfALimitTheLargeOnesAreHidden) {
  const common::EffectParameter size{.name = "limit", .unit = common::Unit::newton_metre, .per = common::ScaleOf::one, .meaning = "", .lower = 1.0 / kFar, .upper = kFar, .typical = 10.0,
                                     .prior_scale = 1.0, .scale = common::ParameterScale::logarithmic, .absent = std::numeric_limits<double>::infinity()};
  const double x = std::log(2.0);
  EXPECT_NEAR(share_hidden(size, 10.0, 60.0 / 0.3 * 4.0, 60.0, 0.3), 0.5 * (1.0 - x / std::sqrt(3.0 + x * x)), 1e-2);
}

TEST(HiddenEffects, TheOddsAreThePriorsWhereNothingShows) {
  common::EffectCatalogue catalogue;
  for (const char* name : {"a", "b"}) catalogue.effects.emplace_back().name = name;
  for (common::EffectAbout& about : catalogue.effects) about.parameters = {linear_size(0.0)};
  const EvidenceSettings settings;
  const auto odds = [&](double of_a, double of_b) {
    return hidden_effects(catalogue, std::vector<Screened>{{{"a", {4.0}}, {}, of_a}, {{"b", {4.0}}, {}, of_b}}, 2, settings);
  };
  EXPECT_NEAR(odds(0.0, 0.0).odds, (settings.prior_single + settings.prior_pair) / settings.prior_nothing, 1e-6);
  EXPECT_NEAR(odds(1e18, 1e18).odds, 0.0, 1e-6);
  const Hidden one = odds(1e18, 0.0);
  EXPECT_NEAR(one.odds, (0.5 * settings.prior_single + 0.25 * settings.prior_pair) / settings.prior_nothing, 1e-6);
  EXPECT_EQ(one.effects.front().first, "b");
  // A size whose machine could not be simulated is no size that was tried.
  EXPECT_EQ(odds(std::numeric_limits<double>::quiet_NaN(), 0.0).odds, hidden_effects(catalogue, std::vector<Screened>{{{"b", {4.0}}, {}, 0.0}}, 2, settings).odds);
}

}  // namespace
}  // namespace slewlab::diagnosis
