// Records of machines whose commands come late by chance, and of such as answer to each command alike. Judge: what the truth is.
#include "diagnosis/law_in_draws.h"

#include <gtest/gtest.h>

#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;  // [s]

LawInDraws asked(const common::EffectInstance& truth, const common::EffectInstance& suspected) {
  BenchProblem problem;
  problem.gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, kPeriod));
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.seed = 1234;
  machine.effects = {truth};
  problem.add(make_record(simulated_log(machine, bench().controller, kThereAndBack, kDuration, 4, kPeriod), "a", bench().admission));
  FitResult fit;
  fit.point.nuisance.assign(nuisance_count(problem), 0.0);
  fit.point.effects = {suspected};
  return law_in_draws(problem, fit);
}

TEST(LawInDraws, WhatIsDrawnIsNoLaw) {
  for (const common::EffectInstance& drawn : {common::EffectInstance{"command_jitter", {0.05}}, common::EffectInstance{"command_loss", {0.5, 1.0}}}) {
    const LawInDraws found = asked(drawn, drawn);
    EXPECT_FALSE(found.is_law()) << drawn.name << " " << found.left << " of " << found.left_of_draws;
    EXPECT_GT(found.left, 1.0) << drawn.name;  // the draw itself, above the noise
  }
}

// The mean of jitter is a delay of half its spread, so a lag as long has about its power.
TEST(LawInDraws, WhatAnswersToEachCommandAlikeIsOne) {
  const LawInDraws found = asked({"torque_lag", {0.025, 0.0}}, {"command_jitter", {0.05}});
  EXPECT_TRUE(found.is_law()) << found.left << " of " << found.left_of_draws;
}

}  // namespace
}  // namespace slewlab::diagnosis
