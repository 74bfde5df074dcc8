// Laws that no catalogue has: what the diagnosis must answer with "not in the catalogue".
#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/evaluation/law.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;

// Gears that stiffen under load: k (1 + b (depth / 3e-4 rad)^2), 3e-4 rad being the thesis's gears at 1 MNm.
std::vector<TrueSize> stiffening_gears(TruthMachine& machine, double size, Random&) {
  machine.gears.emplace_back([size](const Scene& scene, sim::ReferenceGears& gears) {
    constexpr double kDepth = 3e-4;  // [rad]
    const double play = sim::half_play(scene.crane.drive);
    for (int i = 0; i < scene.group_count; ++i) {
      const double depth =
          std::max(0.0, std::fabs(scene.motion.motor_angle[i] - scene.motion.house_angle) - play) / kDepth;
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
  const double place = random.between(0.08, 0.22) * random.sign();  // [rad]
  const double width = random.between(0.03, 0.07);                  // [rad]
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    constexpr double kSlidingSpeed = 3e-4;  // [rad/s]
    const double far = (scene.motion.house_angle - place) / width;
    forces.house_torque -= size * std::exp(-far * far) * std::tanh(scene.motion.house_speed / kSlidingSpeed);
  }});
  return {{"torque", size, false}};
}

// The rope's upper end creeps sideways in its sheave under the side force F: s' = size (F / 10 kN)^3 [m/s].
std::vector<TrueSize> creeping_rope(TruthMachine& machine, double size, Random&) {
  machine.forces.push_back({{0.0}, {0.01}, [size](const Scene& scene, const double* states,
                                                  sim::ReferenceForces& forces, double* rates) {
    const double x = scene.motion.rope_end_displacement - scene.motion.tip_displacement;
    const double share = scene.rope_stiffness * (x - states[0]) / 1e4;
    rates[0] = size * share * share * share;
    forces.load_force += scene.rope_stiffness * states[0];
    forces.tip_force -= scene.rope_stiffness * states[0];
  }});
  return {{"creep", size, false}};
}

// Warming magnets: the motors deliver less and less of what they are told.
std::vector<TrueSize> warming_motors(TruthMachine& machine, double size, Random& random) {
  const double time_constant = random.between(6.0, 20.0);  // [s]
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

}  // namespace

std::vector<Law> laws_in_no_catalogue() {
  return {
      {"stiffening_gears", "", "drive", "", 0.02, 3.0, stiffening_gears},
      {"slew_cogging", "", "house", "", 3e3, 3e5, slew_cogging},
      {"tight_spot", "", "house", "", 1e4, 6e5, tight_spot},
      {"creeping_rope", "", "load", "", 0.005, 0.5, creeping_rope},
      {"warming_motors", "", "drive", "", 0.005, 0.3, warming_motors},
      {"flat_roller", "", "house", "", 2e4, 8e5, flat_roller},
      {"stiffening_guy", "", "boom", "", 3e6, 3e9, stiffening_guy},
  };
}

}  // namespace slewlab::diagnosis::withheld
