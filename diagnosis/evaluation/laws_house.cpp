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

// Grease and seals that build their film: a rational rise instead of an exponential one.
std::vector<TrueSize> bearing_rising(TruthMachine& machine, double size, Random& random) {
  const double speed_of_rise = machine.scales.machine.top_speed * random.log_between(0.02, 0.15);  // [rad/s] at which half of it are reached
  const double at_rest = random.between(0.0, 0.4);
  const Bristle rollers = bearing(machine.scales);
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces, double* rates) {
    const double speed = std::fabs(scene.motion.house_speed);
    const double level = size * (at_rest + (1.0 - at_rest) * speed / (speed + speed_of_rise));
    const BristleAnswer answer = bristle_answer(rollers, level, scene.motion.house_speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
  }});
  return {{"torque", size, false}, {"speed", speed_of_rise, false}, {"at_rest", at_rest, false}, {"asymmetry", 0.0}};
}

// A raceway that is tight on one side: a raised cosine to a power instead of a Fourier series.
std::vector<TrueSize> bearing_uneven(TruthMachine& machine, double size, Random& random) {
  const double wavelength = machine.scales.machine.top_speed * machine.scales.ramp_time * random.log_between(0.5, 3.0);  // [rad]
  const double phase = random.between(-kPi, kPi), variation = random.between(0.4, 0.9);
  const Bristle rollers = bearing(machine.scales);
  machine.forces.push_back({{0.0}, {1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces, double* rates) {
    constexpr double kPower = 1.3, kMean = 0.45039;  // of ((1 + cos) / 2)^1.3 over a turn, by quadrature
    const double raised = std::pow(0.5 * (1.0 + std::cos(2.0 * kPi * scene.motion.house_angle / wavelength + phase)), kPower);
    const double level = size * (1.0 + variation * (raised / kMean - 1.0));
    const BristleAnswer answer = bristle_answer(rollers, level, scene.motion.house_speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
  }});
  return {{"torque", size, false}, {"variation", variation, false}, {"wavelength", wavelength, false}, {"phase", phase, false}};
}

// A bearing that warms with the time that has gone, and not with the way.
std::vector<TrueSize> bearing_warming(TruthMachine& machine, double size, Random& random) {
  const double fall = random.between(0.3, 0.8), time_constant = machine.scales.stretch * random.between(4.0, 15.0);  // [s]
  const double viscous = size * random.between(0.0, 1.0) / machine.scales.machine.top_speed;  // [Nm s/rad]
  const Bristle rollers = bearing(machine.scales);
  machine.forces.push_back({{0.0, 0.0}, {1.0, 1.0}, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces, double* rates) {
    const double speed = scene.motion.house_speed;
    const double level = (size + viscous * std::fabs(speed)) * (1.0 - fall * states[1]);
    const BristleAnswer answer = bristle_answer(rollers, level, speed, states[0]);
    forces.house_torque -= answer.torque;
    rates[0] = answer.rate;
    rates[1] = (1.0 - states[1]) / time_constant;
  }});
  return {{"torque", size, false}, {"coefficient", viscous, false}, {"fall", fall, false}};
}

// A hose that pulls to one side; as much at every angle.
std::vector<TrueSize> torque_offset(TruthMachine& machine, double size, Random& random) {
  const double torque = size * random.sign();
  machine.forces.push_back({{}, {}, [torque](const Scene&, const double*, sim::ReferenceForces& forces, double*) { forces.house_torque += torque; }});
  return {{"torque", torque}};
}

// A counterweight that lies beside the middle of a house that is not upright: gravity on the house alone.
std::vector<TrueSize> tilted_axis(TruthMachine& machine, double size, Random& random) {
  const double direction = random.between(-kPi, kPi);
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kTilt = 0.05;  // [rad] chosen: what a vessel heels by; the centre of mass rises with it
    const double at = direction - scene.motion.house_angle;
    forces.house_torque += size * std::sin(at) * (1.0 + kTilt * std::cos(at));
  }});
  return {{"torque", size}, {"direction", direction, false}};
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
      {"film_of_grease", "bearing_rising", "house", "bristles, and a rational instead of an exponential rise", 1.46e-3, 0.0975, of_axis_torque, bearing_rising},
      {"tight_side", "bearing_uneven", "house", "bristles, and a raised cosine to a power instead of a series", 1.46e-3, 0.0975, of_axis_torque, bearing_uneven},
      {"warming_grease", "bearing_warming", "house", "bristles, and the time instead of the way", 1.46e-3, 0.0975, of_axis_torque, bearing_warming},
      {"pulling_hose", "torque_offset", "house", "finer mesh only", 7.31e-4, 0.0731, of_axis_torque, torque_offset},
      {"eccentric_house", "tilted_axis", "house", "a second harmonic of the tilt", 1.46e-3, 0.0975, of_axis_torque, tilted_axis},
      {"heavy_house", "house_inertia", "house", "finer mesh only", 9.14e-4, 0.061, of_inertia_factor, house_inertia, {"house inertia"}},
      {"slew_ring", "house_compliance", "house", "the ring is a body of its own", 15.0, 0.3, of_gear_stiffness, house_compliance, {}, Needs::boom},
      {"pedestal_mode", "pedestal_flexibility", "house", "a degree of freedom of the structure", 1175.0, 5.88,
       of_drive_pedestal, pedestal_flexibility, {}, Needs::boom},
      {"inclined_crane", "heel", "house", "sine of the angle, and gravity lost along the rope", 5e-4, 0.04, pure_number, heel, {}, Needs::boom},
  };
}

}  // namespace slewlab::diagnosis::withheld
