#include "sim/integrate/crane_motion_reference.h"

#include <memory>

namespace slewlab::sim {
namespace {

// The whole crane in the house's angle and the clamped boom's modes, whose masses are an arrow of the present boom angle (luffing.h): from the
// forces to the accelerations of the modal coordinates of the start. What the reference works out itself is taken off again.
struct Luffing {
  CraneMotion motion;
  LoadOnSpring load;
  LuffedBasis start, now;
  Eigen::VectorXd deflection, rate, force;

  void add(const ReferenceMotion& seen, const PortForces& ports, double rope_force, ReferenceForces& forces) {
    const LuffingBoom& boom = motion.boom;
    const Eigen::Index modes = start.house.size(), clamped = start.coupling.size();
    const Eigen::Map<const Eigen::VectorXd> q(seen.q, modes), v(seen.v, modes);
    const MotionState luffing = motion.luffing.at(seen.time);
    // One mode is all that is asked of it: masses and their slopes.
    luff_to(boom, motion.crane.boom.angle + luffing.way, now);
    deflection.noalias() = start.deflection * q;
    rate.noalias() = start.deflection * v;

    double gear_torque = 0.0;
    for (int i = 0; i < motion.crane.drive.group_count; ++i) gear_torque += seen.gear_torque[i];
    const double tip_force = rope_force + ports.tip_force;
    const double uniform_turn = boom.uniform_turn.dot(Eigen::Vector3d(boom.pivot_radius, std::cos(now.angle), std::sin(now.angle)));
    double on_house = gear_torque + now.sheave_radius * tip_force + uniform_turn * ports.uniform_force -
                      luffing.speed * seen.house_speed * now.inertia_slope;
    double inertia = now.inertia;
    // Of the whole stiffness on what deflects and what damps it; the cylinders' is no diagonal.
    const CylinderHold hold = further_hold(boom, now.angle);
    const bool is_held = boom.cylinder_twist.size() > 0;
    const double twist_moment = is_held ? hold.torsion * boom.cylinder_twist.dot(deflection + boom.damping * rate) : 0.0;
    const double lateral_force = is_held ? hold.lateral * boom.cylinder_deflection.dot(deflection + boom.damping * rate) : 0.0;
    for (Eigen::Index j = 0; j < clamped; ++j) {
      const double square = boom.square[static_cast<std::size_t>(j)], c = now.coupling(j);
      force(j) = boom.sheave(j) * tip_force + boom.uniform(j) * ports.uniform_force - 2.0 * luffing.speed * seen.house_speed * now.coupling_slope(j) -
                 square * (deflection(j) + boom.damping * rate(j));
      if (is_held) force(j) -= twist_moment * boom.cylinder_twist(j) + lateral_force * boom.cylinder_deflection(j);
      on_house -= c * force(j);
      inertia -= c * c;
    }
    const double turn = on_house / inertia;  // [rad/s^2] of the house
    for (Eigen::Index k = 0; k < modes; ++k) {
      const auto mode = static_cast<std::size_t>(k);
      double acceleration = turn * start.inertia * start.house(k);
      for (Eigen::Index j = 0; j < clamped; ++j) {
        acceleration += turn * start.coupling(j) * start.deflection(j, k) +
                        (force(j) - now.coupling(j) * turn) * (start.coupling(j) * start.house(k) + start.deflection(j, k));
      }
      const FreeHouseModes& free = start.modes;
      forces.modal_force[k] = acceleration - (free.house[mode] * gear_torque + free.tip[mode] * rope_force -
                                              free.frequency[mode] * free.frequency[mode] * seen.q[k] - free.damping_rate[mode] * seen.v[k]);
    }
    const double further = -(now.sheave_radius - start.sheave_radius) * turn;
    forces.load_force += ports.load_force + motion.masses.load * further;
    forces.rod_moment += ports.rod_moment + motion.masses.rod_moment * further;
  }
};

}  // namespace

MovingReference moving_reference(const CraneParameters& crane, const MotionRequests& requests) {
  MovingReference result{.machine = reference_machine(crane), .extra = {}};
  auto parts = std::make_shared<Luffing>();
  parts->motion = crane_motion(crane, requests);
  parts->load = load_on_spring(crane.load);
  const bool luffs = !parts->motion.luffing.is_still();
  if (luffs) {
    const LuffingBoom& boom = parts->motion.boom;
    parts->start = basis_at(boom, crane.boom.angle, static_cast<int>(result.machine.modes.frequency.size()));
    parts->now = basis_at(boom, crane.boom.angle, 1);
    parts->deflection = parts->rate = parts->force = Eigen::VectorXd::Zero(parts->start.coupling.size());
    result.machine.modes = parts->start.modes;
  }
  result.extra.forces = [parts, luffs](const ReferenceMotion& seen, const double*, ReferenceForces& forces, double*) {
    const double difference = seen.rope_end_displacement - seen.tip_displacement;
    PortForces ports;
    add_motion_forces(parts->motion,
                      {.time = seen.time, .house_angle = seen.house_angle, .house_speed = seen.house_speed, .rope_difference = difference,
                       .rod_angle = seen.rod_angle},
                      ports);
    if (luffs) {
      const LoadOnSpring& load = parts->load;
      const double rope_force = load.rope_stiffness * difference + load.damping(0, 0) * (seen.rope_end_velocity - seen.tip_velocity) +
                                load.damping(0, 1) * seen.rod_rate;
      parts->add(seen, ports, rope_force, forces);
      return;
    }
    forces.tip_force += ports.tip_force;
    forces.uniform_force += ports.uniform_force;
    forces.load_force += ports.load_force;
    forces.rod_moment += ports.rod_moment;
  };
  return result;
}

}  // namespace slewlab::sim
