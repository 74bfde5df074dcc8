// Expected: what made the log, and that nothing is looked for where nothing can be won.
#include "diagnosis/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;  // [s] of a PLC
constexpr std::array<std::string_view, 5> kKept{"bearing_viscous", "dead_time", "torque_lag", "torque_offset", "house_inertia"};

// A search behind parameters alone, for a few effects of the catalogue.
struct Searching {
  explicit Searching(const sim::MachineSettings& truth) : admitted({simulated_log(truth, bench().controller, kThereAndBack, kDuration, 3, kPeriod)}) {
    Problem& problem = admitted.problem;
    problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
    whiten_again(problem, admitted.whitening);
    base = fit_parameters_alone(problem, nominal_fit(problem));
    const std::vector<common::EffectInstance> starts =
        catalogue_starts(problem.catalogue, problem.nominal, all_but(problem.catalogue, kKept), last_moment(problem), problem.thresholds.spell_every);
    const Screening screening = screen(problem, base, projector_of(problem, base), starts, [](double, const std::string&) {});
    const auto told = [&](double, const std::string& doing) { doings.push_back(doing); };
    found = search(problem, base, screening, {}, [](FitResult&) { return Shown::nothing; }, told);
  }
  bool was_told(std::string_view beginning) const {
    return std::any_of(doings.begin(), doings.end(), [&](const std::string& doing) { return doing.starts_with(beginning); });
  }

  Admitted admitted;
  FitResult base;
  Found found;
  std::vector<std::string> doings;
};

// A machine of which parameters alone, not far from nominal, leave noise: no effect comes down to them, and neither pairs nor a way back from an effect are looked for.
TEST(Search, EndsWhereNoEffectComesDownToParametersThatLeaveNoise) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(11);
  const Searching searching(truth);
  ASSERT_LT(searching.base.mean_square, 1.0);
  EXPECT_FALSE(searching.was_told("meeting at the best fit"));
  EXPECT_FALSE(searching.was_told("trying every effect of the catalogue beside"));
  EXPECT_EQ(searching.found.nothing.cost, searching.base.cost);
  for (const FitResult& fit : searching.found.fits) EXPECT_GE(fit.cost, searching.base.cost) << fit.point.effects.front().name;
}

// Delays are alike: the one that acts leads, alone, with its size.
TEST(Search, FindsWhichDelayItIs) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(12);
  truth.effects = {{"torque_lag", {0.04, 0.0}}};  // [s] time constant, [-] share of it that is a delay
  const Searching searching(truth);
  ASSERT_GT(searching.base.mean_square, kNoiseAlone);
  ASSERT_FALSE(searching.found.fits.empty());
  const FitResult& best = searching.found.fits.front();
  ASSERT_EQ(best.point.effects.size(), 1U);
  EXPECT_EQ(best.point.effects.front().name, "torque_lag");
  EXPECT_NEAR(best.point.effects.front().values.front(), 0.04, 0.004);
  EXPECT_LT(best.mean_square, 1.0);
}

// Of two effects that leave noise alone each stands alone at the floor of its valley: nothing of what the second one takes away beside it may be what the first one's fit has left.
TEST(Search, SettlesEachOfTwoEffectsAlone) {
  constexpr double kLittle = 0.5;  // in units of -2 ln of a probability
  sim::MachineSettings truth;
  truth.crane = spread_crane(15);
  truth.effects = {{"bearing_viscous", {5e6, 0.0}}, {"torque_offset", {3e4}}};  // [N m s/rad], [-]; [N m]
  Searching searching(truth);
  ASSERT_FALSE(searching.found.fits.empty());
  const std::vector<common::EffectInstance> both = searching.found.fits.front().point.effects;
  ASSERT_EQ(both.size(), 2U);
  ASSERT_LE(searching.found.fits.front().mean_square, kNoiseAlone);
  int alone = 0;
  for (const FitResult& fit : searching.found.fits) {
    if (fit.point.effects.size() != 1 || !has_effect(both, fit.point.effects.front().name)) continue;
    FitResult again = fit;
    settle_to_the_floor(searching.admitted.problem, again, 10);
    EXPECT_GT(again.cost, fit.cost - kLittle) << fit.point.effects.front().name;
    ++alone;
  }
  EXPECT_EQ(alone, 2);
}

}  // namespace
}  // namespace slewlab::diagnosis
