#include "sim/integrate/rigid_step.h"

#include <algorithm>

namespace slewlab::sim {

void step_rigid(const PlantModel& model, const Push& push, PlantState& state) {
  const double h = model.step;
  double torque = push.house, against_positive = push.friction.house_positive, against_negative = push.friction.house_negative;
  for (int i = 0; i < model.group_count; ++i) {
    torque += push.motor[i];
    against_positive += push.friction.motor[i];
    against_negative += push.friction.motor[i];
  }
  const double start_speed = state.house_speed;
  double speed = start_speed, turned = 0.0, friction_impulse = 0.0, friction_work = 0.0, remaining = h;
  for (int piece = 0; piece < 2 && remaining > 0.0; ++piece) {
    const double friction = speed > 0.0   ? -against_positive
                            : speed < 0.0 ? against_negative
                                          : std::clamp(-torque, -against_positive, against_negative);
    const double acceleration = (torque + friction) / model.rigid_inertia;
    const bool stops = friction != 0.0 && speed * acceleration < 0.0 && -speed / acceleration < remaining;
    const double length = stops ? -speed / acceleration : remaining;
    const double way = length * (speed + 0.5 * length * acceleration);
    turned += way;
    friction_impulse += friction * length;
    friction_work += friction * way;
    speed = stops ? 0.0 : speed + length * acceleration;
    remaining -= length;
    if (!stops) break;
  }
  const double acceleration = (speed - start_speed) / h;
  const double friction = friction_impulse / h;
  const double level = friction < 0.0 ? against_positive : against_negative;
  const double share = level > 0.0 ? friction / level : 0.0;

  state.supplied_work += torque * turned + friction_work;
  state.house_friction = share * (friction < 0.0 ? push.friction.house_positive : push.friction.house_negative);
  state.other_house_torque = push.house + state.house_friction;
  state.house_angle += turned;
  state.house_speed = speed;
  for (int i = 0; i < model.group_count; ++i) {
    state.motor_friction[i] = share * push.friction.motor[i];
    state.gear_torque[i] = push.motor[i] + state.motor_friction[i] - model.group_inertia[i] * acceleration;
    state.contact[i] = state.gear_torque[i] > 0.0 ? 1 : state.gear_torque[i] < 0.0 ? -1 : 0;
    state.motor_angle[i] = state.house_angle;
    state.motor_speed[i] = speed;
  }
  state.q[0] = state.house_angle / model.house[0];
  state.v[0] = speed / model.house[0];
}

}  // namespace slewlab::sim
