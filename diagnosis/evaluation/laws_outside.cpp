// Laws that no catalogue has: what the diagnosis must answer with "outside the catalogue".
#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/evaluation/law.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;

// [m] that tip_force bends the boom by.
double unit_deflection(const LawScales& s) { return std::cbrt(s.tip_force / s.guy); }

// Gears that stiffen under load: k (1 + b (depth / d)^2), d being what half of the rated torque winds them up by.
std::vector<TrueSize> stiffening_gears(TruthMachine& machine, double size, Random&) {
  const double unit_depth = 0.488 * machine.scales.wind_up;  // [rad]
  machine.gears.emplace_back([=](const Scene& scene, sim::ReferenceGears& gears) {
    const double play = sim::half_play(scene.crane.drive);
    for (int i = 0; i < scene.group_count; ++i) {
      const double depth =
          std::max(0.0, std::fabs(scene.motion.motor_angle[i] - scene.motion.house_angle) - play) / unit_depth;
      gears.stiffness_share[i] *= 1.0 + size * depth * depth;
    }
  });
  return {{"share", size, false}};
}

// A slew drive that pulls towards evenly spaced positions of the ring.
std::vector<TrueSize> slew_cogging(TruthMachine& machine, double size, Random& random) {
  const double lobes = std::round(random.log_between(24.0, 120.0));  // [-] per turn: segments of the ring
  const double phase = random.between(-kPi, kPi);
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    forces.house_torque -= size * std::sin(lobes * scene.motion.house_angle + phase);
  }});
  return {{"torque", size, false}};
}

// A dented raceway: friction that rises at one place.
std::vector<TrueSize> tight_spot(TruthMachine& machine, double size, Random& random) {
  const double top_speed = machine.scales.machine.top_speed;
  const double slewed = top_speed * machine.scales.ramp_time;  // [rad] twice what a ramp takes
  const double place = slewed * random.between(0.364, 1.0) * random.sign();  // [rad]
  const double width = slewed * random.between(0.136, 0.318);                // [rad]
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double sliding_speed = 0.006 * top_speed;  // [rad/s]
    const double far = (scene.motion.house_angle - place) / width;
    forces.house_torque -= size * std::exp(-far * far) * std::tanh(scene.motion.house_speed / sliding_speed);
  }});
  return {{"torque", size, false}};
}

// The rope's upper end creeps sideways in its sheave under the side force F: s' = size (F / (3.4 % of the weight))^3 [m/s].
std::vector<TrueSize> creeping_rope(TruthMachine& machine, double size, Random&) {
  const double unit_force = 0.034 * machine.scales.load_weight;  // [N]
  machine.forces.push_back({{0.0}, {0.01}, [=](const Scene& scene, const double* states,
                                                  sim::ReferenceForces& forces, double* rates) {
    const double x = scene.motion.rope_end_displacement - scene.motion.tip_displacement;
    const double share = scene.rope_stiffness * (x - states[0]) / unit_force;
    rates[0] = size * share * share * share;
    forces.load_force += scene.rope_stiffness * states[0];
    forces.tip_force -= scene.rope_stiffness * states[0];
  }});
  return {{"creep", size, false}};
}

// Warming magnets: the motors deliver less and less of what they are told.
std::vector<TrueSize> warming_motors(TruthMachine& machine, double size, Random& random) {
  const double time_constant = machine.scales.stretch * random.between(6.0, 20.0);  // [s]
  machine.torque.emplace_back([=](double time, const GroupArray&, const GroupArray&, GroupArray& torque) {
    for (double& t : torque) t *= 1.0 - size * (1.0 - std::exp(-time / time_constant));
  });
  return {{"loss", size, false}};
}

// A flat roller knocks once per spacing of the ring: a push forth and back over a twentieth of it.
std::vector<TrueSize> flat_roller(TruthMachine& machine, double size, Random& random) {
  const double spacing = 2.0 * kPi / std::round(random.log_between(40.0, 120.0));  // [rad]
  const double start = random.uniform();
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kWidth = 0.05;  // [-] of the spacing
    const double turn = scene.motion.house_angle / spacing + start;
    const double within = (turn - std::floor(turn)) / kWidth;
    if (within < 1.0) forces.house_torque -= size * std::sin(2.0 * kPi * within) * std::sin(kPi * within);
  }});
  return {{"torque", size, false}};
}

// A guy from the house to the tip that takes hold as the boom bends: F = -k3 d^3, back on the house at the tip's radius.
std::vector<TrueSize> stiffening_guy(TruthMachine& machine, double size, Random&) {
  machine.forces.push_back({{}, {}, [size](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double d = scene.motion.tip_displacement - scene.tip_radius * scene.motion.house_angle;
    const double force = size * d * d * d;
    forces.tip_force -= force;
    forces.house_torque += force * scene.tip_radius;
  }});
  return {{"cubic_stiffness", size, false}};
}

// The cables that are led through the pedestal wind up: T = size (x + x^3) / 2, x the angle over what is slewed in two ramps.
std::vector<TrueSize> wound_cable(TruthMachine& machine, double size, Random&) {
  const double slewed = machine.scales.machine.top_speed * machine.scales.ramp_time;  // [rad]
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double x = scene.motion.house_angle / slewed;
    forces.house_torque -= 0.5 * size * (x + x * x * x);
  }});
  return {{"torque", size, false}};
}

// A supply that sags: each group loses by what the others draw.
std::vector<TrueSize> shared_supply(TruthMachine& machine, double size, Random&) {
  const double rated = machine.scales.machine.motor_torque;
  machine.torque.emplace_back([=](double, const GroupArray&, const GroupArray&, GroupArray& torque) {
    double drawn = 0.0;
    for (const double t : torque) drawn += std::fabs(t);
    for (double& t : torque) t *= 1.0 - size * std::min(1.0, (drawn - std::fabs(t)) / rated);
  });
  return {{"loss", size, false}};
}

// Motors that pull harder to one side than to the other.
std::vector<TrueSize> one_sided_motors(TruthMachine& machine, double size, Random& random) {
  const double side = random.sign();
  machine.torque.emplace_back([=](double, const GroupArray&, const GroupArray&, GroupArray& torque) {
    for (double& t : torque) t += size * side * std::fabs(t);
  });
  return {{"share", size, false}};
}

// An amplifier that drifts as it warms: a torque that nobody asked for and that grows to its final value.
std::vector<TrueSize> drifting_offset(TruthMachine& machine, double size, Random& random) {
  const double time_constant = machine.scales.stretch * random.between(4.0, 12.0);  // [s]
  const double side = random.sign();
  machine.torque.emplace_back([=](double time, const GroupArray&, const GroupArray&, GroupArray& torque) {
    for (double& t : torque) t += size * side * (1.0 - std::exp(-time / time_constant));
  });
  return {{"torque", size, false}};
}

// A counterweight that hangs on the house by a spring: a mass with a frequency of its own, near the first modes.
std::vector<TrueSize> loose_counterweight(TruthMachine& machine, double size, Random& random) {
  const double inertia = size * machine.scales.machine.axis_inertia;  // [kg m^2]
  const double frequency = 2.0 * kPi / (machine.scales.period * random.log_between(0.4, 2.0));  // [rad/s]
  const double top_speed = machine.scales.machine.top_speed;
  // Its angle and speed in space.
  machine.forces.push_back({{0.0, 0.0}, {1e-3 * top_speed / frequency, 1e-3 * top_speed},
                            [=](const Scene& scene, const double* states, sim::ReferenceForces& forces, double* rates) {
    constexpr double kDampingRatio = 0.03;  // [-] of a bolted joint
    const double pull = frequency * frequency * (scene.motion.house_angle - states[0]) +
                        2.0 * kDampingRatio * frequency * (scene.motion.house_speed - states[1]);
    rates[0] = states[1];
    rates[1] = pull;
    forces.house_torque -= inertia * pull;
  }});
  return {{"share", size, false}};
}

// A guy that hangs slack until the boom bends by a third of what the rated torque bends it by.
std::vector<TrueSize> slack_guy(TruthMachine& machine, double size, Random&) {
  const double slack = unit_deflection(machine.scales) / 3.0;  // [m]
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double d = scene.motion.tip_displacement - scene.tip_radius * scene.motion.house_angle;
    const double force = std::copysign(size * std::max(0.0, std::fabs(d) - slack), d);
    forces.tip_force -= force;
    forces.house_torque += force * scene.tip_radius;
  }});
  return {{"stiffness", size, false}};
}

// Motors that weaken above half of their top speed.
std::vector<TrueSize> field_weakening(TruthMachine& machine, double size, Random&) {
  const double half = 0.5 * machine.scales.top_shaft_speed;  // [rad/s]
  machine.torque.emplace_back([=](double, const GroupArray&, const GroupArray& shaft_speed, GroupArray& torque) {
    for (std::size_t i = 0; i < torque.size(); ++i) {
      const double above = std::max(0.0, std::fabs(shaft_speed[i]) / half - 1.0);
      torque[i] *= std::max(0.0, 1.0 - size * above);
    }
  });
  return {{"loss", size, false}};
}

double of_tip_speed(const LawScales& s) { return s.tip_speed; }
double of_guy(const LawScales& s) { return s.guy; }
double of_boom_stiffness(const LawScales& s) { return s.tip_force / unit_deflection(s); }

}  // namespace

std::vector<Law> laws_in_no_catalogue() {
  return {
      {"stiffening_gears", "", "drive", "", 0.02, 3.0, pure_number, stiffening_gears, {}, Needs::nothing, "torque"},
      {"slew_cogging", "", "house", "", 7.31e-4, 0.0731, of_axis_torque, slew_cogging, {}, Needs::nothing, "angle"},
      {"tight_spot", "", "house", "", 0.00244, 0.146, of_axis_torque, tight_spot, {}, Needs::nothing, "angle"},
      {"creeping_rope", "", "load", "", 0.00319, 0.319, of_tip_speed, creeping_rope, {}, Needs::load},
      {"warming_motors", "", "drive", "", 0.005, 0.3, pure_number, warming_motors, {}, Needs::nothing, "time"},
      {"flat_roller", "", "house", "", 0.00487, 0.195, of_axis_torque, flat_roller, {}, Needs::nothing, "angle"},
      {"stiffening_guy", "", "boom", "", 0.124, 124.0, of_guy, stiffening_guy, {}, Needs::boom},
      {"wound_cable", "", "house", "", 0.002, 0.1, of_axis_torque, wound_cable, {}, Needs::nothing, "angle"},
      {"shared_supply", "", "drive", "", 0.01, 0.4, pure_number, shared_supply, {}, Needs::two_groups, "torque"},
      {"one_sided_motors", "", "drive", "", 0.005, 0.2, pure_number, one_sided_motors, {}, Needs::nothing, "torque"},
      {"drifting_offset", "", "drive", "", 0.003, 0.1, of_rated_torque, drifting_offset, {}, Needs::nothing, "time"},
      {"loose_counterweight", "", "house", "", 0.002, 0.06, pure_number, loose_counterweight},
      {"slack_guy", "", "boom", "", 0.05, 50.0, of_boom_stiffness, slack_guy, {}, Needs::boom},
      {"field_weakening", "", "drive", "", 0.02, 0.5, pure_number, field_weakening, {}, Needs::nothing, "speed"},
  };
}

}  // namespace slewlab::diagnosis::withheld
