// Sizes and their deviations against what axes were given, and against how they scatter from record to record.
#include "diagnosis/balance/balance_sizes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

BalanceModel stated_of(const PreparedAxis& axis, const std::vector<std::string>& names) {
  const ValidatedChoice named = validate(axis.regression, axis.balance.laws, choice_of(axis.balance.laws, names));
  return to_model(axis.regression, axis.balance.laws, named, axis.regression.count / correlation_length(axis.regression, named));
}

// Noise alone scatters the inertia from draw to draw: no more than its deviation says, within a factor that thirty draws allow.
TEST(BalanceSizes, AnInertiaScattersNoMoreThanItsDeviationSays) {
  double sum = 0.0, square = 0.0, told = 0.0;
  constexpr int kDraws = 30;
  for (int draw = 0; draw < kDraws; ++draw) {
    const BalanceModel model = stated_of(prepared_axis({.resistance = [](double, double, double speed) { return 0.8 * speed; }, .noise = 1e-3, .seed = 100u + 2u * static_cast<unsigned>(draw)}), {"viscous"});
    sum += model.inertia / kDraws;
    square += model.inertia * model.inertia / kDraws;
    told += model.inertia_deviation / kDraws;
  }
  EXPECT_GT(told, 0.7 * std::sqrt(square - sum * sum));
  EXPECT_NEAR(sum, 2.0, 3.0 * told);
}

// Of dry friction alone what predicts has viscous friction and a constant torque as well, whatever pushes not.
TEST(BalanceSizes, DetailsAreTheOrdinaryLawsThatAreNotNamed) {
  const PreparedAxis axis = prepared_axis({.resistance = [](double t, double q, double v) { return usual_friction(t, q, v) + 0.05; }, .noise = 2e-6});
  const ValidatedChoice named = validate(axis.regression, axis.balance.laws, choice_of(axis.balance.laws, {"dry"}));
  const ValidatedChoice whole = with_details(axis.regression, axis.balance.laws, named);
  ASSERT_EQ(whole.choice.laws.size(), 3u);
  BalanceModel stated = stated_of(axis, {"dry"}), predicts = to_model(axis.regression, axis.balance.laws, whole, 100.0);
  take_details(stated, predicts);
  ASSERT_EQ(predicts.terms.size(), 1u);
  EXPECT_EQ(predicts.terms.front().law, "dry");
  ASSERT_EQ(predicts.details.size(), 2u);
  const double before = stated.terms.front().deviation[0], moved = predicts.terms.front().size[0] - stated.terms.front().size[0];
  widen(predicts, stated);
  EXPECT_DOUBLE_EQ(stated.terms.front().deviation[0], std::hypot(before, moved));
  EXPECT_EQ(stated.details.size(), 2u);
}

TEST(BalanceSizes, OfOtherRecordsAreTheirOwn) {
  const PreparedAxis one = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const PreparedAxis other = prepared_axis({.resistance = [](double t, double q, double v) { return 2.0 * usual_friction(t, q, v); }, .noise = 2e-6});
  const FittedSizes sizes = refitted(other.records, one.balance.laws, stated_of(one, {"dry", "viscous"}), 2.0, one.balance.resolved_speed);
  EXPECT_TRUE(sizes.is_physical);
  ASSERT_EQ(sizes.stated.terms.size(), 2u);
  EXPECT_NEAR(sizes.stated.terms[0].size[0], 2.4, 0.1);
  EXPECT_NEAR(sizes.stated.terms[1].size[0], 1.6, 0.1);
  EXPECT_NEAR(sizes.best.terms[0].size[0], 2.4, 0.1);
}

}  // namespace
}  // namespace slewlab::diagnosis
