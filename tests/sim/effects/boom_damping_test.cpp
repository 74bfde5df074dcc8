#include "sim/effects/boom_damping.h"

#include <gtest/gtest.h>

#include "sim/model/boom.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(BoomDamping, MultipliesTheDampingOfEveryMode) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  boom_damping().change({3.0}, parameters);
  EXPECT_NEAR(boom_damping_coefficient(parameters.crane.boom),
              3.0 * boom_damping_coefficient(flexible_crane().boom), 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
