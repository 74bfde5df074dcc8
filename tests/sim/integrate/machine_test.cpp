#include "sim/integrate/machine.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "sim/effects/catalogue.h"
#include "tests/common/allocation_guard.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

DriveCommand command_at(std::int64_t k) {
  DriveCommand command;
  command.sequence = k / 10;
  const double time = 1e-3 * static_cast<double>(k);
  command.motor_torque = {150.0 * std::sin(0.7 * time) + 40.0, 150.0 * std::sin(0.7 * time) - 40.0};
  return command;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

void expect_same_bits(const PlantState& a, const PlantState& b) {
  ASSERT_EQ(a.step_count, b.step_count);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(same_bits(a.motor_angle[i], b.motor_angle[i]));
    EXPECT_TRUE(same_bits(a.motor_speed[i], b.motor_speed[i]));
    EXPECT_TRUE(same_bits(a.gear_torque[i], b.gear_torque[i]));
    EXPECT_EQ(a.play_crossings[i], b.play_crossings[i]);
  }
  for (std::size_t k = 0; k < a.q.size(); ++k) {
    EXPECT_TRUE(same_bits(a.q[k], b.q[k])) << k;
    EXPECT_TRUE(same_bits(a.v[k], b.v[k])) << k;
  }
  for (std::size_t j = 0; j < 2; ++j) EXPECT_TRUE(same_bits(a.load_q[j], b.load_q[j]));
  EXPECT_TRUE(same_bits(a.supplied_work, b.supplied_work));
}

TEST(Machine, WithoutEffectsIsTheBarePlantToTheBit) {
  const CraneParameters crane = thesis_crane();
  Machine machine = make_machine({.crane = crane, .effects = {}});
  const PlantModel model = make_plant_model(crane, 0.001);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  for (std::int64_t k = 0; k < 5000; ++k) {
    const DriveCommand command = command_at(k);
    PlantInput input;
    input.motor_torque = command.motor_torque;
    step(machine, command);
    step(model, workspace, input, state);
  }
  expect_same_bits(machine.state, state);
  EXPECT_EQ(machine.effect_evaluations, 0);
  EXPECT_GT(state.contact_changes, 0) << "the run must cross the play to say anything";
}

// Brakes that drag with 5 Nm per motor, the same at both groups.
MachineSettings dragging() { return {.crane = thesis_crane(), .effects = {{"dragging_brake", {5.0, 0.0, 0.0}}}}; }

// A gain is of the accelerometer: of what moves the crane and of what an effect adds to its reading, and the crane moves as it does without.
TEST(Machine, AnAccelerometerReadsByItsGain) {
  for (const std::vector<common::EffectInstance>& effects : {std::vector<common::EffectInstance>{}, {{"gearbox_mesh_variation", {0.01, 0.0, 0.0, 0.0}}}}) {
    CraneParameters crane = thesis_crane();
    Machine machine = make_machine({.crane = crane, .effects = effects});
    crane.sensors.middle_gain = 0.97;
    crane.sensors.tip_gain = 1.04;
    Machine other = make_machine({.crane = crane, .effects = effects});
    for (std::int64_t k = 0; k < 500; ++k) {
      step(machine, command_at(k));
      step(other, command_at(k));
    }
    const MachineReadings readings = read(machine), by_gain = read(other);
    EXPECT_GT(std::fabs(readings.tip_acceleration), 1e-3);
    EXPECT_DOUBLE_EQ(by_gain.tip_acceleration, 1.04 * readings.tip_acceleration);
    EXPECT_DOUBLE_EQ(by_gain.middle_acceleration, 0.97 * readings.middle_acceleration);
    EXPECT_EQ(by_gain.pivot_acceleration, readings.pivot_acceleration);
    EXPECT_EQ(by_gain.house_acceleration, readings.house_acceleration);
    expect_same_bits(machine.state, other.state);
  }
}

TEST(Machine, AnEffectThatIsOffChangesNoBit) {
  Machine bare = make_machine({.crane = thesis_crane(), .effects = {}});
  Machine machine = make_machine(dragging());
  ASSERT_TRUE(switch_effect(machine, "dragging_brake", false));
  for (std::int64_t k = 0; k < 2000; ++k) {
    step(bare, command_at(k));
    step(machine, command_at(k));
  }
  expect_same_bits(machine.state, bare.state);
}

TEST(Machine, AnEffectIsSwitchedWhenItsTimeComesAsByHand) {
  MachineSettings scheduled = dragging();
  scheduled.effect_switches = {{.time = 300'000'000, .effect = "dragging_brake", .on = false}, {.time = 900'000'000, .effect = "dragging_brake", .on = true}};
  Machine by_time = make_machine(scheduled), by_hand = make_machine(dragging()), never = make_machine(dragging());
  for (std::int64_t k = 0; k < 2000; ++k) {  // of 1 ms
    if (k == 300) switch_effect(by_hand, "dragging_brake", false);
    if (k == 900) switch_effect(by_hand, "dragging_brake", true);
    step(by_time, command_at(k));
    step(by_hand, command_at(k));
    step(never, command_at(k));
  }
  expect_same_bits(by_time.state, by_hand.state);
  EXPECT_NE(by_time.state.motor_speed[0], never.state.motor_speed[0]);
}

TEST(Machine, OnlyWhatActsWhileItRunsIsSwitched) {
  Machine machine = make_machine({.crane = thesis_crane(), .effects = {{"boom_damping", {3.0}}}});  // changes a parameter
  EXPECT_FALSE(switch_effect(machine, "boom_damping", false));
  EXPECT_FALSE(switch_effect(machine, "", false));
  MachineSettings wrong = dragging();
  wrong.effect_switches = {{.time = 0, .effect = "gusts", .on = false}};
  EXPECT_THROW(make_machine(wrong), std::invalid_argument);
}

TEST(Machine, ParameterEffectsEvaluateNothingInAStep) {
  Machine machine = make_machine({.crane = thesis_crane(), .effects = {{"load_mass", {1.2}}}});
  for (std::int64_t k = 0; k < 100; ++k) step(machine, command_at(k));
  EXPECT_EQ(machine.effect_evaluations, 0);
  EXPECT_DOUBLE_EQ(machine.model.parameters.load.mass, 36e3);
}

TEST(Machine, CopyRunsOnAsTheOriginalDoes) {
  Machine machine = make_machine({.crane = thesis_crane(),
                                  .effects = {{"torque_lag", {0.05, 0.3}},
                                              {"offlead", {1.0}},
                                              {"encoder_delay", {0.0123}},
                                              {"command_loss", {0.3, 5.0}}},
                                  .seed = 7});
  for (std::int64_t k = 0; k < 1000; ++k) step(machine, command_at(k));
  Machine copy = machine;
  for (std::int64_t k = 1000; k < 2000; ++k) step(machine, command_at(k));
  for (std::int64_t k = 1000; k < 2000; ++k) step(copy, command_at(k));
  expect_same_bits(machine.state, copy.state);
  EXPECT_TRUE(same_bits(read(machine).shaft_speed[0], read(copy).shaft_speed[0]));
}

TEST(Machine, SteppingAllocatesNothingWithEveryEffectOn) {
  MachineSettings settings{.crane = thesis_crane(), .effects = {}};
  for (const EffectDescription* effect : effect_catalogue()) {
    settings.effects.push_back(common::typical_instance(effects_for(thesis_crane()).at(effect->about.name)));
  }
  Machine machine = make_machine(settings);
  const tests::AllocationGuard guard;
  for (std::int64_t k = 0; k < 500; ++k) {
    step(machine, command_at(k));
    read(machine);
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(machine.effect_evaluations, 0);
}

// Every value of every effect at its bounds makes a machine that runs and stays finite, or is refused.
TEST(Machine, BoundsOfEveryEffectRunOrAreRefused) {
  const common::EffectCatalogue catalogue = effects_for(thesis_crane());
  for (const EffectDescription* effect : effect_catalogue()) {
    const common::EffectAbout& about = catalogue.at(effect->about.name);
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      for (const bool upper : {false, true}) {
        common::EffectInstance instance = common::typical_instance(about);
        const common::EffectParameter& parameter = about.parameters[p];
        instance.values[p] = upper ? parameter.upper : parameter.lower;
        try {
          Machine machine = make_machine({.crane = thesis_crane(), .effects = {instance}});
          for (std::int64_t k = 0; k < 3000; ++k) step(machine, command_at(k));
          const double tip = read(machine).tip_acceleration;
          EXPECT_TRUE(std::isfinite(tip) && std::fabs(tip) < 50.0)
              << effect->about.name << " " << parameter.name << (upper ? " upper" : " lower") << " tip "
              << tip;
        } catch (const std::invalid_argument& refused) {
          EXPECT_NE(std::string(refused.what()).find(effect->about.name), std::string::npos)
              << refused.what();
        }
      }
    }
  }
}

// Teeth that chattered under a force of an effect would meet and part more often the shorter the step.
TEST(Machine, NoEffectMakesTheTeethChatter) {
  constexpr double kStep = 0.00025, kDuration = 15.0;
  const auto contact_changes = [&](const std::vector<common::EffectInstance>& effects) {
    Machine machine = make_machine({.crane = thesis_crane(), .effects = effects, .step = kStep});
    for (std::int64_t k = 0; k < std::lround(kDuration / kStep); ++k) step(machine, command_at(k / 4));
    return machine.state.contact_changes;
  };
  const auto without = contact_changes({});
  for (const EffectDescription* effect : effect_catalogue()) {
    EXPECT_LT(contact_changes({common::typical_instance(effects_for(thesis_crane()).at(effect->about.name))}), 2 * without + 40)
        << effect->about.name << ", without " << without;
  }
}

TEST(Machine, RefusesWhatItDoesNotKnow) {
  const CraneParameters crane = thesis_crane();
  EXPECT_THROW(make_machine({.crane = crane, .effects = {{"gremlins", {1.0}}}}), std::invalid_argument);
  EXPECT_THROW(make_machine({.crane = crane, .effects = {{"torque_lag", {}}}}), std::invalid_argument);
  EXPECT_THROW(make_machine({.crane = crane, .effects = {{"torque_lag", {9.0, 0.0}}}}), std::invalid_argument);
  EXPECT_THROW(make_machine({.crane = crane, .effects = {{"torque_lag", {std::nan(""), 0.0}}}}),
               std::invalid_argument);
  EXPECT_THROW(make_machine({.crane = crane, .effects = {{"torque_lag", {0.1, 0.0}}, {"torque_lag", {0.2, 0.0}}}}),
               std::invalid_argument);
}

// The brake holds the motors against their torque up to its level: at rest nothing moves.
TEST(Machine, ClosedBrakesHoldTheMotors) {
  Machine machine = make_machine({.crane = thesis_crane(), .effects = {}});
  DriveCommand command;
  command.motor_torque = {100.0, 100.0};
  command.brake_torque = {500.0, 500.0};
  for (int k = 0; k < 1000; ++k) step(machine, command);
  EXPECT_EQ(read(machine).shaft_position[0], 0.0);
  command.enable = false;
  command.brake_torque = {};
  for (int k = 0; k < 1000; ++k) step(machine, command);
  EXPECT_EQ(read(machine).shaft_position[0], 0.0) << "disabled drives deliver no torque";
}

// One inertia behind a rigid drive, 12 kg m^2 and 0.002 kg m^2 * 50^2 of the motor: 150 Nm less the friction's 50.
TEST(Machine, EffectsReachAMachineOfOneInertia) {
  MachineSettings settings;
  settings.crane.boom.element_count = 0;
  settings.crane.drive = {.group_count = 1, .motors_per_group = 1, .motor_inertia = 0.002, .gearbox_ratio = 50.0,
                          .rated_torque = 8.0, .top_speed = 2.0, .is_rigid = true};
  settings.crane.house.inertia = 12.0;
  settings.effects = {{"bearing_coulomb", {50.0, 0.0, 0.0}}};
  Machine machine = make_machine(settings);
  DriveCommand command;
  command.motor_torque[0] = 150.0 / 50.0;
  for (int k = 0; k < 1000; ++k) step(machine, command);
  EXPECT_NEAR(machine.state.house_speed, 100.0 / 17.0, 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
