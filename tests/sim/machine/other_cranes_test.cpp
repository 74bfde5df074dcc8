// The cranes of other makers' proportions (config/cranes): their modes against a mesh of 128 elements, and what their
// controllers' files say of the machine against the machine's own file.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "sim/analysis/eigen.h"
#include "sim/machine/machine_file.h"
#include "sim/machine/scales.h"

namespace slewlab::sim {
namespace {

const std::string kConfig = std::string(SLEWLAB_SOURCE_DIR) + "/config/";

class OtherCranes : public testing::TestWithParam<const char*> {
 protected:
  static CraneParameters crane() { return load_machine_file(kConfig + "cranes/" + GetParam() + ".yaml").parameters; }
};
INSTANTIATE_TEST_SUITE_P(Cranes, OtherCranes, testing::Values("harbour_5t", "offshore_900t"),
                         [](const auto& name) { return std::string(name.param); });

// [Hz] of what bends, twists or winds up the gears, rising; drives that swing against each other count once.
std::vector<double> elastic_modes(CraneParameters crane, int elements, std::size_t most) {
  crane.boom.element_count = elements;
  std::vector<double> found;
  for (const Mode& mode : crane_modes(crane)) {
    if (mode.kind == ModeKind::kRigid || mode.kind == ModeKind::kLoad) continue;
    const bool is_again = !found.empty() && mode.frequency < found.back() * (1.0 + 1e-6);
    if (!is_again && found.size() < most) found.push_back(mode.frequency);
  }
  return found;
}

// Of other boom types (box girder, A-frame with luffing cylinders, knuckle), driven as the thesis's crane.
class BoomTypes : public OtherCranes {};
INSTANTIATE_TEST_SUITE_P(Cranes, BoomTypes, testing::Values("box_girder", "a_frame", "knuckle"),
                         [](const auto& name) { return std::string(name.param); });

void expect_the_modes_of_a_fine_mesh(const CraneParameters& crane) {
  const std::vector<double> own = elastic_modes(crane, crane.boom.element_count, 5), fine = elastic_modes(crane, 128, 5);
  ASSERT_EQ(own.size(), 5u);
  for (std::size_t k = 0; k < own.size(); ++k) EXPECT_NEAR(own[k] / fine[k], 1.0, 0.005) << fine[k] << " Hz";
}

TEST_P(BoomTypes, FirstFiveModesStandWithinHalfAPercentOf128Elements) { expect_the_modes_of_a_fine_mesh(crane()); }

TEST_P(OtherCranes, FirstFiveModesStandWithinHalfAPercentOf128Elements) {
  expect_the_modes_of_a_fine_mesh(crane());
}

// The controller's own numbers of the machine are the machine's.
TEST_P(OtherCranes, ControllerIsMadeForTheCrane) {
  const controller::ControllerSettings settings =
      controller::load_controller_file(kConfig + "controllers/" + GetParam() + ".yaml").settings;
  const Scales scales = scales_of(crane());
  EXPECT_EQ(settings.group_count, crane().drive.group_count);
  EXPECT_NEAR(settings.total_ratio, scales.ratio, 1e-9);
  EXPECT_DOUBLE_EQ(settings.rated_torque, scales.motor_torque);
  EXPECT_DOUBLE_EQ(settings.ramp.top_speed, scales.top_speed);
  EXPECT_GT(settings.ramp.emergency_stop_time, scales.acceleration_time);  // T100 alone stops the unloaded crane in time
}

}  // namespace
}  // namespace slewlab::sim
