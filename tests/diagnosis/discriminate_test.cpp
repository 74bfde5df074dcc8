// What would tell two causes apart, on pairs of which the answer is known beforehand.
#include "diagnosis/discriminate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "controller/controller_file.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {
namespace {

sim::MachineSettings machine_with(const std::vector<common::EffectInstance>& effects) {
  sim::MachineSettings machine;
  machine.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters;
  machine.effects = effects;
  return machine;
}

std::vector<Separation> between(const std::vector<common::EffectInstance>& one, const std::vector<common::EffectInstance>& other) {
  const controller::ControllerSettings controller =
      controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
  return separations(machine_with(one), machine_with(other), controller);
}

// A torque that comes late is the same motion whether it waits on the wire or in the drive.
TEST(Discriminate, NothingTellsTheSameMotionApart) {
  const std::vector<Separation> all = between({{"dead_time", {0.02}}}, {{"command_delay", {0.02}}});
  ASSERT_FALSE(all.empty());
  EXPECT_LT(all.front().noise_floors, kSeparated);
}

// A limit above what half speed needs and below what full speed needs shows at full speed alone.
TEST(Discriminate, ALimitShowsWhereItIsReached) {
  const std::vector<Separation> all = between({}, {{"torque_limit", {170.0, 0.1}}});
  EXPECT_NE(all.front().manoeuvre.find("full speed"), std::string::npos) << all.front().manoeuvre;
  EXPECT_GT(all.front().noise_floors, kSeparated);
}

// Who is farthest apart stands first, and which of the two is named first makes no difference.
TEST(Discriminate, IsInOrderAndSymmetric) {
  const std::vector<Separation> there = between({{"boom_stiffness", {0.9}}}, {{"load_mass", {1.2}}});
  const std::vector<Separation> back = between({{"load_mass", {1.2}}}, {{"boom_stiffness", {0.9}}});
  EXPECT_TRUE(std::is_sorted(there.begin(), there.end(),
                             [](const Separation& a, const Separation& b) { return a.noise_floors > b.noise_floors; }));
  ASSERT_EQ(there.size(), back.size());
  for (std::size_t i = 0; i < there.size(); ++i) EXPECT_DOUBLE_EQ(there[i].difference, back[i].difference);
}

}  // namespace
}  // namespace slewlab::diagnosis
