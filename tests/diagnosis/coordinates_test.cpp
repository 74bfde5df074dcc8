#include "diagnosis/coordinates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {
namespace {

// A factor is judged by how far it is from 1, where the effect is absent: an unchanged inertia costs nothing, and factors
// of e^0.5 and e^-0.5 as much as each other. Where absent is infinite, by how far it is from its typical size.
TEST(Coordinates, OfALogarithmicParameterAreZeroWhereTheEffectIsAbsent) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters);
  const common::EffectParameter& factor = catalogue.at("house_inertia").parameters[common::kSize];
  EXPECT_EQ(to_coordinate(factor, 1.0), 0.0);
  EXPECT_EQ(value_at(factor, 0.0), 1.0);
  EXPECT_NEAR(to_coordinate(factor, std::exp(0.5)), 1.0, 1e-12);  // its prior's width is 0.5
  EXPECT_NEAR(to_coordinate(factor, std::exp(-0.5)), -1.0, 1e-12);
  EXPECT_NEAR(value_at(factor, to_coordinate(factor, 2.5)), 2.5, 1e-12);
  const common::EffectParameter& limit = catalogue.at("torque_limit").parameters[common::kSize];
  EXPECT_EQ(to_coordinate(limit, limit.typical), 0.0);
  for (const common::EffectAbout& about : catalogue.effects) {
    for (const common::EffectParameter& parameter : about.parameters) {
      if (!parameter.absent || !std::isfinite(*parameter.absent)) continue;
      EXPECT_EQ(to_coordinate(parameter, *parameter.absent), 0.0) << about.name << " " << parameter.name;
    }
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
