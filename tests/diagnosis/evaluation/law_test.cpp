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
#include "sim/machine/machine_file.h"
#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis::withheld {
namespace {

TruthMachine machine_with(const std::string& law, double size) {
  TruthMachine machine = make_truth_machine(sim::thesis_crane(16), {});
  Random random(1, "test");
  law_named(law).apply(machine, size, random);
  return machine;
}

const std::string kConfig = SLEWLAB_SOURCE_DIR "/config/";

sim::CraneParameters crane_of(const std::string& name) {
  return sim::load_machine_file(kConfig + "cranes/" + name + ".yaml").parameters;
}
controller::ControllerSettings controller_of(const std::string& name) {
  return controller::load_controller_file(kConfig + "controllers/" + name + ".yaml").settings;
}
common::EffectCatalogue effects_of(const std::string& name) {
  return joined(sim::effects_for(crane_of(name)), controller::effects_for(controller_of(name)));
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

// Every effect of both catalogues can be drawn, under its own name, subsystem and parameters, within its bounds.
class LawsOfACrane : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Law, LawsOfACrane, testing::Values("thesis", "harbour_5t", "offshore_900t"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(LawsOfACrane, EveryEffectOfTheCataloguesHasALawThatFitsIt) {
  const common::EffectCatalogue catalogue = effects_of(GetParam());
  const TruthMachine nominal = make_truth_machine(crane_of(GetParam()), controller_of(GetParam()));
  std::ptrdiff_t fitting = 0;
  for (const common::EffectAbout& effect : catalogue.effects) {
    const common::EffectAbout* about = &effect;
    int found = 0;
    for (const Law& law : laws()) {
      if (law.effect != about->name) continue;
      ++found;
      EXPECT_EQ(law.subsystem, common::name_of(about->subsystem)) << law.name;
      const double unit = law.unit(nominal.scales);
      for (const double size : {law.low * unit, law.high * unit}) {
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
          TruthMachine machine = nominal;
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
  EXPECT_GE(fitting, 40);
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

// Half a unit each of x and x^3 at the angle of two ramps.
TEST(Law, AWoundCableHasItsTorqueAtTheAngleOfTwoRamps) {
  const TruthMachine machine = machine_with("wound_cable", 700.0);
  Still still(0.0);
  still.motion.house_angle = machine.scales.machine.top_speed * machine.scales.ramp_time;
  EXPECT_NEAR(still.forces(machine, {}).house_torque, -700.0, 1e-9);
  still.motion.house_angle *= -0.5;
  EXPECT_NEAR(still.forces(machine, {}).house_torque, 0.5 * 700.0 * (0.5 + 0.125), 1e-9);
}

// Two groups at the rated torque: each loses the whole share; one alone loses nothing.
TEST(Law, ASharedSupplyTakesFromEachWhatTheOtherDraws) {
  TruthMachine machine = machine_with("shared_supply", 0.2);
  const double rated = machine.scales.machine.motor_torque;
  GroupArray torque{};
  torque[0] = rated;
  torque[1] = -0.5 * rated;
  machine.torque.at(0)(0.0, {}, {}, torque);
  EXPECT_NEAR(torque[0], 0.9 * rated, 1e-9);
  EXPECT_NEAR(torque[1], -0.5 * 0.8 * rated, 1e-9);
}

TEST(Law, OneSidedMotorsPullHarderToOneSide) {
  TruthMachine machine = machine_with("one_sided_motors", 0.1);
  GroupArray torque{};
  torque[0] = 50.0;
  torque[1] = -50.0;
  machine.torque.at(0)(0.0, {}, {}, torque);
  EXPECT_NEAR(std::fabs(torque[0] - 50.0), 5.0, 1e-12);
  EXPECT_NEAR(torque[1] + 50.0, torque[0] - 50.0, 1e-12);
}

TEST(Law, ADriftingOffsetGrowsToItsSize) {
  TruthMachine machine = machine_with("drifting_offset", 3.0);
  GroupArray torque{};
  machine.torque.at(0)(0.0, {}, {}, torque);
  EXPECT_EQ(torque[0], 0.0);
  machine.torque.at(0)(1e4, {}, {}, torque);
  EXPECT_NEAR(std::fabs(torque[0]), 3.0, 1e-12);
}

// Still in space while the house turns, it is pulled by its spring and its damper; what it feels the house gives.
TEST(Law, ALooseCounterweightPullsTheHouseAsTheHousePullsIt) {
  const TruthMachine machine = machine_with("loose_counterweight", 0.02);
  Still still(0.0);
  still.motion.house_angle = 1e-3;
  sim::ReferenceForces forces;
  const double states[] = {0.0, 0.0};
  double rates[] = {0.0, 0.0};
  machine.forces.at(0).act(still.scene(), states, forces, rates);
  EXPECT_EQ(rates[0], 0.0);
  EXPECT_GT(rates[1], 0.0);
  EXPECT_NEAR(forces.house_torque, -0.02 * machine.scales.machine.axis_inertia * rates[1], 1e-9 * std::fabs(forces.house_torque));
}

// Slack within a third of what the rated torque bends the boom by, (tip force) / (guy's unit)^(1/3) of it; then a spring, with its moment on the house.
TEST(Law, ASlackGuyTakesHoldBehindItsSlack) {
  const TruthMachine machine = machine_with("slack_guy", 5e3);
  const double slack = std::cbrt(machine.scales.tip_force / machine.scales.guy) / 3.0;
  Still still(0.0);
  still.motion.tip_displacement = 0.99 * slack;
  EXPECT_EQ(still.forces(machine, {}).tip_force, 0.0);
  still.motion.tip_displacement = -slack - 0.01;
  EXPECT_NEAR(still.forces(machine, {}).tip_force, 50.0, 1e-6);
  EXPECT_NEAR(still.forces(machine, {}).house_torque, -50.0 * still.scene().tip_radius, 1e-3);
}

TEST(Law, FieldWeakeningBeginsAtHalfTheTopSpeed) {
  TruthMachine machine = machine_with("field_weakening", 0.3);
  GroupArray torque{}, speed{};
  torque.fill(100.0);
  speed[0] = 0.5 * machine.scales.top_shaft_speed;
  speed[1] = -machine.scales.top_shaft_speed;
  machine.torque.at(0)(0.0, {}, speed, torque);
  EXPECT_NEAR(torque[0], 100.0, 1e-9);
  EXPECT_NEAR(torque[1], 70.0, 1e-9);
}

// Exponents of a quantity under masses and forces times f, and under lengths times lambda with times by sqrt(lambda).
struct Exponents {
  double of_masses, of_lengths;
};
Exponents exponents_of(common::Unit unit) {
  using common::Unit;
  switch (unit) {
    case Unit::second: return {0.0, 0.5};
    case Unit::metre: return {0.0, 1.0};
    case Unit::square_metre: return {0.0, 2.0};
    case Unit::metre_per_second: return {0.0, 0.5};
    case Unit::radian_per_second: return {0.0, -0.5};
    case Unit::kilogram:
    case Unit::newton: return {1.0, 0.0};
    case Unit::newton_per_metre: return {1.0, -1.0};
    case Unit::newton_second_per_metre: return {1.0, -0.5};
    case Unit::newton_metre:
    case Unit::newton_metre_per_radian: return {1.0, 1.0};
    case Unit::newton_metre_second_per_radian: return {1.0, 1.5};
    default: return {0.0, 0.0};
  }
}

// The air's density does not scale: what the wind does is a share of the machine's force at the tip.
Exponents exponents_of(const std::string& effect, const common::EffectParameter& parameter) {
  const bool is_wind = effect == "wind" || effect == "gusts";
  if (is_wind && parameter.unit == common::Unit::metre_per_second) return {0.5, -1.0};
  if (effect == "air_drag") return {1.0, -1.0};
  return exponents_of(parameter.unit);
}

struct ScaledMachines {
  TruthMachine one, heavier, longer;
  static constexpr double kFactor = 1e3, kLambda = 4.0;
  ScaledMachines() {
    controller::ControllerSettings controller;
    controller.ramp.acceleration_time = 4.4;
    one = make_truth_machine(sim::thesis_crane(16), controller);
    heavier = make_truth_machine(sim::with_masses_times(sim::thesis_crane(16), kFactor), controller);
    controller.ramp.acceleration_time *= std::sqrt(kLambda);
    longer = make_truth_machine(sim::with_lengths_times(sim::thesis_crane(16), kLambda), controller);
  }
};

// All that a law draws keeps its proportion to the machine.
TEST(Law, SizesFollowMassesAndLengthsOfTheMachine) {
  const common::EffectCatalogue catalogue = effects_of("thesis");
  const ScaledMachines machines;
  for (const Law& law : laws()) {
    const auto about = std::find_if(catalogue.effects.begin(), catalogue.effects.end(),
                                    [&](const common::EffectAbout& effect) { return effect.name == law.effect; });
    if (about == catalogue.effects.end()) continue;
    const auto sizes = [&](TruthMachine machine, double share) {
      Random random(7, "test");
      return law.apply(machine, share * law.unit(machine.scales), random);
    };
    const std::vector<TrueSize> one = sizes(machines.one, law.high), heavier = sizes(machines.heavier, law.high),
                                longer = sizes(machines.longer, law.high);
    for (std::size_t k = 0; k < one.size(); ++k) {
      if (one[k].value == 0.0 || one[k].parameter == "window") continue;  // the window is the drive's own clock
      const auto parameter = std::find_if(about->parameters.begin(), about->parameters.end(),
                                          [&](const common::EffectParameter& p) { return p.name == one[k].parameter; });
      ASSERT_NE(parameter, about->parameters.end()) << law.name << " " << one[k].parameter;
      const Exponents expected = exponents_of(law.effect, *parameter);
      EXPECT_NEAR(heavier[k].value / one[k].value / std::pow(ScaledMachines::kFactor, expected.of_masses), 1.0, 1e-6)
          << law.name << " " << one[k].parameter;
      EXPECT_NEAR(longer[k].value / one[k].value / std::pow(ScaledMachines::kLambda, expected.of_lengths), 1.0, 1e-6)
          << law.name << " " << one[k].parameter;
    }
  }
}

// Those that no catalogue has, by the units that their sizes have.
TEST(Law, SizesOutsideTheCatalogueFollowMassesAndLengths) {
  const std::pair<const char*, Exponents> kExpected[] = {
      {"stiffening_gears", {0.0, 0.0}}, {"slew_cogging", {1.0, 1.0}},   {"tight_spot", {1.0, 1.0}},
      {"creeping_rope", {0.0, 0.5}},    {"warming_motors", {0.0, 0.0}}, {"flat_roller", {1.0, 1.0}},
      {"stiffening_guy", {1.0, -3.0}},  // N/m^3
      {"wound_cable", {1.0, 1.0}},      {"shared_supply", {0.0, 0.0}},  {"one_sided_motors", {0.0, 0.0}},
      {"drifting_offset", {1.0, 1.0}},  {"loose_counterweight", {0.0, 0.0}},
      {"slack_guy", {1.0, -1.0}},       {"field_weakening", {0.0, 0.0}}};
  const ScaledMachines machines;
  for (const auto& [name, expected] : kExpected) {
    const Law& law = law_named(name);
    const double one = law.unit(machines.one.scales);
    EXPECT_NEAR(law.unit(machines.heavier.scales) / one / std::pow(ScaledMachines::kFactor, expected.of_masses), 1.0, 1e-6) << name;
    EXPECT_NEAR(law.unit(machines.longer.scales) / one / std::pow(ScaledMachines::kLambda, expected.of_lengths), 1.0, 1e-6) << name;
  }
}

// With M y'' = -K (y - y_tip) + F on the load and K (y - y_tip) + T on the tip, what the load gains of angular momentum M r^2 phi' the crane loses.
TEST(Law, RadialPendulumKeepsTheAngularMomentum) {
  const TruthMachine machine = machine_with("radial_pendulum", 1.0);
  Still still(0.2);
  const Scene scene = still.scene();
  const double mass = still.crane.load.mass, tip_radius = scene.tip_radius, outwards = 3.0, rate = 0.4;
  still.motion.rope_end_velocity = 0.2 * tip_radius;
  still.motion.rope_end_displacement = 1.5;
  const sim::ReferenceForces forces = still.forces(machine, {outwards, rate, 0.0, 0.0});
  const double on_tip = scene.rope_stiffness * 1.5 + forces.tip_force;
  const double acceleration = (forces.load_force - scene.rope_stiffness * 1.5) / mass / tip_radius;
  const double radius = tip_radius + outwards;
  const double gained = mass * (radius * radius * acceleration + 2.0 * radius * rate * 0.2);
  EXPECT_NEAR(gained + tip_radius * on_tip, 0.0, 1e-9 * tip_radius * on_tip);
}

// A conical pendulum: tan(alpha) = r W^2 / g on a rope of length L, u = L sin(alpha).
TEST(Law, RadialPendulumRestsAsAConicalOne) {
  const TruthMachine machine = machine_with("radial_pendulum", 1.0);
  Still still(0.2);
  still.crane.load.rod_length = 0.0;
  still.motion.rope_end_velocity = 0.2 * still.scene().tip_radius;
  const double length = still.crane.load.rope_length;
  double outwards = 0.0;
  for (int k = 0; k < 100; ++k) outwards = length * std::sin(std::atan((still.scene().tip_radius + outwards) * 0.2 * 0.2 / sim::kGravity));
  const double states[] = {outwards, 0.0, 0.0, 0.0};
  double rates[4];
  sim::ReferenceForces forces;
  machine.forces.at(0).act(still.scene(), states, forces, rates);
  EXPECT_NEAR(rates[1], 0.0, 1e-9);
  EXPECT_NEAR(forces.load_force, 0.0, 1e-6);
  EXPECT_NEAR(forces.tip_force, 0.0, 1e-6);
  EXPECT_GT(outwards, 5.0);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
