#include <cmath>
#include <numbers>

#include "diagnosis/evaluation/body.h"
#include "diagnosis/evaluation/bristle.h"
#include "diagnosis/evaluation/law.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;
// Rollers and raceway give 5e-5 rad before they slide: a spring of about the gears' stiffness at 2e5 Nm.
constexpr Bristle kBearing{.angle = 5e-5, .settle = 1e-3};

double drawn_asymmetry(Random& random) { return random.uniform() < 0.5 ? 0.0 : random.between(-0.4, 0.4); }

std::vector<TrueSize> bearing_coulomb(TruthMachine& machine, double size, Random& random) {
  const double asymmetry = drawn_asymmetry(random);
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces,
                                              double* rates) {
    const double speed = scene.motion.house_speed;
    const BristleAnswer answer =
        bristle_answer(kBearing, size * (1.0 + asymmetry * std::tanh(states[0] / 0.2)), speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
  }});
  return {{"torque", size}, {"asymmetry", asymmetry}};
}

std::vector<TrueSize> bearing_stribeck(TruthMachine& machine, double size, Random& random) {
  const double excess = size * random.between(0.5, 1.5);
  const double stribeck_speed = random.log_between(0.002, 0.02);  // [rad/s]
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces,
                                              double* rates) {
    const double speed = scene.motion.house_speed;
    const double level = size + excess * std::exp(-std::fabs(speed) / stribeck_speed);
    const BristleAnswer answer = bristle_answer(kBearing, level, speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
  }});
  return {{"coulomb_torque", size},
          {"breakaway_excess", excess, false},
          {"stribeck_speed", stribeck_speed, false},
          {"asymmetry", 0.0}};
}

std::vector<TrueSize> bearing_viscous(TruthMachine& machine, double size, Random& random) {
  const double asymmetry = drawn_asymmetry(random);
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kReferenceSpeed = 0.03;  // [rad/s] at which the coefficient is what it says
    constexpr double kPower = 0.85;           // [-] grease thins with shear
    constexpr double kSmall = 1e-4;           // [rad/s] below which the law is linear
    const double speed = scene.motion.house_speed;
    const double direction = 1.0 + asymmetry * std::tanh(speed / kSmall);
    const double relative = std::sqrt(speed * speed + kSmall * kSmall) / kReferenceSpeed;
    forces.house_torque -= size * direction * speed * std::pow(relative, kPower - 1.0);
  }});
  return {{"coefficient", size}, {"asymmetry", asymmetry}};
}

std::vector<TrueSize> house_inertia(TruthMachine& machine, double size, Random&) {
  const double factor = 1.0 + size;
  machine.crane.house.inertia *= factor;
  return {{"factor", factor}};
}

std::vector<TrueSize> house_compliance(TruthMachine& machine, double size, Random&) {
  machine.structure.ring_stiffness = size;
  return {{"stiffness", size}};
}

std::vector<TrueSize> pedestal_flexibility(TruthMachine& machine, double size, Random& random) {
  StructureChange& structure = machine.structure;
  structure.pedestal_stiffness = size;
  structure.pedestal_mass = random.log_between(1.5e5, 6e5);        // [kg]
  structure.pedestal_damping_ratio = random.log_between(0.01, 0.04);
  return {{"stiffness", size},
          {"top_mass", structure.pedestal_mass, false},
          {"damping_ratio", structure.pedestal_damping_ratio, false}};
}

std::vector<TrueSize> heel(TruthMachine& machine, double size, Random& random) {
  const double direction = random.between(-kPi, kPi);
  const auto sideways = [=](double slew_angle) {
    return sim::kGravity * std::sin(size) * std::sin(direction - slew_angle);
  };
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double f = sideways(scene.motion.house_angle);
    add_body_force(scene, f, f, forces);
    // The rope carries less: cos(heel) of gravity is left along it.
    const double lost = scene.rope_stiffness * (1.0 - std::cos(size)) *
                        (scene.motion.rope_end_displacement - scene.motion.tip_displacement);
    forces.load_force += lost;
    forces.tip_force -= lost;
  }});
  machine.sensors.emplace_back([=](double, const SensorValues& truth, SensorValues& seen) {
    const double f = sideways(truth.slew_angle);
    for (double* value : {&seen.house, &seen.pivot, &seen.middle, &seen.tip}) *value -= f;
  });
  return {{"angle", size}, {"direction", direction, false}};
}

}  // namespace

std::vector<Law> house_laws() {
  return {
      {"bearing_bristles", "bearing_coulomb", "house", "bristles instead of dry friction", 3e3, 4e5, bearing_coulomb},
      {"thinning_grease", "bearing_viscous", "house", "power 0.85 of the speed", 1e5, 1.5e7, bearing_viscous},
      {"bearing_bristles_breaking_away", "bearing_stribeck", "house",
       "bristles, and an exponential instead of a Gaussian fall", 3e3, 3e5, bearing_stribeck},
      {"heavy_house", "house_inertia", "house", "finer mesh only", 0.3, 20.0, house_inertia, {"house inertia"}},
      {"slew_ring", "house_compliance", "house", "the ring is a body of its own", 1e11, 2e9, house_compliance},
      {"pedestal_mode", "pedestal_flexibility", "house", "a degree of freedom of the structure", 8e9, 4e7,
       pedestal_flexibility},
      {"inclined_crane", "heel", "house", "sine of the angle, and gravity lost along the rope", 5e-4, 0.04, heel},
  };
}

}  // namespace slewlab::diagnosis::withheld
