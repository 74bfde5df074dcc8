// Friction of twice the rated torque: a plain axis's file may have it, as its drive can deliver that for short; a crane's may not.
#include "sim/effects/axis_bounds.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/input_error.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "sim/machine/effect_scales.h"
#include "sim/machine/machine_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::sim {
namespace {

MachineFile axis_with_friction(double torque) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "axis.yaml";
  std::ofstream(file) << "kind: axis\ncoordinate: {value: rotary, source: test}\n"
                         "inertia: {value: 2, unit: kg m^2, source: test}\nrated_torque: {value: 10, unit: N m, source: test}\n"
                         "top_speed: {value: 3, unit: rad/s, source: test}\n"
                         "effects:\n  - effect: bearing_coulomb\n    torque: {value: "
                      << torque
                      << ", unit: N m, source: test}\n    asymmetry: {value: 0, unit: \"-\", source: test}\n    give: {value: 0, unit: rad, source: test}\n";
  return load_machine_file(file);
}

TEST(AxisBounds, AnAxissFrictionMayTakeTwiceTheRatedTorque) {
  MachineSettings settings = machine_settings(axis_with_friction(20.0));
  settings.step = 1e-3;
  EXPECT_NO_THROW(make_machine(settings));
  EXPECT_THROW(machine_settings(axis_with_friction(60.0)), common::InputError);
}

TEST(AxisBounds, OnlyBoundsMove) {
  const MachineFile axis = axis_with_friction(1.0);
  const common::EffectAbout& law = find_effect("bearing_coulomb")->about;
  const common::EffectAbout narrow = common::in_units_of(law, effect_scales(axis.parameters, axis.drive_protection));
  common::EffectAbout wide = narrow;
  widen_for_a_plain_axis(law, wide);
  EXPECT_DOUBLE_EQ(wide.parameters[common::kSize].upper, 5.0 * narrow.parameters[common::kSize].upper);
  EXPECT_EQ(wide.parameters[common::kSize].lower, 0.0);
  EXPECT_EQ(wide.parameters[common::kSize].typical, narrow.parameters[common::kSize].typical);
  EXPECT_EQ(wide.parameters[common::kSize].prior_scale, narrow.parameters[common::kSize].prior_scale);
}

}  // namespace
}  // namespace slewlab::sim
