// The plant step of plant.h without friction and without a change of contact, for one machine in each lane of vectors: attempt(), the
// question whether a contact may change, accept(). batch.h puts machines into the lanes and takes them out of line.
//
// Numbers lie in rows, a row having one number of each machine. What depends on which gears are in contact (the 2x2 system of the step's end,
// where the teeth are, which torques there are) has rows too, filled where a machine comes into its lane: a step asks nothing about contact.
#pragma once

#include <vector>

#include "sim/integrate/modal_pass.h"
#include "sim/integrate/plant_ports.h"

namespace slewlab::sim {

inline constexpr int kMostLanes = 8;

// Room for rows of lanes, where a vector of any width may start.
struct alignas(64) Line {
  double number[kMostLanes] = {};
};
struct Rows {
  std::vector<Line> lines;
  int lanes = 0;

  void size(int count, int lane_count) {
    lanes = lane_count;
    lines.assign(static_cast<std::size_t>((count * lane_count + kMostLanes - 1) / kMostLanes), {});
  }
  double* begin() { return lines.data()->number; }
  const double* begin() const { return lines.data()->number; }
  double& at(int row, int lane) { return begin()[row * lanes + lane]; }
  double at(int row, int lane) const { return begin()[row * lanes + lane]; }
};

// Of every mode, in the order in which the passes read it. A force at the tip gives a mode by its rate the speed that it gives by itself the
// place: both are S integrated once, and have one row.
namespace mode_row {
enum : int {
  qq, qv, q_torque, q_rate, tip_once, q_tip_rate, vq, vv, v_torque, v_rate, v_tip,
  house, house_acceleration_q, house_acceleration_v, tip,
  end_q_torque, end_q_rate, end_v_torque, end_v_rate,
  q_house, q_uniform, v_house, v_uniform, count
};
}
// Of every mode, for the accelerations.
namespace sensor_row {
enum : int { square, damping_rate, house, tip, uniform, pivot, middle, tip_sensor, count };
}
// Of every machine.
namespace machine_row {
enum : int {
  step, per_step, house,  // `house`: 3 by 2
  per_house_torque = house + 6, per_tip_force, per_uniform_force, rope_stiffness, rope_damping, rod_damping,
  load_modes,             // 2 by 2
  load = load_modes + 4,  // twice qq, qv, vq, vv, q_in[4], v_in[4], q_force, v_force
  count = load + 28
};
enum : int { load_terms = 14 };
}
// Of every motor group.
namespace group_row {
enum : int { stiffness, damping, damping_per_stiffness, half_play, mobility, inverse, count = inverse + 4 };
}
namespace state_row {
enum : int {
  house_angle, house_speed, modal_house_acceleration, tip_displacement, tip_velocity, rope_force, rope_force_rate, rope_damping_force,
  other_house_torque, other_tip_force, other_uniform_force, house_friction, supplied_work, load_q, load_v = load_q + 2,
  // Of the gears in contact, the machine's GearSystem: `answer` 2 by 3, `system` 2 by 2.
  answer = load_v + 2, system = answer + 6, scale = system + 4, count
};
}
// `touches`: all bits where the gear is in contact, none where it is not; `edge`: where its teeth meet [rad].
namespace group_state_row {
enum : int { angle, speed, torque, friction, contact, touches, edge, count };
}
// `is_held`: all bits where there is a torque on the house, none where there is none.
namespace push_row {
enum : int { house, is_held, tip, load, rod, motor, count = motor + kMaximumGroupCount };
}
// What attempt() leaves for accept().
namespace trial_row {
enum : int { torque_sum, rate_sum, house_angle, house_speed, group, count = group + 3 * kMaximumGroupCount };
enum : int { angle, speed, torque, group_terms };
}

struct Topology {
  int groups = 0, modes = 0;
  bool has_load = false;
};

// Machines of neighbouring lanes.
struct Bundle {
  int first = 0, used = 0;  // machines
  Rows modes, sensors, machines, groups;
  Rows state, group_state, q, v, q_end, v_end, push, trial;
  bool has_held = false;    // a torque on a house, in the current step
  unsigned may_change = 0;  // by lane, after attempt()
};

// Accelerations of each lane: rows as in place_term.
struct LaneAccelerations {
  Line rows[place_term::count];
};

inline constexpr int kBundlesTogether = 2;  // whose waits fill each other: in one alone each operation waits for the one before

// Of one width.
struct LaneFunctions {
  // As attempt() and accept() of plant.cpp, of `count` bundles, kBundlesTogether at most.
  void (*attempt)(const Topology& topology, Bundle* bundles, int count);
  void (*accept)(const Topology& topology, Bundle* bundles, int count);
  void (*accelerations)(const Topology& topology, const Bundle& bundle, LaneAccelerations& result);
};

// All give the same bits. For four lanes on every processor, by AVX2 and for eight lanes by AVX-512; portable where there is no such thing.
const LaneFunctions& four_portable_lanes();
const LaneFunctions& four_wide_lanes();
const LaneFunctions& eight_wide_lanes();

}  // namespace slewlab::sim
