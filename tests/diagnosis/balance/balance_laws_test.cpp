// The laws against their formulae, and which of them an axis can have.
#include "diagnosis/balance/balance_laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slewlab::diagnosis {
namespace {

constexpr BalanceScales kRotary{.top_speed = 4.0, .resolved_speed = 0.01, .duration = 50.0, .middle_position = 1.0, .half_range = 2.0, .lateness = {}};

const BalanceLaw* law_of(const std::vector<BalanceLaw>& laws, const std::string& name) {
  const auto found = std::find_if(laws.begin(), laws.end(), [&](const BalanceLaw& law) { return law.name == name; });
  return found == laws.end() ? nullptr : &*found;
}

TEST(BalanceLaws, AreTheirFormulae) {
  const std::vector<BalanceLaw> laws = balance_laws(kRotary);
  const LawMoment moment{.time = 5.0, .position = 2.0, .speed = -0.7};
  const auto value = [&](const std::string& name, std::size_t shape = 0, std::size_t column = 0) { return law_of(laws, name)->shapes.at(shape).columns.at(column)(moment); };
  EXPECT_NEAR(value("dry"), -1.0, 1e-12);
  EXPECT_DOUBLE_EQ(value("viscous"), -0.7);
  EXPECT_DOUBLE_EQ(value("viscous", 0, 1), 0.7);
  EXPECT_DOUBLE_EQ(value("offset"), 1.0);
  EXPECT_DOUBLE_EQ(value("quadratic"), -0.7 * 0.7 / 4.0);
  EXPECT_DOUBLE_EQ(value("gravity"), std::sin(2.0));
  EXPECT_DOUBLE_EQ(value("gravity", 0, 1), std::cos(2.0));
  EXPECT_DOUBLE_EQ(value("spring"), 0.5);
  EXPECT_NEAR(value("warming"), -std::exp(-5.0 / (0.1 * 50.0)), 1e-12);
  const double slow = law_of(laws, "stribeck")->shapes.back().shape;
  EXPECT_NEAR(value("stribeck", law_of(laws, "stribeck")->shapes.size() - 1), -std::exp(-(0.7 / slow) * (0.7 / slow)), 1e-12);
  EXPECT_NEAR(value("rising", law_of(laws, "rising")->shapes.size() - 1), -(1.0 - std::exp(-0.7 / slow)), 1e-12);
}

// A measured speed near rest has no side; one that is exact has.
TEST(BalanceLaws, DryFrictionHasASideWhereTheSpeedHasOne) {
  const auto dry = law_of(balance_laws(kRotary), "dry")->shapes.front().columns.front();
  EXPECT_NEAR(dry({.speed = 0.001}), 0.1, 0.01);
  EXPECT_EQ(dry({.speed = 0.001, .is_exact = true}), 1.0);
  EXPECT_EQ(dry({.speed = 0.0, .is_exact = true}), 0.0);
}

TEST(BalanceLaws, AreThoseThatTheAxisCanShow) {
  EXPECT_NE(law_of(balance_laws(kRotary), "gravity"), nullptr);
  BalanceScales linear = kRotary;
  linear.is_rotary = false;
  EXPECT_EQ(law_of(balance_laws(linear), "gravity"), nullptr);
  BalanceScales held = kRotary;
  held.half_range = 0.0;
  EXPECT_EQ(law_of(balance_laws(held), "spring"), nullptr);
  BalanceScales coarse = kRotary;
  coarse.resolved_speed = coarse.top_speed;
  EXPECT_EQ(law_of(balance_laws(coarse), "stribeck"), nullptr) << "no speed below the resolved one is told from dry friction";
  EXPECT_EQ(law_of(balance_laws(kRotary), "lag"), nullptr);
  BalanceScales late = kRotary;
  late.lateness = {{0.01, false}, {0.02, false}, {0.01, true}};
  EXPECT_EQ(law_of(balance_laws(late), "lag")->shapes.size(), 2u);
  EXPECT_EQ(law_of(balance_laws(late), "delay")->shapes.size(), 1u);
}

// Of records of one direction a difference of directions is no column, and a constant is one that helps the motion, instead of dry friction.
TEST(BalanceLaws, OneDirectionHasNoDifferenceOfDirections) {
  for (const int direction : {1, -1}) {
    BalanceScales one_way = kRotary;
    one_way.direction = direction;
    const std::vector<BalanceLaw> laws = balance_laws(one_way);
    EXPECT_EQ(law_of(laws, "viscous")->shapes.front().columns.size(), 1u);
    EXPECT_EQ(law_of(laws, "dry")->instead_of, "offset");
    EXPECT_EQ(law_of(laws, "offset")->instead_of, "dry");
    const LawShape& constant = law_of(laws, "offset")->shapes.front();
    EXPECT_EQ(direction > 0 ? constant.largest : constant.least, 0.0);
    EXPECT_TRUE(std::isinf(direction > 0 ? constant.least : constant.largest));
  }
}

TEST(BalanceLaws, HaveNamesOfTheirOwn) {
  const std::vector<std::string> names = balance_law_names();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const BalanceLaw& law : balance_laws(kRotary)) EXPECT_NE(std::find(names.begin(), names.end(), law.name), names.end()) << law.name;
}

// What all samples share passes the filter as it is.
TEST(BalanceLaws, AConstantStaysOneUnderTheFilter) {
  const AxisRecord record{"even", 0.01, std::vector<double>(200, 0.0), std::vector<double>(200, 1.0)};
  const BalanceRecord balance = make_balance_record(record, 5);
  const std::vector<double> column = law_column(balance, [](const LawMoment&) { return 3.0; });
  ASSERT_EQ(column.size(), balance.speed.size());
  for (const double value : column) EXPECT_NEAR(value, 3.0, 1e-12);
}

}  // namespace
}  // namespace slewlab::diagnosis
