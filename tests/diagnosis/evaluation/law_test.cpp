// Laws one by one at points where their value is known by hand.
#include "diagnosis/evaluation/law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "controller/controller_file.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/evaluation/bristle.h"
#include "sim/effects/catalogue.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis::withheld {
namespace {

TruthMachine machine_with(const std::string& law, double size) {
  TruthMachine machine = make_truth_machine(sim::thesis_crane(16), {});
  Random random(1, "test");
  law_named(law).apply(machine, size, random);
  return machine;
}

// A crane that slews as one body at `speed`, its load hanging straight.
struct Still {
  GroupArray motor_angle{}, motor_speed{}, gear_torque{};
  sim::ReferenceMotion motion;
  sim::CraneParameters crane = sim::thesis_crane(16);
  explicit Still(double speed) {
    motor_speed.fill(speed);
    motion.motor_angle = motor_angle.data();
    motion.motor_speed = motor_speed.data();
    motion.gear_torque = gear_torque.data();
    motion.house_speed = speed;
  }
  Scene scene() const { return {motion, crane, 2, 31.3, crane.load.mass * sim::kGravity / crane.load.rope_length}; }
  sim::ReferenceForces forces(const TruthMachine& machine, const std::vector<double>& states) const {
    sim::ReferenceForces sum;
    std::vector<double> rates(states.size() + 1);
    machine.forces.at(0).act(scene(), states.data(), sum, rates.data());
    return sum;
  }
};

TEST(Law, NamesAreUniqueAndSizesPositive) {
  std::set<std::string> names;
  for (const Law& law : laws()) {
    EXPECT_TRUE(names.insert(law.name).second) << law.name;
    EXPECT_GT(law.low, 0.0) << law.name;
    EXPECT_GT(law.high, 0.0) << law.name;
  }
}

// Every law that has an effect of the catalogues fits it: name, subsystem, parameters, bounds; and no two have the same. An
// effect without a law of its own is not drawn.
TEST(Law, FitsTheEffectThatItIs) {
  const controller::ControllerSettings settings = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
  const common::EffectCatalogue catalogue = joined(sim::effects_for(sim::thesis_crane()), controller::effects_for(settings));
  std::ptrdiff_t fitting = 0;
  for (const common::EffectAbout& effect : catalogue.effects) {
    const common::EffectAbout* about = &effect;
    int found = 0;
    for (const Law& law : laws()) {
      if (law.effect != about->name) continue;
      ++found;
      EXPECT_EQ(law.subsystem, common::name_of(about->subsystem)) << law.name;
      for (const double size : {law.low, law.high}) {
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
          TruthMachine machine = make_truth_machine(sim::thesis_crane(16), {});
          Random random(seed, "test");
          for (const TrueSize& value : law.apply(machine, size, random)) {
            const auto parameter =
                std::find_if(about->parameters.begin(), about->parameters.end(),
                             [&](const common::EffectParameter& p) { return p.name == value.parameter; });
            ASSERT_NE(parameter, about->parameters.end()) << law.name << " " << value.parameter;
            EXPECT_GE(value.value, parameter->lower) << law.name << " " << value.parameter;
            EXPECT_LE(value.value, parameter->upper) << law.name << " " << value.parameter;
          }
        }
      }
    }
    EXPECT_LE(found, 1) << about->name;
    fitting += found;
  }
  const auto named = std::count_if(laws().begin(), laws().end(), [](const Law& law) { return !law.effect.empty(); });
  EXPECT_EQ(fitting, named);
  EXPECT_GE(named, 48);
}

TEST(Law, SlidingBristlesCarryTheLevelAndRestThere) {
  const Bristle bristle{.angle = 1e-4, .settle = 1e-3};
  const BristleAnswer sliding = bristle_answer(bristle, 500.0, 0.03, 1.0);
  EXPECT_DOUBLE_EQ(sliding.torque, 500.0);
  EXPECT_DOUBLE_EQ(sliding.rate, 0.0);
  const BristleAnswer held = bristle_answer(bristle, 500.0, 0.0, 0.4);  // at rest it holds what it held
  EXPECT_DOUBLE_EQ(held.torque, 200.0);
  EXPECT_DOUBLE_EQ(held.rate, 0.0);
}

TEST(Law, BearingBristlesSlideAtTheSizeAgainstTheMotion) {
  const TruthMachine machine = machine_with("bearing_bristles_breaking_away", 1e5);
  // Ten Stribeck speeds (at most 0.02 rad/s) on, the breakaway excess has fallen below 1e-4 of itself.
  EXPECT_NEAR(Still(0.2).forces(machine, {1.0}).house_torque, -1e5, 20.0);
  EXPECT_NEAR(Still(-0.2).forces(machine, {-1.0}).house_torque, 1e5, 20.0);
}

TEST(Law, ThinningGreaseHasItsCoefficientAtTheReferenceSpeed) {
  TruthMachine machine = make_truth_machine(sim::thesis_crane(16), {});
  Random random(1, "test");
  const std::vector<TrueSize> sizes = law_named("thinning_grease").apply(machine, 1e6, random);
  const double forth = Still(0.03).forces(machine, {}).house_torque, back = Still(-0.03).forces(machine, {}).house_torque;
  EXPECT_NEAR(0.5 * (back - forth), 1e6 * 0.03, 1.0);
  EXPECT_NEAR((back + forth) / (forth - back), sizes[1].value, 1e-3);  // the asymmetry
}

TEST(Law, BrakeBristlesCarryTheirTorquePerMotor) {
  TruthMachine machine = make_truth_machine(sim::thesis_crane(16), {});
  Random random(1, "test");
  law_named("brake_bristles").apply(machine, 20.0, random);
  const sim::ReferenceForces forces = Still(0.03).forces(machine, {1.0, 1.0});
  // The mean of both groups: 3 motors of 20 Nm behind the ratio 215.4 * 12.7.
  EXPECT_NEAR(-0.5 * (forces.motor_torque[0] + forces.motor_torque[1]), 20.0 * 3 * 215.4 * 12.7, 1e-6);
}

TEST(Law, TwoLagsTogetherDelayASlowRampByTheSize) {
  TruthMachine machine = machine_with("lag_of_two", 0.05);
  TorqueLaw& law = machine.torque.at(0);
  GroupArray torque{};
  for (int n = 0; n < 2000; ++n) {
    torque.fill(100.0 * n * kBaseStep);
    law(0.0, {}, {}, torque);
  }
  // Each lag of 25 ms, sampled every 0.1 ms with its input held, follows a ramp with its time constant, but for the
  // sampling: half a sub-step each. The mean over the step adds nothing, its input being held too.
  EXPECT_NEAR((100.0 * 1999 * kBaseStep - torque[0]) / 100.0, 0.05, 1e-3);
}

TEST(Law, DeadTimeOfADriveThatSamples) {
  TruthMachine machine = machine_with("sampled_dead_time", 0.02);
  GroupArray torque{};
  double mean_delay = 0.0;
  for (int n = 0; n < 1000; ++n) {
    torque.fill(static_cast<double>(n));
    machine.torque.at(0)(0.0, {}, {}, torque);
    if (n >= 900) mean_delay += (n - torque[0]) * kBaseStep / 100.0;
  }
  EXPECT_NEAR(mean_delay, 0.02, 1e-9);
}

TEST(Law, SoftLimitLetsSmallTorquesPassAndStopsLargeOnes) {
  TruthMachine machine = machine_with("soft_limit", 150.0);
  GroupArray torque{};
  torque[0] = 60.0;
  torque[1] = -3000.0;
  machine.torque.at(0)(0.0, {}, {}, torque);
  EXPECT_NEAR(torque[0], 60.0, 0.01);
  EXPECT_NEAR(torque[1], -150.0, 1e-6);
}

TEST(Law, CommandDelayIsTheSizeOnTheAverage) {
  TruthMachine machine = machine_with("beating_bus", 0.02);
  double mean_delay = 0.0;
  constexpr int kPeriod = 10'000;  // three beats of 0.3 Hz
  for (int n = 0; n < 100 + kPeriod; ++n) {
    GroupArray torque{};
    torque.fill(static_cast<double>(n));
    machine.wire.at(0)(n * kBaseStep, n, torque);
    if (n >= 100) mean_delay += (n - torque[0]) * kBaseStep / kPeriod;
  }
  EXPECT_NEAR(mean_delay, 0.02, 1e-5);
}

TEST(Law, BurstsLoseTheShareThatTheSizeSays) {
  TruthMachine machine = machine_with("bursts_of_loss", 0.4);
  int lost = 0;
  constexpr int kMessages = 200'000;
  for (int n = 0; n < kMessages; ++n) {
    GroupArray torque{};
    torque.fill(static_cast<double>(n + 1));
    machine.wire.at(0)(n * kBaseStep, n, torque);
    lost += torque[0] != n + 1 ? 1 : 0;
  }
  // Bursts of 25 on the average: some 3200 of them, so the share is known to about 2 %.
  EXPECT_NEAR(static_cast<double>(lost) / kMessages, 0.4, 0.03);
}

TEST(Law, EncoderDelayIsTheSize) {
  TruthMachine machine = machine_with("late_encoder", 0.02);
  GroupArray position{};
  for (int n = 0; n < 500; ++n) {
    position.fill(3.0 * n * kBaseStep);
    machine.encoder.at(0)(n * kBaseStep, position);
  }
  EXPECT_NEAR(3.0 * 499 * kBaseStep - position[0], 3.0 * 0.02, 1e-9);
}

TEST(Law, PlayMapKeepsTheAverage) {
  controller::ControllerSettings settings;
  settings.play_compensation = {.enabled = true, .point_count = 2, .points = {{{0.0, 0.1, -0.1}, {0.2, 0.5, -0.1}}}};
  TruthMachine machine = make_truth_machine(sim::thesis_crane(16), settings);
  Random random(1, "test");
  const double factor = law_named("play_map").apply(machine, 0.5, random)[0].value;
  const controller::PlayMapPoint& point = machine.controller.play_compensation.points[1];
  EXPECT_NEAR(point.half_1, 0.2 + factor * 0.3, 1e-12);
  EXPECT_NEAR(point.half_2, 0.2 - factor * 0.3, 1e-12);
}

// The elastic rope, as long as at rest, pulls as the small-angle rope does, to first order in the angle.
TEST(Law, TrueRopeEqualsTheSmallAngleRopeForSmallAngles) {
  const TruthMachine machine = machine_with("true_pendulum", 1.0);
  Still still(0.0);
  still.motion.rope_end_displacement = 0.06;  // [m], 1 mrad
  const double length = still.crane.load.rope_length;
  const sim::ReferenceForces forces = still.forces(machine, {-0.06 * 0.06 / (2.0 * length), 0.0});
  const double linear = still.scene().rope_stiffness * 0.06;
  // Stretched by M g / k = 3 cm the rope is 0.05 % longer than the small-angle one.
  EXPECT_NEAR(forces.load_force, 0.0005 * linear, 0.0001 * linear);
  EXPECT_DOUBLE_EQ(forces.load_force, -forces.tip_force);
}

TEST(Law, AirDragHasItsAreaAtTheReferenceSpeed) {
  const TruthMachine machine = machine_with("drag_by_power", 200.0);
  Still still(0.0);
  still.motion.rope_end_velocity = 1.5;
  EXPECT_NEAR(still.forces(machine, {}).load_force, -0.5 * 1.225 * 200.0 * 1.5 * 1.5, 0.01);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
