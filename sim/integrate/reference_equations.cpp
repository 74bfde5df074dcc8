#include "sim/integrate/reference_equations.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {
namespace {

double rope_force(const ReferenceEquations& r, const ReferenceMotion& seen) {
  if (r.load_count == 0) return 0.0;
  return r.load.rope_stiffness * (seen.rope_end_displacement - seen.tip_displacement) +
         r.load.damping(0, 0) * (seen.rope_end_velocity - seen.tip_velocity) +
         r.load.damping(0, 1) * seen.rod_rate;
}

}  // namespace

ReferenceEquations make_reference_equations(ReferenceMachine machine, ReferenceExtra extra) {
  const int groups = machine.crane.drive.group_count;
  if (groups < 1 || groups > kMaximumGroupCount) {
    throw std::invalid_argument("the number of motor groups must be 1 ... 8");
  }
  const bool is_rigid = machine.crane.drive.is_rigid;
  if (is_rigid && (machine.modes.frequency.size() > 1 || machine.crane.load.mass > 0.0)) {
    throw std::invalid_argument("a rigid drive is one inertia: it goes with neither a boom that bends nor a load on a rope");
  }
  for (int i = 0; i < groups && !is_rigid; ++i) {
    if (!(machine.group_inertia[i] > 0.0)) throw std::invalid_argument("a motor group needs an inertia above 0");
    if (!(machine.gear[i].stiffness > 0.0)) throw std::invalid_argument("gearboxes need a stiffness above 0");
  }
  if (!(machine.crane.drive.top_speed > 0.0)) throw std::invalid_argument("the reference's tolerance needs a top speed above 0");
  if (is_rigid && !(machine.crane.drive.rated_torque > 0.0)) {
    throw std::invalid_argument("the reference's tolerance of a rigid machine needs a rated torque above 0");
  }
  if (extra.start.size() != extra.scale.size()) {
    throw std::invalid_argument("an extra needs a scale for each of its states");
  }

  ReferenceEquations r;
  r.machine = std::move(machine);
  r.extra = std::move(extra);
  r.group_count = is_rigid ? 0 : groups;
  r.rigid_groups = is_rigid ? groups : 0;
  if (is_rigid) {
    double inertia = driven_inertia(r.machine.crane);
    for (int i = 0; i < groups; ++i) inertia += r.machine.group_inertia[i];
    // The modes are those of what the motors drive; with them, it turns by less for the same torque.
    const double share = std::sqrt(driven_inertia(r.machine.crane) / inertia);
    FreeHouseModes& modes = r.machine.modes;
    for (auto* shape : {&modes.house, &modes.pivot, &modes.tip, &modes.middle, &modes.tip_twist, &modes.uniform_load}) {
      shape->front() *= share;
    }
  }
  r.has_axis_force = r.machine.crane.axis_force.constant != 0.0 || r.machine.crane.axis_force.gravity != 0.0;
  r.mode_count = static_cast<int>(r.machine.modes.frequency.size());
  r.ratio = total_ratio(r.machine.crane.drive);
  for (const double frequency : r.machine.modes.frequency) r.square.push_back(frequency * frequency);
  r.modal_force.assign(r.square.size(), 0.0);
  if (r.machine.crane.load.mass > 0.0) {
    r.load_count = 2;
    r.load = load_on_spring(r.machine.crane.load);
    const Eigen::Matrix2d damping = r.load.modes.transpose() * r.load.damping * r.load.modes;
    const Eigen::Vector2d from_velocity = r.load.modes.transpose() * r.load.damping.col(0);
    for (int j = 0; j < 2; ++j) {
      r.load_square[j] = r.load.frequency(j) * r.load.frequency(j);
      r.load_damping[j] = damping(j, j);
      r.load_from_tip[j] = r.load.modes(0, j) * r.load.rope_stiffness;
      r.load_from_tip_velocity[j] = from_velocity(j);
    }
  }
  r.size = r.extra_start() + static_cast<int>(r.extra.start.size());
  return r;
}

double contact_function(const GearContact& gear, int side, double deflection, double rate) {
  const double depth = side * deflection - gear.half_play;
  return std::min(depth, depth + gear.damping / gear.stiffness * side * rate);
}

void observe(const ReferenceEquations& r, double t, const double* y, ReferencePlace& motion) {
  const double since = t - r.held_since;
  for (int i = 0; i < r.group_count; ++i) {
    const double acceleration = r.held[i] / r.machine.group_inertia[i];
    motion.motor_angle[i] =
        y[i] + r.held_angle[i] + since * (r.held_speed[i] + 0.5 * since * acceleration);
    motion.motor_speed[i] = y[r.speeds() + i] + r.held_speed[i] + since * acceleration;
  }
  ReferenceMotion& seen = motion.seen;
  seen.time = t;
  seen.motor_torque = r.held.data();
  seen.motor_angle = motion.motor_angle.data();
  seen.motor_speed = motion.motor_speed.data();
  seen.gear_torque = motion.gear_torque.data();
  const double* q = y + r.q();
  const double* v = y + r.v();
  const double* house = r.machine.modes.house.data();
  const double* tip = r.machine.modes.tip.data();
  double house_angle = 0.0, house_speed = 0.0, tip_displacement = 0.0, tip_velocity = 0.0;
  for (int k = 0; k < r.mode_count; ++k) {
    house_angle += house[k] * q[k];
    house_speed += house[k] * v[k];
    tip_displacement += tip[k] * q[k];
    tip_velocity += tip[k] * v[k];
  }
  seen.house_angle = house_angle;
  seen.house_speed = house_speed;
  seen.tip_displacement = tip_displacement;
  seen.tip_velocity = tip_velocity;
  for (int i = 0; i < r.rigid_groups; ++i) {
    motion.motor_angle[i] = house_angle;
    motion.motor_speed[i] = house_speed;
  }
  seen.q = q;
  seen.v = v;
  if (r.load_count > 0) {
    const double* lq = y + r.load_q();
    const double* lv = y + r.load_v();
    const Eigen::Matrix2d& modes = r.load.modes;
    seen.rope_end_displacement = modes(0, 0) * lq[0] + modes(0, 1) * lq[1];
    seen.rope_end_velocity = modes(0, 0) * lv[0] + modes(0, 1) * lv[1];
    seen.rod_angle = modes(1, 0) * lq[0] + modes(1, 1) * lq[1];
    seen.rod_rate = modes(1, 0) * lv[0] + modes(1, 1) * lv[1];
  }
  if (r.extra.gears) {
    motion.gears.stiffness_share.fill(1.0);
    motion.gears.offset.fill(0.0);
    motion.gears.offset_rate.fill(0.0);
    r.extra.gears(seen, y + r.extra_start(), motion.gears);
  }
}

GearContact gear_now(const ReferenceEquations& r, const ReferencePlace& motion, int i) {
  GearContact gear = r.machine.gear[i];
  if (r.extra.gears) gear.stiffness *= motion.gears.stiffness_share[i];
  return gear;
}

double deflection_of(const ReferenceEquations& r, const ReferencePlace& motion, int i) {
  const double deflection = motion.motor_angle[i] - motion.seen.house_angle;
  return r.extra.gears ? deflection + motion.gears.offset[i] : deflection;
}

double deflection_rate_of(const ReferenceEquations& r, const ReferencePlace& motion, int i) {
  const double rate = motion.motor_speed[i] - motion.seen.house_speed;
  return r.extra.gears ? rate + motion.gears.offset_rate[i] : rate;
}

double fill_gear_torques(const ReferenceEquations& r, ReferencePlace& motion) {
  double sum = 0.0;
  for (int i = 0; i < r.group_count; ++i) {
    motion.gear_torque[i] = 0.0;
    if (r.contact[i] == 0) continue;
    const GearContact gear = gear_now(r, motion, i);
    motion.gear_torque[i] = gear.stiffness * (deflection_of(r, motion, i) - r.contact[i] * gear.half_play) +
                            gear.damping * deflection_rate_of(r, motion, i);
    sum += motion.gear_torque[i];
  }
  return sum;
}

void derive(ReferenceEquations& r, double t, const double* y, double* rates) {
  ReferencePlace motion;
  observe(r, t, y, motion);
  double house_torque = fill_gear_torques(r, motion);
  if (r.has_axis_force) house_torque += axis_force_at(r.machine.crane.axis_force, motion.seen.house_angle);
  double tip_force = rope_force(r, motion.seen);
  ReferenceForces forces;
  const bool extra = static_cast<bool>(r.extra.forces);
  if (extra) {
    std::fill(r.modal_force.begin(), r.modal_force.end(), 0.0);
    forces.modal_force = r.modal_force.data();
    r.extra.forces(motion.seen, y + r.extra_start(), forces, rates + r.extra_start());
    house_torque += forces.house_torque;
    tip_force += forces.tip_force;
  }
  for (int i = 0; i < r.rigid_groups; ++i) house_torque += r.held[i] + forces.motor_torque[i];
  for (int i = 0; i < r.group_count; ++i) {
    rates[i] = y[r.speeds() + i];
    rates[r.speeds() + i] = (forces.motor_torque[i] - motion.gear_torque[i]) / r.machine.group_inertia[i];
  }
  const double* q = y + r.q();
  const double* v = y + r.v();
  double* q_rate = rates + r.q();
  double* v_rate = rates + r.v();
  const FreeHouseModes& modes = r.machine.modes;
  for (int k = 0; k < r.mode_count; ++k) {
    q_rate[k] = v[k];
    v_rate[k] = modes.house[k] * house_torque + modes.tip[k] * tip_force - r.square[k] * q[k] -
                modes.damping_rate[k] * v[k];
  }
  if (extra) {
    for (int k = 0; k < r.mode_count; ++k) {
      v_rate[k] += modes.uniform_load[k] * forces.uniform_force + r.modal_force[k];
    }
  }
  for (int j = 0; j < r.load_count; ++j) {
    rates[r.load_q() + j] = y[r.load_v() + j];
    rates[r.load_v() + j] = -r.load_square[j] * y[r.load_q() + j] - r.load_damping[j] * y[r.load_v() + j] +
                            r.load_from_tip[j] * motion.seen.tip_displacement +
                            r.load_from_tip_velocity[j] * motion.seen.tip_velocity +
                            r.load.modes(0, j) * forces.load_force + r.load.modes(1, j) * forces.rod_moment;
  }
}

}  // namespace slewlab::sim
