#include "diagnosis/coordinates.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

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

// Two arrows by their components: those of the step are the difference of the tips', seen from the first arrow, whatever the angles.
TEST(Coordinates, OfAnArrowSpanThePlaneOfItsTip) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters);
  const common::EffectAbout& about = catalogue.at("heel");
  const double size = about.parameters[0].prior_scale, angle = about.parameters[1].prior_scale;
  const std::vector<common::EffectInstance> from{{"heel", {0.02, 3.0}}}, to{{"heel", {0.05, -2.0}}};
  const auto tip = [](const common::EffectInstance& arrow, double seen_from) {
    return Eigen::Vector2d(arrow.values[0] * std::cos(arrow.values[1] - seen_from), arrow.values[0] * std::sin(arrow.values[1] - seen_from));
  };
  const Eigen::VectorXd step = effects_step(catalogue, from, to);
  const Eigen::Vector2d apart = tip(to[0], 3.0) - tip(from[0], 3.0);
  EXPECT_NEAR(step(0) * size, apart.x(), 1e-15);
  EXPECT_NEAR(step(1) * angle * 0.02, apart.y(), 1e-15);
  const common::EffectInstance there = effects_moved(catalogue, from, step).front();
  EXPECT_NEAR(there.values[0], 0.05, 1e-15);
  EXPECT_NEAR(there.values[1], -2.0, 1e-14);
}

// Through no length at all an arrow comes to the other side; a size that is no arrow's stops at its bound.
TEST(Coordinates, OfAnArrowLeadThroughNoneToTheOtherSide) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters);
  const double size = catalogue.at("heel").parameters[0].prior_scale;
  const common::EffectInstance there = effects_moved(catalogue, {{"heel", {0.02, 0.5}}}, Eigen::Vector2d(-0.05 / size, 0.0)).front();
  EXPECT_NEAR(there.values[0], 0.03, 1e-15);
  EXPECT_NEAR(std::fabs(std::remainder(there.values[1] - 0.5, 2.0 * std::numbers::pi)), std::numbers::pi, 1e-12);
  const common::EffectAbout& drag = catalogue.at("air_drag");
  const common::EffectInstance none = effects_moved(catalogue, {common::typical_instance(drag)}, Eigen::VectorXd::Constant(1, -1e6)).front();
  EXPECT_EQ(none.values[0], drag.parameters[0].lower);
}

// A force that is linear in the arrow's components has columns that turn with it: those at one arrow times the axes are those at another one. The expected ones are written out.
TEST(Coordinates, OfAnArrowTurnWithIt) {
  const common::EffectCatalogue catalogue = sim::effects_for(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters);
  const common::EffectAbout& about = catalogue.at("heel");
  const double size = about.parameters[0].prior_scale, angle = about.parameters[1].prior_scale;
  // By one deviation of length or angle, of the force (r cos(a - 0.3), r sin(a - 0.3)).
  const auto columns_at = [&](const common::EffectInstance& arrow) {
    const double r = arrow.values[0], a = arrow.values[1] - 0.3;
    Eigen::Matrix2d columns;
    columns << size * std::cos(a), -angle * r * std::sin(a), size * std::sin(a), angle * r * std::cos(a);
    return columns;
  };
  const std::vector<common::EffectInstance> from{{"heel", {0.02, 3.0}}}, to{{"heel", {0.05, -2.0}}};
  EXPECT_LT((columns_at(from[0]) * step_axes(catalogue, from, to) - columns_at(to[0])).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace slewlab::diagnosis
