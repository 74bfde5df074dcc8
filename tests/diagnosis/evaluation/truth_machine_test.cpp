// The truth machine without any law against the plant of sim/integrate in a closed loop on the same mesh: two
// integrators, one physics.
#include "diagnosis/evaluation/truth_machine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/controller_file.h"
#include "diagnosis/evaluation/draw.h"
#include "diagnosis/evaluation/law.h"
#include "sim/machine/machine_file.h"
#include "sim/integrate/machine.h"

namespace slewlab::diagnosis::withheld {
namespace {

const std::string kConfig = std::string(SLEWLAB_SOURCE_DIR) + "/config/";

sim::CraneParameters nominal_crane() { return sim::load_machine_file(kConfig + "cranes/thesis.yaml").parameters; }
controller::ControllerSettings nominal_controller() {
  controller::ControllerSettings settings = controller::load_controller_file(kConfig + "controllers/thesis.yaml").settings;
  settings.period = kBaseStep;
  return settings;
}

// How far the plant is from the truth machine at the same torques. Without counting: a fine encoder and the mean of one base step as
// speed would still differ from the plant's ideal speed, so the loop is compared open, at the torques that the truth's controller gave.
struct Distance {
  double tip;    // [-] of the tip's acceleration, RMS to RMS
  double speed;  // [rad/s] largest of the first motors
};
Distance distance_to_plant(TruthMachine machine, const std::vector<common::EffectInstance>& effects) {
  machine.noise.accelerometer = 0.0;
  machine.noise.slew_resolution = 1e-12;
  const Manoeuvre manoeuvre{{{0.5, 0.8}, {4.0, 0.0}}, 8.0};
  const TruthRun run = run_truth(machine, manoeuvre, {.noise_seed = 1, .reference = {.tolerance = 1e-8}});

  sim::MachineSettings settings;
  settings.crane = machine.crane;
  settings.step = kBaseStep;
  settings.effects = effects;
  sim::Machine plant = sim::make_machine(settings);
  double tip_square = 0.0, difference_square = 0.0, speed_difference = 0.0;
  for (std::size_t n = 0; n + 1 < run.sensors.size(); ++n) {
    sim::DriveCommand command;
    for (int i = 0; i < run.group_count; ++i) command.motor_torque[i] = run.motor_torque[i][n];
    sim::step(plant, command);
    const sim::MachineReadings readings = sim::read(plant);
    const double difference = readings.tip_acceleration - run.sensors[n + 1].tip_acceleration;
    tip_square += readings.tip_acceleration * readings.tip_acceleration;
    difference_square += difference * difference;
    speed_difference = std::max(speed_difference, std::fabs(readings.shaft_speed[0] - run.true_speed[0][n + 1]));
  }
  return {std::sqrt(difference_square / tip_square), speed_difference};
}

TEST(TruthMachine, WithoutALawItMovesAsThePlantDoesUnderTheSameTorques) {
  const Distance distance = distance_to_plant(make_truth_machine(nominal_crane(), nominal_controller()), {});
  // The plant's error at 1 ms against SUNDIALS; most of it at the two impacts of the start.
  EXPECT_LT(distance.tip, 0.01);
  EXPECT_LT(distance.speed, 0.01);  // [rad/s], of 110
}

// On an inclined crane both begin with the load where gravity holds it: the same swing under the same torques, not one about
// the place that a level crane's load has.
TEST(TruthMachine, OnAnInclineItMovesAsThePlantDoesUnderTheSameTorques) {
  TruthMachine machine = make_truth_machine(nominal_crane(), nominal_controller());
  Random random(1, "incline");
  const std::vector<TrueSize> sizes = law_named("inclined_crane").apply(machine, 0.02, random);
  EXPECT_LT(distance_to_plant(machine, {{"heel", {sizes[0].value, sizes[1].value}}}).tip, 0.01);
}

TEST(TruthMachine, SameSeedSameRunOtherSeedOtherNoise) {
  const TruthMachine machine = make_truth_machine(nominal_crane(), nominal_controller());
  const Manoeuvre manoeuvre{{{0.2, 0.5}}, 1.0};
  const TruthRun one = run_truth(machine, manoeuvre, {.noise_seed = 1}), two = run_truth(machine, manoeuvre, {.noise_seed = 1}),
                 other = run_truth(machine, manoeuvre, {.noise_seed = 2});
  EXPECT_EQ(one.shaft_speed[0], two.shaft_speed[0]);
  EXPECT_EQ(one.motor_torque[0], two.motor_torque[0]);
  EXPECT_EQ(one.sensors.back().tip_acceleration, two.sensors.back().tip_acceleration);
  EXPECT_NE(one.sensors.back().tip_acceleration, other.sensors.back().tip_acceleration);
}

// The controller's side of the wire is cut exactly: a controller of the nominal settings that is fed with the
// measured speeds answers with the recorded torques, bit for bit.
TEST(TruthMachine, TorquesAreTheNominalControllersAnswerToTheMeasuredSpeeds) {
  const controller::ControllerSettings settings = nominal_controller();
  const Manoeuvre manoeuvre{{{0.2, 0.5}}, 2.0};
  const TruthRun run = run_truth(make_truth_machine(nominal_crane(), settings), manoeuvre, {.noise_seed = 1});
  controller::ControllerState state;
  controller::ControllerOutput output;
  for (std::size_t n = 0; n < run.shaft_speed[0].size(); ++n) {
    controller::ControllerInput input;
    input.simulated_time = static_cast<std::int64_t>(n) * 1'000'000;
    input.group_count = run.group_count;
    input.speed_request = static_cast<double>(n) * 1e-3 >= 0.2 ? 0.5 : 0.0;
    for (int i = 0; i < run.group_count; ++i) input.shaft_speed[i] = run.shaft_speed[i][n];
    controller::step(settings, state, input, output);
    for (int i = 0; i < run.group_count; ++i) ASSERT_EQ(output.motor_torque[i], run.motor_torque[i][n]) << n;
  }
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
