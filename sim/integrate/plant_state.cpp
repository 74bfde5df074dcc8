#include "sim/integrate/plant_state.h"

#include <cmath>

#include "sim/model/drive_line.h"

namespace slewlab::sim {
namespace {

[[gnu::noinline]] void add_luffing(const PlantModel& model, double luffing, Accelerations& sum) {
  const Accelerations& per = model.per_luffing;
  sum.house += per.house * luffing;
  sum.tip += per.tip * luffing;
  sum.boom += per.boom * luffing;
  sum.pivot += per.pivot * luffing;
  sum.middle += per.middle * luffing;
  sum.tip_sensor += per.tip_sensor * luffing;
}

}  // namespace

PlantState make_plant_state(const PlantModel& model) {
  PlantState state;
  state.q.assign(static_cast<std::size_t>(model.padded_count), 0.0);
  state.v = state.q;
  return state;
}

GearSystem gear_system(const PlantModel& model, const PlantState& state) {
  unsigned is_in_contact = 0;
  for (int i = 0; i < model.group_count; ++i) is_in_contact |= (state.contact[i] != 0 ? 1u : 0u) << i;
  if (!model.full.systems.empty()) return model.full.systems[is_in_contact];
  GearSystem worked_out;
  work_out(model.full, model.group_count, is_in_contact, worked_out);
  return worked_out;
}

void refresh(const PlantModel& model, PlantState& state) {
  state.house_angle = mode_product(model.house, state.q);
  state.house_speed = mode_product(model.house, state.v);
  state.tip_displacement = mode_product(model.tip, state.q);
  state.tip_velocity = mode_product(model.tip, state.v);
  state.modal_house_acceleration =
      mode_product(model.house_acceleration_q, state.q) + mode_product(model.house_acceleration_v, state.v);
  rope_forces(model, 0.0, state);
  for (int i = 0; i < model.group_count; ++i) {
    if (model.is_rigid) {
      state.motor_angle[i] = state.house_angle;
      state.motor_speed[i] = state.house_speed;
      continue;
    }
    state.gear_torque[i] =
        contact_torque(model.gear[i], gear_deflection(state, i), state.motor_speed[i] - state.house_speed);
    state.contact[i] = state.gear_torque[i] > 0.0 ? 1 : state.gear_torque[i] < 0.0 ? -1 : 0;
    if (state.contact[i] != 0) state.last_flank[i] = state.contact[i];
  }
}

Accelerations accelerations(const PlantModel& model, const PlantState& state) {
  double gear_torque = 0.0;
  for (int i = 0; i < model.group_count; ++i) gear_torque += state.gear_torque[i];
  Accelerations result = model.passes->sense(
      model.padded_count / kLanes, model.sensed.data(), model.places.data(),
      {gear_torque + state.other_house_torque, state.rope_force + state.other_tip_force, state.other_uniform_force}, state.q.data(), state.v.data());
  if (state.luffing_force != 0.0) add_luffing(model, state.luffing_force, result);
  return result;
}

PlantReadings read(const PlantModel& model, const PlantState& state, const Accelerations& acceleration) {
  PlantReadings readings;
  for (int i = 0; i < model.group_count; ++i) {
    readings.shaft_speed[i] = state.motor_speed[i] * model.ratio;
    readings.shaft_position[i] = state.motor_angle[i] * model.ratio;
  }
  readings.house_acceleration = model.parameters.house.sensor_radius * acceleration.pivot;
  readings.pivot_acceleration = model.parameters.boom.pivot_radius * acceleration.pivot;
  readings.middle_acceleration = acceleration.middle;
  readings.tip_acceleration = acceleration.tip_sensor;
  readings.slew_angle = state.house_angle;
  return readings;
}

PlantReadings read(const PlantModel& model, const PlantState& state) { return read(model, state, accelerations(model, state)); }

double rope_angle(const PlantModel& model, const PlantState& state) {
  if (!model.has_load) return 0.0;
  const double y = model.load.modes(0, 0) * state.load_q[0] + model.load.modes(0, 1) * state.load_q[1];
  return (y - state.tip_displacement) / model.parameters.load.rope_length;
}

double rod_angle(const PlantModel& model, const PlantState& state) {
  if (!model.has_load) return 0.0;
  return model.load.modes(1, 0) * state.load_q[0] + model.load.modes(1, 1) * state.load_q[1];
}

double gear_deflection(const PlantState& state, int group) {
  return state.motor_angle[static_cast<std::size_t>(group)] - state.house_angle;
}

void shear_forces(const PlantModel& model, const PlantState& state, double* shear) {
  for (Eigen::Index e = 0; e < model.modes.shear.rows(); ++e) {
    double force = 0.0;
    for (int k = 0; k < model.mode_count; ++k) force += model.modes.shear(e, k) * state.q[static_cast<std::size_t>(k)];
    shear[e] = force;
  }
}

double modal_energy(const PlantModel& model, const PlantState& state, int mode) {
  const auto k = static_cast<std::size_t>(mode);
  return 0.5 * (state.v[k] * state.v[k] + model.square[k] * state.q[k] * state.q[k]);
}

double mechanical_energy(const PlantModel& model, const PlantState& state) {
  double energy = 0.0;
  for (int k = 0; k < model.mode_count; ++k) energy += modal_energy(model, state, k);
  for (int i = 0; i < model.group_count; ++i) {
    energy += 0.5 * model.group_inertia[i] * state.motor_speed[i] * state.motor_speed[i];
    const double depth = std::fabs(gear_deflection(state, i)) - model.gear[i].half_play;
    if (depth > 0.0) energy += 0.5 * model.gear[i].stiffness * depth * depth;
  }
  if (model.has_load) {
    const Eigen::Vector2d position(model.parameters.load.rope_length * rope_angle(model, state),
                                   rod_angle(model, state));
    energy += 0.5 * position.dot(model.load.stiffness * position);
    energy += 0.5 * (state.load_v[0] * state.load_v[0] + state.load_v[1] * state.load_v[1]);
  }
  return energy;
}

}  // namespace slewlab::sim
