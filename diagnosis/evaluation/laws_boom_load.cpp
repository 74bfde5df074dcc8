#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/evaluation/law.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<TrueSize> compression_softening(TruthMachine& machine, double size, Random&) {
  machine.structure.axial_force = size;
  // (2.15) takes about twice the softening of the first mode for one force (structure_test.cpp).
  return {{"compression", size, false}};
}

std::vector<TrueSize> boom_damping(TruthMachine& machine, double size, Random& random) {
  const double factor = std::exp(size * random.sign());
  machine.structure.damping_factor = factor;
  machine.structure.damping_power = -0.25;
  machine.structure.damping_pivot = 1.8 * 2.0 * kPi / machine.scales.period;  // between the first two bending modes
  return {{"factor", factor}};
}

std::vector<TrueSize> boom_stiffness(TruthMachine& machine, double size, Random& random) {
  const double factor = std::exp(size * random.sign());
  machine.crane.boom.youngs_modulus *= factor;
  machine.crane.boom.shear_modulus *= factor;
  return {{"factor", factor}};
}

std::vector<TrueSize> flyjib_torsion(TruthMachine& machine, double size, Random& random) {
  machine.structure.jib_mass = size;
  machine.structure.jib_eccentricity = machine.scales.boom_length * random.between(0.0429, 0.15);  // [m]
  return {{"mass", size}, {"eccentricity", machine.structure.jib_eccentricity}};
}

// Wind on a boom and a load that move themselves: the part of the relative wind across the boom counts.
std::vector<TrueSize> wind(TruthMachine& machine, double size, Random& random) {
  const double direction = random.between(-kPi, kPi);
  const double boom_area = machine.scales.boom_area * random.log_between(0.8, 1.25);  // [m^2]
  const double load_area = machine.scales.load_area * random.log_between(0.8, 1.25);  // [m^2]
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const auto pressure = [&](double speed_across) {
      const double angle = direction - scene.motion.house_angle;
      const double across = size * std::sin(angle) - speed_across, along = size * std::cos(angle);
      return 0.5 * kAirDensity * across * std::sqrt(across * across + along * along);
    };
    const double middle_radius = 0.5 * (scene.crane.boom.pivot_radius + scene.tip_radius);
    forces.uniform_force +=
        boom_area / scene.crane.boom.length * pressure(middle_radius * scene.motion.house_speed);
    forces.load_force += load_area * pressure(scene.motion.rope_end_velocity);
  }});
  return {{"speed", size},
          {"direction", direction, false},
          {"boom_drag_area", boom_area, false},
          {"load_drag_area", load_area, false}};
}

std::vector<TrueSize> load_mass(TruthMachine& machine, double size, Random& random) {
  const double factor = std::exp(size * random.sign());
  machine.crane.load.mass *= factor;
  return {{"factor", factor}};
}

std::vector<TrueSize> rope_length(TruthMachine& machine, double size, Random& random) {
  const double factor = std::exp(size * random.sign());
  machine.crane.load.rope_length *= factor;
  return {{"factor", factor}};
}

// The load on an elastic rope of free length L(t) in true geometry, in place of the small-angle rope:
//   T = k (l - L) + c (l' - L'),   l = sqrt(x^2 + z^2),   M z'' = M g - T z / l,   sideways -T x / l on the load.
// States: z less its place at rest, z'.
struct WinchMove {
  double speed = 0.0;     // [m/s] positive up
  double start = 0.0;     // [s]
  double duration = 0.0;  // [s]
  double ramp = 0.0;      // [s]
};

// Hoisted length and its rate: the speed comes and goes as a raised cosine within the ramp.
void hoisted(const WinchMove& move, double time, double& length, double& rate) {
  length = rate = 0.0;
  const double ramp = std::min(move.ramp, 0.5 * move.duration);  // [s]
  const double t = time - move.start;
  if (move.speed == 0.0 || t <= 0.0) return;
  const auto risen = [&](double s) { return 0.5 * (s - ramp / kPi * std::sin(kPi * s / ramp)); };
  const double fall_start = move.duration - ramp;
  if (t < ramp) {
    length = move.speed * risen(t);
    rate = move.speed * 0.5 * (1.0 - std::cos(kPi * t / ramp));
  } else if (t < fall_start) {
    length = move.speed * (t - 0.5 * ramp);
    rate = move.speed;
  } else {
    const double left = std::max(0.0, move.duration - t);
    length = move.speed * (move.duration - ramp - risen(left));
    rate = move.speed * 0.5 * (1.0 - std::cos(kPi * left / ramp));
  }
}

void hang_on_true_rope(TruthMachine& machine, const WinchMove& move) {
  constexpr double kStrain = 4.9e-4;  // [-] of a few falls of steel wire under the nominal load
  const double rope_stiffness = machine.scales.rope_stiffness / kStrain;  // [N/m]
  machine.forces.push_back({{0.0, 0.0}, {0.01, 0.1}, [move, rope_stiffness](const Scene& scene, const double* states,
                                                            sim::ReferenceForces& forces, double* rates) {
    const double mass = scene.crane.load.mass;
    const double damping = 0.04 * std::sqrt(rope_stiffness * mass);  // 2 % of critical
    double up = 0.0, up_rate = 0.0;
    hoisted(move, scene.motion.time, up, up_rate);
    const double free_length = scene.crane.load.rope_length - up;
    const double x = scene.motion.rope_end_displacement - scene.motion.tip_displacement;
    const double x_rate = scene.motion.rope_end_velocity - scene.motion.tip_velocity;
    const double z = scene.crane.load.rope_length + mass * sim::kGravity / rope_stiffness + states[0];
    const double length = std::sqrt(x * x + z * z);
    const double length_rate = (x * x_rate + z * states[1]) / length;
    const double tension = rope_stiffness * (length - free_length) + damping * (length_rate + up_rate);
    const double difference = tension * x / length - scene.rope_stiffness * x;
    forces.load_force -= difference;
    forces.tip_force += difference;
    rates[0] = states[1];
    rates[1] = sim::kGravity - tension * z / (length * mass);
  }});
}

std::vector<TrueSize> hoisting(TruthMachine& machine, double size, Random& random) {
  const double stretch = machine.scales.stretch;
  const double speed = size * random.sign();
  const double start = stretch * random.between(2.0, 10.0);
  const WinchMove move{speed, start, stretch * random.between(8.0, 16.0), 1.5 * stretch};
  hang_on_true_rope(machine, move);
  return {{"speed", move.speed}, {"start", move.start, false}, {"duration", move.duration, false}};
}

std::vector<TrueSize> large_angles(TruthMachine& machine, double, Random&) {
  hang_on_true_rope(machine, {});
  return {{"share", 1.0}};
}

std::vector<TrueSize> air_drag(TruthMachine& machine, double size, Random&) {
  const double reference_speed = 0.958 * machine.scales.tip_speed;  // [m/s] at which the area is what it says
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kPower = 1.85;  // [-] drag coefficients fall with the Reynolds number
    const double speed = scene.motion.rope_end_velocity;
    forces.load_force -= 0.5 * kAirDensity * size * speed * reference_speed *
                         std::pow(std::fabs(speed) / reference_speed + 1e-9, kPower - 1.0);
  }});
  return {{"drag_area", size}};
}

// By the polar coordinates r, phi of the load about the axis, phi that of the reference's lateral displacement over the tip's radius R, and
// the rope's horizontal pull at its true length,
//   p = (g / L) / sqrt(1 - (d / L)^2),   d^2 = r^2 + R^2 - 2 r R cos(phi - phi_tip),
//   r phi'' + 2 r' phi' = -p R sin(phi - phi_tip),   r'' = r phi'^2 - p (r - R cos(phi - phi_tip)),   on the tip p r sin(phi - phi_tip),
// with the rod as it hangs from the rope's end outwards; across, its part in u / R is left out.
std::vector<TrueSize> offlead(TruthMachine& machine, double, Random&) {
  const std::vector<double> scale{0.01, 0.01, 0.001, 0.001};
  machine.forces.push_back({{0.0, 0.0, 0.0, 0.0}, scale, [](const Scene& scene, const double* states, sim::ReferenceForces& forces, double* rates) {
    constexpr double kDampingRatio = 0.01;  // [-]
    const double length = scene.crane.load.rope_length, rod = scene.crane.load.rod_length, mass = scene.crane.load.mass;
    const double radius = scene.tip_radius + states[0], outwards = states[1];
    const double turn = scene.motion.rope_end_velocity / scene.tip_radius;
    const double across = scene.motion.rope_end_displacement - scene.motion.tip_displacement, lag = across / scene.tip_radius;
    const double square = radius * radius + scene.tip_radius * scene.tip_radius - 2.0 * radius * scene.tip_radius * std::cos(lag);
    const double natural = std::sqrt(sim::kGravity / length);
    const double pull = natural * natural / std::sqrt(1.0 - std::min(0.9, square / (length * length)));
    const double on_rope = radius * turn * turn - pull * (radius - scene.tip_radius * std::cos(lag)) - 2.0 * kDampingRatio * natural * outwards;
    const double on_rod = radius * turn * turn - sim::kGravity * states[2];
    rates[0] = outwards;
    rates[2] = states[3];
    // [1 l/2; l/2 l^2/3] [u''; b''] = [on_rope; l/2 on_rod]; without a rod the rope's end alone.
    rates[3] = rod > 0.0 ? 6.0 / rod * (on_rod - on_rope) : 0.0;
    rates[1] = on_rope - 0.5 * rod * rates[3];
    const double share = scene.tip_radius / radius;
    forces.load_force += mass * (natural * natural * across - share * (pull * scene.tip_radius * std::sin(lag) + 2.0 * outwards * turn));
    forces.tip_force += mass * (pull * radius * std::sin(lag) - natural * natural * across);
  }});
  return {{"share", 1.0}};
}

std::vector<TrueSize> tag_line(TruthMachine& machine, double size, Random& random) {
  const double damping = size * machine.scales.machine.acceleration_time * random.between(1.99, 4.96);  // [Ns/m]
  const double stiffening = 0.0667 * machine.scales.rope_length;  // [m] at which the sagging line is twice as stiff
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double x = scene.motion.rope_end_displacement - scene.tip_radius * scene.motion.house_angle;
    const double v = scene.motion.rope_end_velocity - scene.tip_radius * scene.motion.house_speed;
    const double pull = size * x * (1.0 + x * x / (stiffening * stiffening)) + damping * v;
    forces.load_force -= pull;
    forces.house_torque += pull * scene.tip_radius;
  }});
  return {{"stiffness", size}, {"damping", damping, false}};
}

double of_buckling_force(const LawScales& s) { return s.buckling_force; }
double of_boom_mass(const LawScales& s) { return s.machine.boom_mass; }
double of_wind_speed(const LawScales& s) { return s.wind_speed; }
double of_rope_per_swing(const LawScales& s) { return s.rope_length / (2.0 * kPi * s.swing_time); }
double of_drag_area(const LawScales& s) { return s.drag_area; }
double of_sideways_stiffness(const LawScales& s) { return s.sideways_stiffness; }

}  // namespace

std::vector<Law> boom_and_load_laws() {
  return {
      {"axial_force", "compression_softening", "boom", "geometric stiffness of every element", 3.49e-3, 0.0742,
       of_buckling_force, compression_softening, {}, Needs::boom},
      {"damping_by_power", "boom_damping", "boom", "goes with the frequency to another power", 0.3, 2.2, pure_number, boom_damping,
       {"boom damping"}, Needs::boom},
      {"other_steel", "boom_stiffness", "boom", "finer mesh only", 0.02, 0.4, pure_number, boom_stiffness,
       {"boom bending stiffness", "boom torsional stiffness"}, Needs::boom},
      {"jib_beside_the_axis", "flyjib_torsion", "boom", "a mass of the structure", 0.00185, 0.0987, of_boom_mass, flyjib_torsion, {},
       Needs::boom},
      {"relative_wind", "wind", "boom", "wind relative to the moving boom and load", 0.029, 0.483, of_wind_speed,
       wind, {}, Needs::boom},
      {"other_load", "load_mass", "load", "finer mesh only", 0.02, 0.6, pure_number, load_mass, {"load mass"}, Needs::load},
      {"other_rope", "rope_length", "load", "finer mesh only", 0.02, 0.4, pure_number, rope_length, {"rope length"}, Needs::load},
      {"hoisting_on_elastic_rope", "hoisting", "load", "true geometry, elastic rope, smooth speed", 0.00259, 0.207,
       of_rope_per_swing, hoisting, {}, Needs::load},
      {"true_pendulum", "large_angles", "load", "true geometry, elastic rope", 1.0, 1.0, pure_number, large_angles, {}, Needs::load},
      {"drag_by_power", "air_drag", "load", "power 1.85 of the speed", 0.0144, 2.155, of_drag_area, air_drag, {}, Needs::load},
      {"radial_pendulum", "offlead", "load", "true radius and sine", 1.0, 1.0, pure_number, offlead, {}, Needs::load},
      {"sagging_tag_line", "tag_line", "load", "stiffens with its deflection", 2.41e-4, 0.0482, of_sideways_stiffness, tag_line, {},
       Needs::load},
  };
}

}  // namespace slewlab::diagnosis::withheld
