// Expected times: those of the law that the machine has and its model has not.
#include "diagnosis/spell_times.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

const char* const kLaw = "hoisting";
const std::vector<Move> kSlowly{{2.0, 0.5}, {12.0, 0.0}, {18.0, -0.5}, {28.0, 0.0}};
constexpr double kLongDuration = 38.0, kPeriod = 0.01;  // [s]

// The law with these numbers [m/s], [s], [s], [s], [-].
common::EffectInstance hoist(const common::EffectAbout& about, double speed, double start, double duration, double ramp_time, double rounding) {
  common::EffectInstance one = common::typical_instance(about);
  one.values[index_of(about, "speed")] = speed;
  one.values[index_of(about, "start")] = start;
  one.values[index_of(about, "duration")] = duration;
  one.values[index_of(about, "ramp_time")] = ramp_time;
  one.values[index_of(about, "rounding")] = rounding;
  return one;
}

double end_of(const common::EffectInstance& one) { return one.values[1] + one.values[2]; }

TEST(SpellTimes, MoveTheBeginningOrTheEnd) {
  const BenchProblem problem;
  const common::EffectAbout& about = problem.catalogue.at(kLaw);
  const common::EffectInstance now = hoist(about, 0.5, 0.4, 20.0, 1.0, 0.5);
  int earlier = 0, later = 0, ends_earlier = 0, ends_later = 0;
  for (const common::EffectInstance& one : other_times(about, now, 1.0)) {
    EXPECT_GE(one.values[1], 0.0);
    EXPECT_EQ(one.values[0], now.values[0]);
    const double begin = one.values[1] - now.values[1], end = end_of(one) - end_of(now);
    EXPECT_NE(std::fabs(begin) < 1e-9, std::fabs(end) < 1e-9);  // the other one is as it was
    if (std::fabs(end) < 1e-9) ++(begin < 0.0 ? earlier : later);
    else ++(end < 0.0 ? ends_earlier : ends_later);
  }
  EXPECT_EQ(ends_earlier, ends_later);
  EXPECT_EQ(later, ends_later);
  EXPECT_EQ(earlier * 12, later);  // by 0.25 s, and no more than the 0.4 s before it
}

TEST(SpellTimes, LieAllOverTheRecord) {
  const BenchProblem problem;
  const common::EffectAbout& about = problem.catalogue.at(kLaw);
  const std::vector<common::EffectInstance> all = all_times(about, 32.0);
  double earliest = 32.0, latest = 0.0, lowest = 0.0, highest = 0.0;
  for (const common::EffectInstance& one : all) {
    earliest = std::min(earliest, one.values[1]);
    latest = std::max(latest, end_of(one));
    lowest = std::min(lowest, one.values[0]);
    highest = std::max(highest, one.values[0]);
    EXPECT_GE(one.values[2], 2.0 * one.values[3]);  // its two ramps
  }
  ASSERT_FALSE(all.empty());
  EXPECT_DOUBLE_EQ(earliest, 0.0);
  EXPECT_DOUBLE_EQ(latest, 32.0);
  EXPECT_DOUBLE_EQ(highest, -lowest);
  EXPECT_LE(highest, about.parameters[0].upper);
}

// A fit that begins some periods of the boom's lowest mode beside it ends in another valley; it is led to the right one. When the law ends hardly shows here: the load hangs still by then.
TEST(SpellTimes, AreFoundFromAnotherValley) {
  BenchProblem problem;
  const common::EffectAbout& about = problem.catalogue.at(kLaw);
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {hoist(about, 0.6, 5.0, 15.0, 1.0, 0.0)};
  problem.add(make_record(simulated_log(truth, bench().controller, kSlowly, kLongDuration, 7, kPeriod), "a", bench().admission));
  const FitResult nominal = fit_parameters_alone(problem, nominal_fit(problem));
  const auto nuisances = static_cast<Eigen::Index>(nominal.point.nuisance.size());
  FitResult found = fit(problem, nominal.columns.leftCols(nuisances), {nominal.point.nuisance, {hoist(about, 0.5, 6.3, 13.7, 1.2, 0.3)}, 0});
  settle(problem, found, 10);
  ASSERT_GT(mean_square(found.difference), kNoiseAlone);
  look_for_other_times(problem, found);
  EXPECT_NEAR(found.point.effects[0].values[1], 5.0, 0.1);
  EXPECT_LT(mean_square(found.difference), kNoiseAlone);
}

// Nothing to look for.
TEST(SpellTimes, OfAnEffectWithoutASpellAreLeftAlone) {
  BenchProblem problem;
  problem.add(make_record(simulated_log({.crane = bench().crane, .effects = {}}, bench().controller, kSlowly, kLongDuration, 7, kPeriod), "a", bench().admission));
  FitResult fitted = fit_at(problem, {std::vector<double>(nuisance_count(problem), 0.0), {common::typical_instance(problem.catalogue.at("heel"))}, 0});
  fitted.cost = 3.0;
  look_for_other_times(problem, fitted);
  EXPECT_EQ(fitted.cost, 3.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
