#include <cmath>
#include <complex>
#include <deque>
#include <numbers>

#include "diagnosis/evaluation/bristle.h"
#include "diagnosis/evaluation/law.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"
#include "sim/model/gear.h"

namespace slewlab::diagnosis::withheld {

namespace {

constexpr double kPi = std::numbers::pi;

// +1 for the first half of the groups, -1 for the last, 0 for the middle one.
double side(int group, int count) { return 2 * group + 1 < count ? 1.0 : 2 * group + 1 > count ? -1.0 : 0.0; }

std::vector<TrueSize> torque_lag(TruthMachine& machine, double size, Random&) {
  constexpr int kParts = 10;  // of a base step
  struct Lag {
    double time_constant;
    GroupArray first{}, second{};
    void operator()(double, const GroupArray&, const GroupArray&, GroupArray& torque) {
      const double keep = std::exp(-kBaseStep / kParts / time_constant);
      for (std::size_t i = 0; i < torque.size(); ++i) {
        double sum = 0.0;
        for (int k = 0; k < kParts; ++k) {
          first[i] = torque[i] + keep * (first[i] - torque[i]);
          second[i] = first[i] + keep * (second[i] - first[i]);
          sum += second[i];
        }
        torque[i] = sum / kParts;
      }
    }
  };
  machine.torque.emplace_back(Lag{.time_constant = 0.5 * size});
  return {{"time_constant", size}};
}

std::vector<TrueSize> torque_limit(TruthMachine& machine, double size, Random&) {
  machine.torque.emplace_back([size](double, const GroupArray&, const GroupArray&, GroupArray& torque) {
    constexpr double kSharpness = 10.0;  // [-] the current controller begins to yield at 80 % of its limit
    for (double& t : torque) t /= std::pow(1.0 + std::pow(std::fabs(t) / size, kSharpness), 1.0 / kSharpness);
  });
  return {{"limit", size}};
}

std::vector<TrueSize> dead_time(TruthMachine& machine, double size, Random&) {
  constexpr int kCycle = 2;  // [base steps] between two samples of the drive
  struct Drive {
    double delay;
    std::deque<GroupArray> past{};
    std::int64_t n = 0;
    GroupArray held{};
    void operator()(double, const GroupArray&, const GroupArray&, GroupArray& torque) {
      past.push_front(torque);
      // Held for a cycle, a sample is on the average older by half of it less half a base step.
      const double steps = std::max(0.0, delay / kBaseStep - 0.5 * (kCycle - 1));
      const auto whole = static_cast<std::size_t>(steps);
      const double share = steps - std::floor(steps);
      if (past.size() > whole + 2) past.pop_back();
      if (n++ % kCycle == 0) {
        for (std::size_t i = 0; i < held.size(); ++i) {
          const double newer = whole < past.size() ? past[whole][i] : 0.0;
          const double older = whole + 1 < past.size() ? past[whole + 1][i] : 0.0;
          held[i] = newer + share * (older - newer);
        }
      }
      torque = held;
    }
  };
  machine.torque.emplace_back(Drive{.delay = size});
  return {{"delay", size}};
}

std::vector<TrueSize> torque_ripple(TruthMachine& machine, double size, Random& random) {
  constexpr double kOrders[] = {1.0, 2.0, 3.0, 6.0};  // [-] per turn: unbalance, pole pairs, harmonics
  const double order = kOrders[random.below(4)];
  const double phase = random.between(-kPi, kPi), second_phase = random.between(-kPi, kPi);
  machine.torque.emplace_back([=](double, const GroupArray& angle, const GroupArray& speed, GroupArray& torque) {
    for (std::size_t i = 0; i < torque.size(); ++i) {
      const double middle = angle[i] + 0.5 * kBaseStep * speed[i];
      torque[i] += size * (std::sin(order * middle + phase) + 0.3 * std::sin(2.0 * order * middle + second_phase));
    }
  });
  return {{"amplitude", size}, {"order", order}, {"phase", phase, false}};
}

std::vector<TrueSize> uneven_motor_inertia(TruthMachine& machine, double size, Random& random) {
  const double share = size * random.sign();
  const int groups = machine.crane.drive.group_count;
  for (int i = 0; i < groups; ++i) machine.inertia_share[i] *= 1.0 + share * side(i, groups);
  return {{"share", share}};
}

std::vector<TrueSize> uneven_gearbox_stiffness(TruthMachine& machine, double size, Random& random) {
  const double share = size * random.sign();
  const int groups = machine.crane.drive.group_count;
  for (int i = 0; i < groups; ++i) machine.stiffness_share[i] *= 1.0 + share * side(i, groups);
  return {{"share", share}};
}

std::vector<TrueSize> larger_play(TruthMachine& machine, double size, Random&) {
  for (double& added : machine.added_half_play) added += 0.5 * size;
  return {{"added_play", size}};
}

std::vector<TrueSize> uneven_play(TruthMachine& machine, double size, Random& random) {
  const double difference = size * random.sign();
  const int groups = machine.crane.drive.group_count;
  for (int i = 0; i < groups; ++i) machine.added_half_play[i] += 0.25 * difference * side(i, groups);
  return {{"difference", difference}};
}

std::vector<TrueSize> pinion_in_series(TruthMachine& machine, double size, Random&) {
  const double share = size / (size + machine.crane.drive.gearbox_stiffness);
  for (double& s : machine.stiffness_share) s *= share;
  for (double& s : machine.damping_share) s *= share;  // steel on steel: the loss factor stays
  return {{"pinion_stiffness", size}};
}

std::vector<TrueSize> pinion_mesh_variation(TruthMachine& machine, double size, Random& random) {
  const double phase = random.between(-kPi, kPi);
  machine.gears.emplace_back([=](const Scene& scene, sim::ReferenceGears& gears) {
    const sim::DriveParameters& drive = scene.crane.drive;
    for (int i = 0; i < scene.group_count; ++i) {
      const double mesh = drive.pinion_teeth * drive.pinion_ratio * scene.motion.motor_angle[i] + phase;
      gears.stiffness_share[i] *= 1.0 + size * (std::sin(mesh) + 0.25 * std::sin(2.0 * mesh));
    }
  });
  return {{"amplitude", size}, {"phase", phase, false}};
}

std::vector<TrueSize> gearbox_mesh_variation(TruthMachine& machine, double size, Random& random) {
  const double phase = random.between(-kPi, kPi);
  machine.gears.emplace_back([=](const Scene& scene, sim::ReferenceGears& gears) {
    const sim::DriveParameters& drive = scene.crane.drive;
    const double meshes = sim::planetary_mesh_frequency(drive.gearbox_ring_teeth, drive.gearbox_sun_teeth, 1.0);  // [-] per motor turn
    const double ratio = sim::total_ratio(scene.crane.drive);
    for (int i = 0; i < scene.group_count; ++i) {
      const double mesh = meshes * ratio * scene.motion.motor_angle[i] + phase;
      gears.stiffness_share[i] *= 1.0 + size * (std::sin(mesh) + 0.15 * std::sin(2.0 * mesh));
    }
  });
  return {{"amplitude", size}, {"phase", phase, false}};
}

std::vector<TrueSize> gear_friction(TruthMachine& machine, double size, Random&) {
  const double top_speed = machine.scales.machine.top_speed;
  machine.forces.push_back({{}, {}, [=](const Scene& scene, const double*, sim::ReferenceForces& forces, double*) {
    const double full_speed = 0.004 * top_speed;  // teeth slide fully above it
    for (int i = 0; i < scene.group_count; ++i) {
      forces.motor_torque[i] -=
          size * std::fabs(scene.motion.gear_torque[i]) * std::tanh(scene.motion.motor_speed[i] / full_speed);
    }
  }});
  return {{"loss", size}};
}

std::vector<TrueSize> dragging_brake(TruthMachine& machine, double size, Random& random) {
  const double unevenness = random.uniform() < 0.5 ? 0.0 : random.between(-0.5, 0.5);
  const int groups = machine.crane.drive.group_count;
  const double settle = 6.55e-4 * machine.scales.period;
  const std::vector<double> rest(static_cast<std::size_t>(groups), 0.0);
  const std::vector<double> scale(static_cast<std::size_t>(groups), 1.0);
  machine.forces.push_back({rest, scale, [=](const Scene& scene, const double* states, sim::ReferenceForces& forces,
                                             double* rates) {
    const double ratio = sim::total_ratio(scene.crane.drive);
    const Bristle kPlates{.angle = 0.03 / ratio, .settle = settle};  // 0.03 rad of the motor: plates in splines
    for (int i = 0; i < scene.group_count; ++i) {
      const double level = size * (1.0 + unevenness * side(i, scene.group_count)) *
                           scene.crane.drive.motors_per_group * ratio;
      const BristleAnswer answer = bristle_answer(kPlates, level, scene.motion.motor_speed[i], states[i]);
      forces.motor_torque[i] -= answer.torque;
      rates[i] = answer.rate;
    }
  }});
  return {{"torque", size}, {"unevenness", unevenness}};
}

// [Nm/rad] of one group of the equal ones.
double of_group_stiffness(const LawScales& s) { return s.gear_stiffness * s.group_share; }

std::vector<TrueSize> hydraulic_compliance(TruthMachine& machine, double size, Random& random) {
  // Gearbox and oil, each a damped spring, in series: the complex stiffness of both half as fast again as the first mode,
  // where drive and boom swing together.
  const double omega = 1.53 * 2.0 * kPi / machine.scales.period;
  const sim::GearContact gear = sim::gear_contact(machine.crane);
  const double damping = 0.0196 * of_group_stiffness(machine.scales) * machine.scales.period * random.between(0.5, 1.5);  // [Nms/rad] of the oil
  const std::complex<double> gearbox(gear.stiffness, omega * gear.damping), oil(size, omega * damping);
  const std::complex<double> both = gearbox * oil / (gearbox + oil);
  for (double& share : machine.stiffness_share) share *= both.real() / gear.stiffness;
  for (double& share : machine.damping_share) share *= both.imag() / omega / gear.damping;
  return {{"oil_stiffness", size}, {"oil_damping", damping, false}};
}

double of_wind_up(const LawScales& s) { return s.wind_up; }
double of_gearbox_stiffness(const LawScales& s) { return s.gearbox_stiffness; }

}  // namespace

std::vector<Law> drive_laws() {
  return {
      {"lag_of_two", "torque_lag", "drive", "two equal lags in a row instead of one", 0.00524, 0.0918, of_period, torque_lag},
      {"soft_limit", "torque_limit", "drive", "yields smoothly towards the limit", 0.92, 0.44, of_rated_torque, torque_limit},
      {"sampled_dead_time", "dead_time", "drive", "the drive samples every 2 ms", 0.00393, 0.0524, of_period, dead_time},
      {"ripple_of_two", "torque_ripple", "drive", "a second harmonic of 30 %", 0.004, 0.24, of_rated_torque, torque_ripple},
      {"uneven_motors", "uneven_motor_inertia", "drive", "finer mesh only", 0.02, 0.4, pure_number, uneven_motor_inertia, {}, Needs::two_groups},
      {"uneven_gearboxes", "uneven_gearbox_stiffness", "drive", "damping stays", 0.05, 0.55, pure_number, uneven_gearbox_stiffness, {},
       Needs::two_groups},
      {"worn_gears", "larger_play", "drive", "finer mesh only", 0.0651, 2.44, of_wind_up, larger_play},
      {"uneven_gears", "uneven_play", "drive", "finer mesh only", 0.13, 1.465, of_wind_up, uneven_play, {}, Needs::two_groups},
      {"pinion_teeth", "pinion_in_series", "drive", "damping by loss factor", 43.5, 1.16, of_gearbox_stiffness, pinion_in_series},
      {"pinion_mesh", "pinion_mesh_variation", "drive", "by the motor's angle, second harmonic of 25 %", 0.01, 0.4, pure_number,
       pinion_mesh_variation, {}, Needs::pinion_teeth},
      {"gearbox_mesh", "gearbox_mesh_variation", "drive", "stiffness itself, second harmonic of 15 %", 0.0008, 0.04, pure_number,
       gearbox_mesh_variation, {}, Needs::gearbox_teeth},
      {"tooth_friction", "gear_friction", "drive", "smooth through zero speed, does not hold", 0.004, 0.15, pure_number,
       gear_friction},
      {"brake_bristles", "dragging_brake", "drive", "bristles instead of dry friction", 0.004, 0.24, of_rated_torque, dragging_brake},
      {"oil_column", "hydraulic_compliance", "drive", "complex stiffness at one frequency", 30.0, 0.449, of_group_stiffness,
       hydraulic_compliance},
  };
}

}  // namespace slewlab::diagnosis::withheld
