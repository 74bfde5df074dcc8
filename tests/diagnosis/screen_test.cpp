// What the screening forecasts, on columns whose answers are known in closed form, and from where it starts.
#include "diagnosis/screen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "sim/effects/catalogue.h"
#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kSpellEvery = 0.5;  // [s]

const common::EffectCatalogue& catalogue() {
  static const common::EffectCatalogue of_the_thesis = sim::effects_for(sim::thesis_crane());
  return of_the_thesis;
}

Screened screened(const char* effect, double left) { return {{effect, {}}, {}, 0.0, 0.0, left}; }

TEST(Screen, TakesTheBestOfEachEffectByWhatTheyLeave) {
  const std::vector<Screened> all{screened("wind", 5.0), screened("heel", 3.0), screened("wind", 2.0), screened("heel", 4.0)};
  std::vector<const Screened*> looks;
  for (const Screened& one : all) looks.push_back(&one);
  const std::vector<const Screened*> best = best_of_each(looks);
  ASSERT_EQ(best.size(), 2u);
  EXPECT_EQ(best[0], &all[2]);
  EXPECT_EQ(best[1], &all[1]);
}

// target + 2 a - 3 b = 0 by construction; parallel columns have no answer.
TEST(Screen, SolvesTwoColumnsJointly) {
  const Eigen::Vector3d a(1.0, 2.0, 0.0), b(0.0, 1.0, 1.0);
  const std::optional<Amounts> amounts = joint_amounts(a, b, -2.0 * a + 3.0 * b, 1e-6);
  ASSERT_TRUE(amounts);
  EXPECT_NEAR(amounts->x, 2.0, 1e-12);
  EXPECT_NEAR(amounts->y, -3.0, 1e-12);
  EXPECT_FALSE(joint_amounts(a, 2.0 * a, b, 1e-6));
}

// Of an effect that acts one way only no negative multiple is forecast.
TEST(Screen, TurnsOnlyWhatMayTurn) {
  const Eigen::Vector2d column(1.0, 0.0), target(3.0, 4.0);
  Screened turning = screened("hoisting", 0.0), fixed = screened("air_drag", 0.0);
  try_amount(catalogue(), column, target, turning);
  try_amount(catalogue(), column, target, fixed);
  EXPECT_DOUBLE_EQ(turning.amount, -3.0);
  EXPECT_DOUBLE_EQ(turning.left, 16.0);
  EXPECT_DOUBLE_EQ(fixed.amount, 0.0);
  EXPECT_DOUBLE_EQ(fixed.left, 25.0);
}

TEST(Screen, StartsFromEveryCombinationOfValuesWorthATry) {
  const common::EffectAbout& about = catalogue().at("pedestal_flexibility");
  std::vector<std::vector<double>> combinations{{}};
  for (const common::EffectParameter& parameter : about.parameters) {
    std::vector<double> worth_a_try = parameter.tries;
    worth_a_try.push_back(parameter.typical);
    std::vector<std::vector<double>> longer;
    for (const std::vector<double>& values : combinations) {
      for (const double value : worth_a_try) {
        longer.push_back(values);
        longer.back().push_back(value);
      }
    }
    combinations = std::move(longer);
  }
  EXPECT_GT(combinations.size(), 3u);
  std::set<std::vector<double>> different;
  for (const common::EffectInstance& start : starts_of(about, 30.0, kSpellEvery)) {
    EXPECT_TRUE(different.insert(start.values).second);
  }
  for (const std::vector<double>& values : combinations) EXPECT_TRUE(different.contains(values));
  std::size_t others = 0;  // a standard deviation up and down where there is neither a size that fades linearly nor a value worth a try
  for (const common::EffectParameter& parameter : about.parameters) {
    const bool fades_linearly = parameter.absent && std::isfinite(*parameter.absent);
    if (!fades_linearly && !parameter.detail && parameter.tries.empty()) others += 2;
  }
  EXPECT_EQ(different.size(), combinations.size() + others);
}

// A heel, looked at from the opposite direction, where no multiple of it takes anything away: with a quarter of a turn beside it
// what pulls across the boom is told, which is nearly all that the records have of it.
TEST(Screen, TellsAnArrowFromTwoQuarters) {
  constexpr double kPeriod = 1e-2, kHeel = 5e-3, kDirection = -1.0;  // [s], [rad], [rad]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"heel", {kHeel, kDirection}}};
  Admitted admitted({simulated_log(truth, bench().controller, kThereAndBack, kDuration, 3, kPeriod)});
  Problem& problem = admitted.problem;
  FitResult from = nominal_fit(problem);
  from.columns = Eigen::MatrixXd::Zero(from.difference.size(), static_cast<Eigen::Index>(from.point.nuisance.size()));
  const auto best_of = [&](const std::vector<common::EffectInstance>& starts) {
    return *best_of_each(screen(problem, from, projector_of(problem, from), starts, [](double, const std::string&) {})).front();
  };
  const common::EffectInstance opposite{"heel", {kHeel, kDirection + std::numbers::pi}};
  const Screened alone = best_of({opposite}), both = best_of(with_quarters(problem.catalogue.at("heel"), opposite));
  EXPECT_EQ(alone.amount, 0.0);
  const double across = kHeel * std::sin(kDirection);
  EXPECT_NEAR(both.amount * both.start.values[0] * std::sin(both.start.values[1]), across, 0.2 * std::fabs(across));
  const auto noise = static_cast<double>(difference_count(problem));
  EXPECT_LT(both.left - noise, 0.1 * (alone.left - noise));
}

// What recurs with an angle of the axis also with the lengths that were read off, within its bounds, all round; nothing else does.
TEST(Screen, StartsFromLengthsThatWereReadOff) {
  sim::MachineSettings nominal;
  nominal.crane = sim::thesis_crane();
  const std::vector<double> lengths{0.134, 100.0};  // [rad]
  const auto before = catalogue_starts(catalogue(), nominal, {}, 30.0, kSpellEvery), with = catalogue_starts(catalogue(), nominal, {}, 30.0, kSpellEvery, lengths);
  ASSERT_EQ(with.size(), before.size() + 4);
  const common::EffectAbout& about = catalogue().at("bearing_uneven");
  std::set<double> phases;
  for (const common::EffectInstance& start : with) {
    if (start.name != about.name || start.values[index_of(about, "wavelength")] != lengths[0]) continue;
    phases.insert(start.values[index_of(about, "phase")]);
    EXPECT_EQ(start.values[common::kSize], about.parameters[common::kSize].typical);
  }
  EXPECT_EQ(phases.size(), 4u);
}

// Columns of ramps: what begins at 1 s and ends, 1.5 s of ramp included, 3 s later is a ramp from 1 s less one from 2.5 s.
TEST(Screen, FindsABeginningAndAnEndFromBeginningsAlone) {
  const common::EffectAbout& about = catalogue().at("hoisting");
  std::vector<Screened> endless;
  for (const common::EffectInstance& start : starts_of(about, 30.0, kSpellEvery)) {
    if (start.values[index_of(about, about.spell->duration)] < about.parameters[index_of(about, about.spell->duration)].upper) continue;
    Eigen::VectorXd ramp(600);  // 30 s
    for (Eigen::Index k = 0; k < ramp.size(); ++k) ramp(k) = std::max(0.0, 0.05 * static_cast<double>(k) - start.values[index_of(about, about.spell->begin)]);
    endless.push_back({start, ramp, 0.0, 0.0, 0.0});
  }
  const auto beginning_at = [&](double time) {
    return std::find_if(endless.begin(), endless.end(), [&](const Screened& one) { return one.start.values[index_of(about, about.spell->begin)] == time; })->column;
  };
  std::vector<const Screened*> looks;
  for (const Screened& one : endless) looks.push_back(&one);
  const Screened best = between_beginnings(catalogue(), looks, -1.5 * (beginning_at(1.0) - beginning_at(2.5)));
  EXPECT_DOUBLE_EQ(best.start.values[index_of(about, about.spell->begin)], 1.0);
  EXPECT_DOUBLE_EQ(best.start.values[index_of(about, about.spell->duration)], 1.5 + best.start.values[index_of(about, about.spell->fade)]);
  EXPECT_NEAR(best.amount, 1.5, 1e-9);
  EXPECT_NEAR(best.left, 0.0, 1e-6);
}

}  // namespace
}  // namespace slewlab::diagnosis
