// Every machine of a batch against itself alone, to the bit: whatever effects it and its neighbours have.
#include "sim/integrate/machine_batch.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/effects/catalogue.h"
#include "sim/machine/effect_scales.h"
#include "tests/common/allocation_guard.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

DriveCommand command_at(std::int64_t k) {
  DriveCommand command;
  command.sequence = k / 10;
  const double time = 1e-3 * static_cast<double>(k);
  command.motor_torque = {150.0 * std::sin(2.0 * time) + 40.0, 150.0 * std::sin(2.0 * time) - 40.0};
  return command;
}

MachineSettings machine_with(std::vector<common::EffectInstance> effects, double share = 1.0, int elements = 6) {
  MachineSettings settings{.crane = thesis_crane(elements), .effects = std::move(effects)};
  settings.crane.house.inertia *= share;
  settings.crane.drive.gearbox_stiffness /= share;
  return settings;
}

common::EffectInstance typical(std::string_view name) {
  return common::typical_instance(common::in_units_of(find_effect(name)->about, effect_scales(thesis_crane())));
}

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

void expect_same(const Machine& alone, const Machine& beside) {
  const MachineReadings a = read(alone), b = read(beside);
  EXPECT_TRUE(same(a.house_acceleration, b.house_acceleration));
  EXPECT_TRUE(same(a.tip_acceleration, b.tip_acceleration));
  EXPECT_TRUE(same(a.middle_acceleration, b.middle_acceleration));
  EXPECT_TRUE(same(a.slew_angle, b.slew_angle));
  EXPECT_EQ(time_of(alone), time_of(beside));
  EXPECT_EQ(alone.effect_evaluations, beside.effect_evaluations);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(same(a.shaft_speed[i], b.shaft_speed[i]));
    EXPECT_TRUE(same(a.shaft_position[i], b.shaft_position[i]));
    EXPECT_TRUE(same(alone.applied_torque[i], beside.applied_torque[i]));
    EXPECT_EQ(alone.state.contact[i], beside.state.contact[i]);
    EXPECT_EQ(alone.state.play_crossings[i], beside.state.play_crossings[i]);
  }
}

std::vector<Machine> machines_of(const std::vector<MachineSettings>& settings) {
  std::vector<Machine> machines;
  for (const MachineSettings& one : settings) machines.push_back(make_machine(one));
  return machines;
}

std::vector<Machine*> pointers(std::vector<Machine>& machines) {
  std::vector<Machine*> result;
  for (Machine& machine : machines) result.push_back(&machine);
  return result;
}

// Returns the batch's groups that are in lanes at the end.
int compare(const std::vector<MachineSettings>& settings, std::int64_t steps) {
  std::vector<Machine> alone = machines_of(settings), beside = machines_of(settings);
  MachineBatch batch = make_machine_batch(pointers(beside));
  std::int64_t contact_changes = 0;
  for (std::int64_t k = 0; k < steps && !testing::Test::HasFailure(); ++k) {
    for (Machine& machine : alone) step(machine, command_at(k));
    step(batch, command_at(k));
    if (k % 10 != 0) continue;
    for (std::size_t m = 0; m < alone.size(); ++m) {
      SCOPED_TRACE(testing::Message() << "machine " << m << " after step " << k + 1);
      expect_same(alone[m], beside[m]);
    }
  }
  for (const Machine& machine : alone) contact_changes += machine.state.contact_changes;
  EXPECT_GT(contact_changes, 10) << "the run must cross the play to say anything";
  int in_lanes = 0;
  for (const MachineGroup& group : batch.groups) in_lanes += group.plants ? 1 : 0;
  return in_lanes;
}

TEST(MachineBatch, EveryMachineHasTheBitsThatItHasAlone) {
  EXPECT_EQ(compare({machine_with({}), machine_with({}, 1.1), machine_with({typical("torque_lag")}), machine_with({typical("hoisting")}, 0.9),
                     machine_with({typical("encoder_ripple")})},
                    5000),
            1);
}

TEST(MachineBatch, MachinesOfOtherMeshesGoIntoLanesOfTheirOwn) {
  EXPECT_EQ(compare({machine_with({}), machine_with({}, 1.1), machine_with({}, 1.2), machine_with({}, 1.0, 4), machine_with({}, 1.1, 4),
                     machine_with({}, 1.2, 4), machine_with({}, 1.0, 2)},
                    3000),
            2);
}

// Dry friction is solved out of line, and so is a force along the boom: such machines are soon stepped one by one again.
TEST(MachineBatch, MachinesThatAreMostlyOutOfLineLeaveTheLanes) {
  const common::EffectInstance brake{"dragging_brake", {5.0, 0.0, 0.0}};  // [Nm] per motor, without give
  EXPECT_EQ(compare({machine_with({brake}), machine_with({brake}, 1.1), machine_with({brake}, 0.9)}, 3000), 0);
  EXPECT_EQ(compare({machine_with({typical("wind")}), machine_with({typical("wind")}, 1.1), machine_with({typical("wind")}, 0.9)}, 3000), 0);
}

// Hoisting goes on in lanes. A boom that luffs changes its modes as it goes, so that its machine is stepped alone.
TEST(MachineBatch, MachinesThatMoveHaveTheBitsThatTheyHaveAlone) {
  const auto moving = [](double share, bool luffs) {
    MachineSettings settings = machine_with({}, share);
    settings.crane.motions = {.hoisting = {0.5, 0.75}, .shortest_rope = 5.0, .luffing = {0.02, 0.01}, .lowest_angle = 0.2, .highest_angle = 1.5,
                              .travelling = {}, .travel_direction = 0.0};
    settings.motion_requests.hoisting = {{0, 1.0}};
    if (luffs) settings.motion_requests.luffing = {{0, -1.0}};
    return settings;
  };
  EXPECT_EQ(compare({moving(1.0, false), moving(1.1, false), machine_with({typical("encoder_ripple")}), moving(0.9, false)}, 3000), 1);
  EXPECT_EQ(compare({moving(1.0, true), moving(1.1, true), moving(0.9, true), machine_with({}), machine_with({}, 1.1), machine_with({}, 0.9)}, 3000), 1);
}

TEST(MachineBatch, AStepAllocatesNothing) {
  std::vector<Machine> machines = machines_of({machine_with({}), machine_with({typical("torque_lag")}), machine_with({}, 1.1)});
  MachineBatch batch = make_machine_batch(pointers(machines));
  const tests::AllocationGuard guard;
  for (std::int64_t k = 0; k < 3000; ++k) step(batch, command_at(k));
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace slewlab::sim
