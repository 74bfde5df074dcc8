#include "diagnosis/weigh_fits.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "tests/diagnosis/bench.h"
#include "tests/diagnosis/missing_torque.h"

namespace slewlab::diagnosis {
namespace {

constexpr int kRounds = 4;
constexpr std::size_t kEffects = 50;  // that could have been named

// Parameters alone, and with either effect, as they fit a machine and are weighed.
struct WeighedMachine {
  explicit WeighedMachine(const std::vector<common::EffectInstance>& effects) : missing(effects, no_torque) {
    found.nothing = missing.fit;
    conclude(missing.problem, found.nothing);
    for (const common::EffectInstance& start : {common::EffectInstance{"bearing_viscous", {1e6, 0.0}}, common::EffectInstance{"torque_lag", {0.01, 0.0}}}) {
      Point point = missing.fit.point;
      point.effects = {start};
      FitResult one = fit(missing.problem, missing.fit.columns, point);
      settle(missing.problem, one, kRounds);
      conclude(missing.problem, one);
      found.fits.push_back(std::move(one));
    }
    weighed = weigh_fits(missing.problem, found, SmoothTorques(missing.problem, missing.fit), kEffects, {}, false);
  }
  double sum() const { return std::accumulate(weighed.probabilities.candidate.begin(), weighed.probabilities.candidate.end(), weighed.probabilities.unknown); }

  MissingTorque missing;
  Found found;
  Weighed weighed;
};

// Viscous friction that acts is the answer and explains the gap; the lag, which parameters help, takes little of it.
TEST(WeighFits, TheEffectThatActsIsTheAnswer) {
  const WeighedMachine machine({{"bearing_viscous", {3e6, 0.0}}});
  const std::vector<Cause>& causes = machine.weighed.causes;
  ASSERT_EQ(causes.size(), 3U);
  EXPECT_TRUE(causes[0].effects.empty());
  EXPECT_EQ(causes[1].effects, std::vector<std::string>{"bearing_viscous"});
  EXPECT_GT(causes[1].probability, 0.95);
  EXPECT_GT(causes[1].explained, 0.99);
  EXPECT_LT(causes[2].explained, 0.9);
  EXPECT_EQ(causes[0].explained, 0.0);
  EXPECT_EQ(machine.weighed.answer(machine.found.fits), &machine.found.fits[0]);
  EXPECT_NEAR(machine.sum(), 1.0, 1e-9);
}

// Beside the best effect alone, and beside those of an answer of two; not beside what happens by chance.
TEST(WeighFits, SomethingElseIsAskedBesideTheBestEffectAndTheAnswers) {
  std::vector<FitResult> fits(5);
  fits[0].point.effects = {{"command_jitter", {0.01}}};
  fits[1].point.effects = {{"load_mass", {1.2}}, {"torque_lag", {0.01, 0.0}}};
  fits[2].point.effects = {{"house_inertia", {1.2}}};
  fits[3].point.effects = {{"torque_lag", {0.01, 0.0}}};
  fits[4].point.effects = {{"rope_length", {1.2}}};
  const common::EffectCatalogue catalogue = sim::effects_for(bench().crane);
  EXPECT_EQ(fits_to_ask_beside(catalogue, fits, nullptr), (std::vector<std::size_t>{2}));
  EXPECT_EQ(fits_to_ask_beside(catalogue, fits, &fits[1]), (std::vector<std::size_t>{2, 3}));
}

// Nothing acts: neither effect, nor a law that nobody knows, is likelier than that.
TEST(WeighFits, WhereNothingActsNothingIsMissing) {
  const WeighedMachine machine({});
  EXPECT_GT(machine.weighed.causes[0].probability, 0.5);
  EXPECT_LT(machine.weighed.probabilities.unknown, 0.3);
  EXPECT_NEAR(machine.sum(), 1.0, 1e-9);
}

}  // namespace
}  // namespace slewlab::diagnosis
