#include <cmath>
#include <numbers>

#include "diagnosis/evaluation/body.h"
#include "diagnosis/evaluation/bristle.h"
#include "diagnosis/evaluation/law.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;
// Rollers and raceway give 5e-5 rad before they slide: at a twentieth of the rated torque a spring of about the gears'
// stiffness.
Bristle bearing(const LawScales& scales) { return {.angle = 5e-5, .settle = 1.31e-3 * scales.period}; }

double drawn_asymmetry(Random& random) { return random.uniform() < 0.5 ? 0.0 : random.between(-0.4, 0.4); }

std::vector<TrueSize> bearing_coulomb(TruthMachine& machine, double size, Random& random) {
  const double asymmetry = drawn_asymmetry(random);
  const Bristle rollers = bearing(machine.scales);
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces,
                                              double* rates) {
    const double speed = scene.motion.house_speed;
    const BristleAnswer answer =
        bristle_answer(rollers, size * (1.0 + asymmetry * std::tanh(states[0] / 0.2)), speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
  }});
  return {{"torque", size}, {"asymmetry", asymmetry}};
}

std::vector<TrueSize> bearing_stribeck(TruthMachine& machine, double size, Random& random) {
  const double excess = size * random.between(0.5, 1.5);
  const double stribeck_speed = machine.scales.machine.top_speed * random.log_between(0.04, 0.4);  // [rad/s]
  const Bristle rollers = bearing(machine.scales);
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces,
                                              double* rates) {
    const double speed = scene.motion.house_speed;
    const double level = size + excess * std::exp(-std::fabs(speed) / stribeck_speed);
    const BristleAnswer answer = bristle_answer(rollers, level, speed, states[0]);
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
  const double top_speed = machine.scales.machine.top_speed;
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kPower = 0.85;                  // [-] grease thins with shear
    const double reference_speed = 0.6 * top_speed;  // [rad/s] at which the coefficient is what it says
    const double small = 0.002 * top_speed;          // [rad/s] below which the law is linear
    const double speed = scene.motion.house_speed;
    const double direction = 1.0 + asymmetry * std::tanh(speed / small);
    const double relative = std::sqrt(speed * speed + small * small) / reference_speed;
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
  structure.pedestal_mass = machine.scales.machine.boom_mass * random.log_between(1.85, 7.4);  // [kg]
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
    for (const auto& sensor : kAccelerometers<SensorValues>) seen.*sensor.value -= f;
  });
  return {{"angle", size}, {"direction", direction, false}};
}

double of_viscosity(const LawScales& s) { return s.machine.axis_torque / s.machine.top_speed; }
double of_inertia_factor(const LawScales& s) { return s.inertia_factor; }
double of_gear_stiffness(const LawScales& s) { return s.gear_stiffness; }
double of_drive_pedestal(const LawScales& s) { return s.drive_pedestal; }

}  // namespace

std::vector<Law> house_laws() {
  return {
      {"bearing_bristles", "bearing_coulomb", "house", "bristles instead of dry friction", 7.31e-4, 0.0975, of_axis_torque, bearing_coulomb},
      {"thinning_grease", "bearing_viscous", "house", "power 0.85 of the speed", 1.22e-3, 0.183, of_viscosity, bearing_viscous},
      {"bearing_bristles_breaking_away", "bearing_stribeck", "house",
       "bristles, and an exponential instead of a Gaussian fall", 7.31e-4, 0.0731, of_axis_torque, bearing_stribeck},
      {"heavy_house", "house_inertia", "house", "finer mesh only", 9.14e-4, 0.061, of_inertia_factor, house_inertia, {"house inertia"}},
      {"slew_ring", "house_compliance", "house", "the ring is a body of its own", 15.0, 0.3, of_gear_stiffness, house_compliance, {}, Needs::boom},
      {"pedestal_mode", "pedestal_flexibility", "house", "a degree of freedom of the structure", 1175.0, 5.88,
       of_drive_pedestal, pedestal_flexibility, {}, Needs::boom},
      {"inclined_crane", "heel", "house", "sine of the angle, and gravity lost along the rope", 5e-4, 0.04, pure_number, heel, {}, Needs::boom},
  };
}

}  // namespace slewlab::diagnosis::withheld
