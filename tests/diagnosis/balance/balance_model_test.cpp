// A model in words, and its residual on a record that was made by it.
#include "diagnosis/balance/balance_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

BalanceTerm term(const std::string& law, const std::string& words, std::vector<double> size) { return {law, words, LawFamily::friction, 0.0, true, std::move(size), {}, 0.0}; }

TEST(BalanceModel, NamesItsTermsAndNotItsDetails) {
  BalanceModel model;
  EXPECT_EQ(model.words(), "the inertia alone");
  model.details = {term("offset", "constant torque", {0.1})};
  EXPECT_EQ(model.words(), "the inertia alone");
  model.terms = {term("dry", "dry friction", {1.0})};
  EXPECT_EQ(model.words(), "dry friction");
  model.terms.push_back(term("viscous", "viscous friction", {1.0, 0.0}));
  EXPECT_EQ(model.words(), "dry friction and viscous friction");
  model.terms.push_back(term("gravity", "gravity on a tilted axis", {1.0, 0.0}));
  EXPECT_EQ(model.words(), "dry friction, viscous friction and gravity on a tilted axis");
  ASSERT_EQ(model.acting().size(), 4u);
  EXPECT_EQ(model.acting().back().law, "offset");
}

TEST(BalanceModel, TheModelThatMadeARecordLeavesNothingOfIt) {
  const SimulatedAxis axis{.resistance = [](double, double, double speed) { return 0.8 * speed + 0.5; }};
  const std::vector<AxisRecord> records = two_records(axis);
  const Balance balance = balance_of(records, axis.inertia, 8.0, true);
  BalanceModel model;
  model.inertia = axis.inertia;
  model.terms = {term("viscous", "", {0.8, 0.0})};
  model.details = {term("offset", "", {0.5})};
  for (const BalanceRecord& record : smoothed(records, balance)) {
    const std::vector<double> residual = balance_residual(record, balance.laws, model, balance.resolved_speed);
    ASSERT_EQ(residual.size(), moving_samples(record, balance.resolved_speed).size());
    for (const double one : residual) EXPECT_NEAR(one, 0.0, 0.06) << "[Nm] of 10: the torque is held over a sample of the record, and not in the integration";
  }
}

// White noise of the efforts under the filter goes together over no more than the filter; a sine does for ever, a share sqrt(1 - chance) of its RMS.
TEST(BalanceModel, WhatGoesTogetherIsNoNoise) {
  AxisRecord record{"", 0.01, {}, {}};
  std::mt19937_64 generator(9);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int n = 0; n < 8000; ++n) {
    record.position.push_back(0.01 * n);
    record.effort.push_back(noise(generator));
  }
  BalanceModel none;
  const BalanceRecord white = make_balance_record(record, 4);
  EXPECT_LT(correlated_rms(white, {}, none, 0.1), 0.1);
  for (std::size_t n = 0; n < record.effort.size(); ++n) record.effort[n] += std::sqrt(2.0) * std::sin(0.01 * static_cast<double>(n));
  EXPECT_NEAR(correlated_rms(make_balance_record(record, 4), {}, none, 0.1), 1.0, 0.1);
}

TEST(BalanceModel, ALawThatIsNotThereIsRefused) {
  const std::vector<BalanceLaw> laws = balance_laws({1.0, 1e-3, 20.0, 0.0, 0.0, true, {}});
  EXPECT_EQ(&shape_of(laws, term("dry", "", {})), laws.front().shapes.data());
  EXPECT_THROW(shape_of(laws, term("magic", "", {})), std::invalid_argument);
  BalanceTerm bent = term("stribeck", "", {});
  bent.shape = 123.0;
  EXPECT_THROW(shape_of(laws, bent), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
