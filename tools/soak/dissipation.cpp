#include "tools/soak/dissipation.h"

#include <cmath>
#include <cstddef>

#include "sim/integrate/oscillator.h"

namespace slewlab::tools {

namespace {

double gear_dissipation(const sim::PlantModel& model, const sim::PlantState& state, int group) {
  const sim::GearContact& gear = model.gear[group];
  const double rate = state.motor_speed[group] - state.house_speed;
  if (state.contact[group] != 0) return gear.damping * rate * rate;
  const double deflection = sim::gear_deflection(state, group);
  const double depth = std::fabs(deflection) - gear.half_play;
  return depth > 0.0 ? -gear.stiffness * depth * std::copysign(1.0, deflection) * rate : 0.0;
}

}  // namespace

double gear_and_rope_dissipation(const sim::PlantModel& model, const sim::PlantState& state) {
  double power = 0.0;
  for (int i = 0; i < model.group_count; ++i) power += gear_dissipation(model, state, i);
  if (model.has_load) {
    const auto& load = model.load;
    const double y = load.modes(0, 0) * state.load_v[0] + load.modes(0, 1) * state.load_v[1] - state.tip_velocity;
    const double rod = load.modes(1, 0) * state.load_v[0] + load.modes(1, 1) * state.load_v[1];
    power += load.damping(0, 0) * y * y + 2.0 * load.damping(0, 1) * y * rod + load.damping(1, 1) * rod * rod;
  }
  return power;
}

ModalDissipation::ModalDissipation(const sim::PlantModel& model, const sim::PlantState& state) : step_(model.step), q_(state.q), v_(state.v) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.mode_count); ++k) {
    const double square = model.square[k];
    const sim::OscillatorResponse r = sim::oscillator_response(square, model.damping_rate[k], step_);
    // The response to a unit displacement is 1 - w^2 times that to a unit force.
    modes_.push_back({square, model.damping_rate[k], r.qq, r.qv, r.vq, r.vv, r.q[0], r.q[1], r.v[0], r.v[1],
                      step_ - square * r.q[1], r.q[0], r.q[1], r.q[2]});
  }
}

double ModalDissipation::over_step(const sim::PlantState& state) {
  double heat = 0.0;
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const Mode& m = modes_[k];
    const double q = q_[k], v = v_[k];
    const double left_q = state.q[k] - m.qq * q - m.qv * v;
    const double left_v = state.v[k] - m.vq * q - m.vv * v;
    const double determinant = m.q0 * m.v1 - m.q1 * m.v0;
    const double force = (left_q * m.v1 - left_v * m.q1) / determinant;
    const double rate = (left_v * m.q0 - left_q * m.v0) / determinant;
    const double sum = m.sum_x * q + m.sum_v * v + m.sum_0 * force + m.sum_1 * rate;
    const double work = (force + rate * step_) * state.q[k] - force * q - rate * sum;
    const double energy = 0.5 * (state.v[k] * state.v[k] - v * v + m.square * (state.q[k] * state.q[k] - q * q));
    if (m.damping_rate > 0.0) heat += work - energy;
  }
  q_ = state.q;
  v_ = state.v;
  return heat;
}

}  // namespace slewlab::tools
