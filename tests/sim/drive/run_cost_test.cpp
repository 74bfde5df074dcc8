#include "sim/drive/run_cost.h"

#include <gtest/gtest.h>

namespace slewlab::sim {
namespace {

Scenario scenario(double duration, double step, int elements) {
  Scenario s;
  s.duration = static_cast<std::int64_t>(duration * 1e9);
  s.plant_step = static_cast<std::int64_t>(step * 1e9);
  s.controller_period = 10'000'000;
  s.crane.parameters.boom.element_count = elements;
  return s;
}

// 60 s of 1 ms: 60 000 (151 + 6 * 14.9) ns and 6000 * 20 us.
TEST(RunCost, OfTheUsualScenarioIsUnderASecond) {
  const RunCost cost = run_cost(scenario(60.0, 1e-3, 6));
  EXPECT_DOUBLE_EQ(cost.steps, 60'000.0);
  EXPECT_NEAR(cost.seconds, 60'000 * (151 + 6 * 14.9) * 1e-9 + 0.12, 1e-3);
}

// 6e10 steps of 240 ns are four hours; a thousand elements take 100 s to assemble and 15 us a step.
TEST(RunCost, IsToldInStepsAndInTheTimeThatTheyTake) {
  EXPECT_EQ(text_of(run_cost(scenario(60.0, 1e-9, 6))), "about 60 000 000 000 plant steps, some 4 hours");
  EXPECT_EQ(text_of(run_cost(scenario(60.0, 1e-3, 1000))), "about 60 000 plant steps, some 100 seconds");
}

TEST(RunCost, OfAScenarioThatCouldNotBeReadIsNothing) { EXPECT_EQ(run_cost(Scenario{}).seconds, 0.0); }

}  // namespace
}  // namespace slewlab::sim
