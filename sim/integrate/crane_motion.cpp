#include "sim/integrate/crane_motion.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace slewlab::sim {
namespace {

MotionProfile profile(const MotionRates& rates, const std::vector<MotionRequest>& requests, const char* name) {
  if (requests.empty()) return {};
  if (!(rates.top_speed > 0.0) || !(rates.acceleration > 0.0)) {
    throw std::invalid_argument(std::string("the crane has no top speed and acceleration of ") + name);
  }
  return {rates, requests};
}

// [m/s^2] of the pedestal across the boom.
double base_acceleration(const CraneMotion& motion, double time, double house_angle) {
  if (motion.travelling.is_still()) return 0.0;
  return motion.travelling.at(time).acceleration * std::sin(motion.crane.motions.travel_direction - house_angle);
}

// The force on each mode per unit of PortForces::luffing: dI/da / 2 on the house, dc/da on the clamped modes.
void set_luffing_shape(const LuffedBasis& basis, PlantModel& model) {
  for (Eigen::Index k = 0; k < basis.house.size(); ++k) {
    double force = 0.5 * basis.inertia_slope * basis.house(k);
    for (Eigen::Index j = 0; j < basis.deflection.rows(); ++j) force += basis.coupling_slope(j) * basis.deflection(j, k);
    model.luffing[static_cast<std::size_t>(k)] = force;
  }
}

void take_basis(const LuffedBasis& basis, PlantModel& model) {
  model.parameters.boom.angle = basis.angle;
  model.modes = basis.modes;
  set_luffing_shape(basis, model);
  take_modes(model);
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

CraneMotion crane_motion(const CraneParameters& crane, const MotionRequests& requests) {
  CraneMotion motion;
  if (requests.empty()) return motion;
  motion.hoisting = profile(crane.motions.hoisting, requests.hoisting, "hoisting");
  motion.luffing = profile(crane.motions.luffing, requests.luffing, "luffing");
  motion.travelling = profile(crane.motions.travelling, requests.travelling, "travelling");
  motion.moves = !motion.hoisting.is_still() || !motion.luffing.is_still() || !motion.travelling.is_still();
  motion.crane = crane;
  motion.masses = masses_of(crane);
  if (!motion.luffing.is_still()) motion.boom = luffing_boom(crane);
  return motion;
}

double rope_length(const CraneMotion& motion, double time) {
  const double length = motion.crane.load.rope_length;
  return motion.hoisting.is_still() ? length : length - motion.hoisting.at(time).way;
}

double boom_angle(const CraneMotion& motion, double time) {
  const double angle = motion.crane.boom.angle;
  return motion.luffing.is_still() ? angle : angle + motion.luffing.at(time).way;
}

double luffing_force(const CraneMotion& motion, double time, double house_speed) {
  return motion.luffing.is_still() ? 0.0 : -2.0 * motion.luffing.at(time).speed * house_speed;
}

void add_motion_forces(const CraneMotion& motion, const MotionMoment& moment, PortForces& ports) {
  if (!motion.travelling.is_still()) {
    const double lateral = -base_acceleration(motion, moment.time, moment.house_angle);
    add_body_force(motion.masses, lateral, ports);
    ports.tip_force += motion.crane.boom.jib_mass * lateral;
  }
  if (motion.crane.load.mass == 0.0) return;
  double upward = 0.0;
  if (!motion.luffing.is_still()) {
    const MotionState luffing = motion.luffing.at(moment.time);
    const SheavePath path = sheave_path(motion.boom, motion.crane.boom.angle + luffing.way);
    upward += path.height_slope * luffing.acceleration + path.height_curve * luffing.speed * luffing.speed;
    const double lateral = -2.0 * path.radius_slope * luffing.speed * moment.house_speed;
    ports.load_force += motion.masses.load * lateral;
    ports.rod_moment += motion.masses.rod_moment * lateral;
  }
  if (!motion.hoisting.is_still()) upward += motion.hoisting.at(moment.time).acceleration;
  if (motion.hoisting.is_still() && motion.luffing.is_still()) return;
  const RopeForces rope =
      moving_rope(motion.crane.load, rope_length(motion, moment.time), upward, moment.rope_difference, moment.rod_angle);
  ports.load_force += rope.load_force;
  ports.tip_force -= rope.load_force;
  ports.rod_moment += rope.rod_moment;
}

double motion_acceleration(const CraneMotion& motion, double time, double house_angle, double house_speed, std::string_view place) {
  double acceleration = base_acceleration(motion, time, house_angle);
  const bool is_middle = place == "middle";
  if ((is_middle || place == "tip") && !motion.luffing.is_still()) {
    const MotionState luffing = motion.luffing.at(time);
    const double angle = motion.crane.boom.angle + luffing.way;
    const double radius_slope = is_middle ? middle_radius_slope(motion.boom, angle) : sheave_path(motion.boom, angle).radius_slope;
    acceleration += 2.0 * radius_slope * luffing.speed * house_speed;
  }
  return acceleration;
}

void prepare_luffing(CraneMotion& motion, PlantModel& model) {
  motion.basis = motion.next = basis_at(motion.boom, motion.crane.boom.angle, model.mode_count);
  motion.deflection = motion.deflection_rate = Eigen::VectorXd::Zero(motion.basis.coupling.size());
  model.luffing.assign(static_cast<std::size_t>(model.padded_count), 0.0);
  take_basis(motion.basis, model);
}

void luff(CraneMotion& motion, double angle, PlantModel& model, PlantState& state) {
  const LuffedBasis& old = motion.basis;
  LuffedBasis& now = motion.next;
  luff_to(motion.boom, angle, now);
  const auto modes = static_cast<std::size_t>(model.mode_count);
  const Eigen::Index clamped = old.coupling.size();
  double turned = 0.0, speed = 0.0, energy = 0.0;
  motion.deflection.setZero();
  motion.deflection_rate.setZero();
  for (std::size_t k = 0; k < modes; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    energy -= modal_energy(model, state, static_cast<int>(k));
    turned += old.house(column) * state.q[k];
    speed += old.house(column) * state.v[k];
    for (Eigen::Index j = 0; j < clamped; ++j) {
      motion.deflection(j) += old.deflection(j, column) * state.q[k];
      motion.deflection_rate(j) += old.deflection(j, column) * state.v[k];
    }
  }
  // The new modes' coordinates: their shapes times the masses at the new angle.
  double on_house = now.inertia * turned, on_house_rate = now.inertia * speed;
  for (Eigen::Index j = 0; j < clamped; ++j) {
    on_house += now.coupling(j) * motion.deflection(j);
    on_house_rate += now.coupling(j) * motion.deflection_rate(j);
  }
  for (std::size_t k = 0; k < modes; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    double q = now.house(column) * on_house, v = now.house(column) * on_house_rate;
    for (Eigen::Index j = 0; j < clamped; ++j) {
      q += now.deflection(j, column) * (now.coupling(j) * turned + motion.deflection(j));
      v += now.deflection(j, column) * (now.coupling(j) * speed + motion.deflection_rate(j));
    }
    state.q[k] = q;
    state.v[k] = v;
  }
  if (model.has_load) {
    // The load keeps its place beside the sheave, which is elsewhere along the boom.
    const double further = now.sheave_radius - old.sheave_radius;
    for (int j = 0; j < 2; ++j) {
      const double inertia = model.load.mass.row(0).dot(model.load.modes.col(j));
      const double before = 0.5 * state.load_v[j] * state.load_v[j];
      state.load_q[j] += inertia * further * turned;
      state.load_v[j] += inertia * further * speed;
      energy += 0.5 * state.load_v[j] * state.load_v[j] - before;
    }
  }
  take_basis(now, model);
  std::swap(motion.basis, motion.next);
  for (int k = 0; k < model.mode_count; ++k) energy += modal_energy(model, state, k);
  state.supplied_work += energy;
  state.house_angle = dot(model.house, state.q);
  state.house_speed = dot(model.house, state.v);
  state.tip_displacement = dot(model.tip, state.q);
  state.tip_velocity = dot(model.tip, state.v);
  state.modal_house_acceleration = dot(model.house_acceleration_q, state.q) + dot(model.house_acceleration_v, state.v);
}

}  // namespace slewlab::sim
