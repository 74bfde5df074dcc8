#include "sim/integrate/plant_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/model/cannot_be_built.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

TEST(PlantModel, RefusesMachinesThatCannotBeBuilt) {
  CraneParameters crane = thesis_crane();
  EXPECT_THROW(make_plant_model(crane, 0.0), std::invalid_argument);
  crane.drive.gearbox_stiffness = 0.0;
  EXPECT_THROW(make_plant_model(crane, kStep), CannotBeBuilt);
  crane.drive.group_count = 0;
  EXPECT_THROW(make_plant_model(crane, kStep), std::invalid_argument);
}

// Without force a mode's step is a matrix that depends on the length alone: two halves are the whole.
TEST(PlantModel, TwoHalfStepsOfAFreeModeAreOneWhole) {
  const PlantModel model = make_plant_model(thesis_crane(), kStep);
  ModalStep half = model.full;
  discretise(model, StepLength(0.5 * kStep), half);
  ASSERT_GT(model.mode_count, 5);
  for (int mode = 0; mode < model.mode_count; ++mode) {
    const auto term = [&](const ModalStep& step, int which) { return step.free[place(mode, which, free_term::count)]; };
    const double qq = term(half, free_term::qq), qv = term(half, free_term::qv), vq = term(half, free_term::vq), vv = term(half, free_term::vv);
    const double rate = std::max(1.0, model.fastest[static_cast<std::size_t>(mode)]);
    EXPECT_NEAR(term(model.full, free_term::qq), qq * qq + qv * vq, 1e-13) << mode;
    EXPECT_NEAR(term(model.full, free_term::qv), qq * qv + qv * vv, 1e-13 / rate) << mode;
    EXPECT_NEAR(term(model.full, free_term::vq), vq * qq + vv * vq, 1e-13 * rate) << mode;
    EXPECT_NEAR(term(model.full, free_term::vv), vq * qv + vv * vv, 1e-13) << mode;
  }
}

// Closed form: an undamped mode goes on as cosine and sine.
TEST(PlantModel, AnUndampedLoadSwingsByCosineAndSine) {
  CraneParameters crane = thesis_crane();
  crane.load.damping_ratio = 0.0;
  const PlantModel model = make_plant_model(crane, kStep);
  for (int mode = 0; mode < 2; ++mode) {
    const double w = model.load.frequency(mode);
    EXPECT_NEAR(model.load_step.qq[mode], std::cos(w * kStep), 1e-15);
    EXPECT_NEAR(model.load_step.qv[mode], std::sin(w * kStep) / w, 1e-15);
    EXPECT_NEAR(model.load_step.vq[mode], -w * std::sin(w * kStep), 1e-13 * w);
  }
}

// The tabulated systems are those of the gears in contact: none leaves the house alone, both answer as the sum of each.
TEST(PlantModel, ASystemOfGearsHasThoseInContact) {
  const PlantModel model = make_plant_model(thesis_crane(), kStep);
  ASSERT_EQ(model.full.systems.size(), 4u);
  const GearSystem &none = model.full.systems[0], &first = model.full.systems[1], &second = model.full.systems[2], &both = model.full.systems[3];
  EXPECT_EQ(none.scale, 1.0);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) EXPECT_EQ(none.system[row][column], row == column ? 1.0 : 0.0);
    for (int column = 0; column < 3; ++column) {
      EXPECT_EQ(both.answer[row][column], first.answer[row][column] + second.answer[row][column]);
      EXPECT_NE(both.answer[row][column], 0.0);
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
