#include "sim/integrate/plant.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "sim/integrate/contact_change.h"
#include "sim/integrate/friction.h"
#include "sim/integrate/oscillator.h"
#include "sim/integrate/rigid_step.h"

namespace slewlab::sim {

namespace {

// The step's text lies open in step(), with loops over as many motor groups as are known when it is compiled: `groups` is an int, or a
// constant that becomes one.
#define SLEWLAB_INLINE [[gnu::always_inline]] inline

// Share of the step below which a split would not move the state.
constexpr double kShortestSplit = 1e-9;
// Sweeps over the frictions of a step before they are solved by pivots; motors and house act on each other through
// soft gears, so each sweep gains two to four digits.
constexpr int kFrictionSweeps = 12;

struct House {
  double angle, speed, acceleration;
};

struct Trial {
  GroupArray torque, rate;  // T, T' at the end; 0 where there is no contact
  GroupArray angle, speed;  // motors at the end
  GroupArray friction;      // on motors
  double house_friction;
  FrictionEnd friction_end;
  double torque_sum, rate_sum;
  House house;
};

struct Start {
  GroupArray torque, rate;  // T, T' at the start
  double torque_sum, rate_sum;
};

// Friction at the start counts as that of the last step, cut to this step's levels. Fills what stands there already: copying
// what was written number by number a moment ago would wait for the writes.
template <class Groups>
SLEWLAB_INLINE void start_of(const PlantModel& model, Groups groups, const PlantState& state, const Push& push, Start& start) {
  double house = push.house;
  if (push.has_friction) {
    house += std::clamp(state.house_friction, -push.friction.house_positive, push.friction.house_negative);
  }
  start.torque_sum = start.rate_sum = 0.0;
  for (int i = 0; i < groups; ++i) {
    start.torque[i] = start.rate[i] = 0.0;
    if (state.contact[i] == 0) continue;
    const GearContact& gear = model.gear[i];
    start.torque[i] = gear.stiffness * (state.motor_angle[i] - state.house_angle -
                                        state.contact[i] * gear.half_play) +
                      gear.damping * (state.motor_speed[i] - state.house_speed);
    start.torque_sum += start.torque[i];
  }
  double house_acceleration =
      state.modal_house_acceleration +
      model.house_per_house_torque * (start.torque_sum + house) +
      model.house_per_tip_force * (state.rope_force + push.tip) +
      model.house_per_uniform_force * push.uniform;
  if (push.luffing != 0.0) house_acceleration += model.per_luffing.house * push.luffing;
  for (int i = 0; i < groups; ++i) {
    if (state.contact[i] == 0) continue;
    const GearContact& gear = model.gear[i];
    double motor = push.motor[i];
    if (push.has_friction) motor += std::clamp(state.motor_friction[i], -push.friction.motor[i], push.friction.motor[i]);
    start.rate[i] =
        gear.stiffness * (state.motor_speed[i] - state.house_speed) +
        gear.damping *
            ((motor - start.torque[i]) * model.full.gear[i].reciprocal_inertia - house_acceleration);
    start.rate_sum += start.rate[i];
  }
}

// Solves the end of the step for given frictions: the gears' torques, the motors and the house.
template <class Groups>
SLEWLAB_INLINE void solve_end(const PlantModel& model, Groups groups, const ModalStep& step, const PlantState& state, const Push& push,
                              const Start& start, const House& free_house, Trial& trial) {
  const double h = step.length;
  double right[kMaximumGroupCount][2];
  double torque_right = 0.0, rate_right = 0.0;
  unsigned is_in_contact = 0;
  for (int i = 0; i < groups; ++i) {
    const GearStep& gear = step.gear[i];
    const double mobility = gear.reciprocal_inertia;
    const double motor = push.motor[i] + trial.friction[i];
    // Double integral and integral of the Hermite polynomial's start terms.
    trial.angle[i] = state.motor_angle[i] + h * state.motor_speed[i] +
                     h * h * (0.5 * motor - 0.35 * start.torque[i] - h * (1.0 / 20.0) * start.rate[i]) * mobility;
    trial.speed[i] = state.motor_speed[i] +
                     h * (motor - 0.5 * start.torque[i] - h * (1.0 / 12.0) * start.rate[i]) * mobility;
    trial.torque[i] = trial.rate[i] = 0.0;
    if (state.contact[i] == 0) continue;
    const double k = model.gear[i].stiffness, c = model.gear[i].damping;
    right[i][0] = k * (trial.angle[i] - state.contact[i] * model.gear[i].half_play) + c * trial.speed[i];
    right[i][1] = k * trial.speed[i] + c * motor * mobility;
    torque_right += gear.inverse[0][0] * right[i][0] + gear.inverse[0][1] * right[i][1];
    rate_right += gear.inverse[1][0] * right[i][0] + gear.inverse[1][1] * right[i][1];
    is_in_contact |= 1u << i;
  }
  // House without the end torques; friction on the house is held over the step.
  House house = free_house;
  if (push.has_friction) {
    house.angle += step.house_angle_to_torque * trial.house_friction;
    house.speed += step.house_speed_to_torque * trial.house_friction;
    house.acceleration += step.house_acceleration_to_torque * trial.house_friction;
  }
  GearSystem worked_out;
  if (step.systems.empty()) work_out(step, groups, is_in_contact, worked_out);
  const GearSystem& gears = step.systems.empty() ? worked_out : step.systems[is_in_contact];
  const auto& answer = gears.answer;
  const auto& system = gears.system;
  const double scale = gears.scale;
  double side[2];
  for (int row = 0; row < 2; ++row) {
    side[row] = (row == 0 ? torque_right : rate_right) -
                (answer[row][0] * house.angle + answer[row][1] * house.speed + answer[row][2] * house.acceleration);
  }
  trial.torque_sum = (system[1][1] * side[0] - system[0][1] * side[1]) * scale;
  trial.rate_sum = (system[0][0] * side[1] - system[1][0] * side[0]) * scale;
  trial.house = {house.angle + step.house[0][0] * trial.torque_sum + step.house[0][1] * trial.rate_sum,
                 house.speed + step.house[1][0] * trial.torque_sum + step.house[1][1] * trial.rate_sum,
                 house.acceleration + step.house[2][0] * trial.torque_sum + step.house[2][1] * trial.rate_sum};
  for (int i = 0; i < groups; ++i) {
    if (state.contact[i] == 0) continue;
    const GearStep& gear = step.gear[i];
    const double k = model.gear[i].stiffness, c = model.gear[i].damping;
    const double r0 = right[i][0] - k * trial.house.angle - c * trial.house.speed;
    const double r1 = right[i][1] - k * trial.house.speed - c * trial.house.acceleration;
    trial.torque[i] = gear.inverse[0][0] * r0 + gear.inverse[0][1] * r1;
    trial.rate[i] = gear.inverse[1][0] * r0 + gear.inverse[1][1] * r1;
    trial.angle[i] -= h * h * (0.15 * trial.torque[i] - h * (1.0 / 30.0) * trial.rate[i]) * gear.reciprocal_inertia;
    trial.speed[i] -= h * (0.5 * trial.torque[i] - h * (1.0 / 12.0) * trial.rate[i]) * gear.reciprocal_inertia;
  }
}

[[gnu::noinline]] void solve_end_again(const PlantModel& model, const ModalStep& step, const PlantState& state, const Push& push,
                                       const Start& start, const House& free_house, Trial& trial) {
  solve_end(model, model.group_count, step, state, push, start, free_house, trial);
}

// Each friction takes what would stop its body within the step, up to its level; sweep by sweep that of the others gets
// into it. True once nothing changes any more.
bool sweep_frictions(const PlantModel& model, const ModalStep& step, const PlantState& state, const Push& push,
                     const Start& start, const House& free_house, Trial& trial) {
  for (int sweep = 0; sweep < kFrictionSweeps; ++sweep) {
    solve_end_again(model, step, state, push, start, free_house, trial);
    double change = 0.0;
    for (int i = 0; i < model.group_count; ++i) {
      const double level = push.friction.motor[i];
      const double wanted = trial.friction[i] - trial.speed[i] * model.group_inertia[i] / step.length;
      const double taken = std::clamp(wanted, -level, level);
      change = std::max(change, std::fabs(taken - trial.friction[i]) - 1e-12 * level);
      trial.friction[i] = taken;
    }
    const double wanted = trial.house_friction - trial.house.speed / step.house_speed_to_torque;
    const double taken = std::clamp(wanted, -push.friction.house_positive, push.friction.house_negative);
    const double level = push.friction.house_positive + push.friction.house_negative;
    change = std::max(change, std::fabs(taken - trial.house_friction) - 1e-12 * level);
    trial.house_friction = taken;
    if (change <= 0.0) return true;
  }
  return false;
}

// Stiff gears couple motors and house too closely for sweeps: the end speeds are linear in the frictions, so a few solves
// of the step's end give the whole problem.
FrictionEnd pivot_frictions(const PlantModel& model, const ModalStep& step, const PlantState& state, const Push& push,
                            const Start& start, const House& free_house, Trial& trial) {
  const int groups = model.group_count;
  FrictionProblem problem;
  problem.count = groups + 1;
  double friction[kMaximumFrictions];
  for (int i = 0; i < groups; ++i) {
    friction[i] = trial.friction[i];
    problem.lowest[i] = -push.friction.motor[i];
    problem.highest[i] = push.friction.motor[i];
  }
  friction[groups] = trial.house_friction;
  problem.lowest[groups] = -push.friction.house_positive;
  problem.highest[groups] = push.friction.house_negative;

  const auto speed_of = [&](int body) { return body < groups ? trial.speed[body] : trial.house.speed; };
  trial.friction.fill(0.0);
  trial.house_friction = 0.0;
  solve_end_again(model, step, state, push, start, free_house, trial);
  for (int i = 0; i <= groups; ++i) problem.free_speed[i] = speed_of(i);
  for (int j = 0; j <= groups; ++j) {
    // What gives the body alone 1 rad/s within the step.
    const double torque = j < groups ? model.group_inertia[j] / step.length : 1.0 / step.house_speed_to_torque;
    double& on_body = j < groups ? trial.friction[j] : trial.house_friction;
    on_body = torque;
    solve_end_again(model, step, state, push, start, free_house, trial);
    on_body = 0.0;
    for (int i = 0; i <= groups; ++i) problem.mobility[i][j] = (speed_of(i) - problem.free_speed[i]) / torque;
  }

  const FrictionEnd end = solve_frictions(problem, friction);
  for (int i = 0; i < groups; ++i) trial.friction[i] = friction[i];
  trial.house_friction = friction[groups];
  solve_end_again(model, step, state, push, start, free_house, trial);
  return end;
}

[[gnu::noinline]] void solve_with_friction(const PlantModel& model, const ModalStep& step, const PlantState& state, const Push& push,
                         const Start& start, const House& free_house, Trial& trial) {
  if (sweep_frictions(model, step, state, push, start, free_house, trial)) return;
  trial.friction_end = pivot_frictions(model, step, state, push, start, free_house, trial);
}

// The port `luffing` on modes and house, which are at `house` without it. The house goes by value, so that its numbers need no memory where
// nothing luffs.
[[gnu::noinline]] House push_luffing(const PlantModel& model, const ModalStep& step, double luffing, House house, PlantWorkspace& workspace) {
  for (int mode = 0; mode < model.mode_count; ++mode) {
    const auto k = static_cast<std::size_t>(mode);
    workspace.q[k] += step.luffing_q[k] * luffing;
    workspace.v[k] += step.luffing_v[k] * luffing;
  }
  house.angle += step.house_to_luffing[0] * luffing;
  house.speed += step.house_to_luffing[1] * luffing;
  house.acceleration += step.house_to_luffing[2] * luffing;
  return house;
}

// Where the modes are at the end without the end torques. Returns the house's part.
SLEWLAB_INLINE House advance_free(const PlantModel& model, const ModalStep& step, const PlantState& state, const Push& push,
                                  const Start& start, PlantWorkspace& workspace) {
  const double force = state.rope_force + push.tip, force_rate = state.rope_force_rate;
  const FreeSums sums = model.passes->free(model.padded_count / kLanes, step.free.data(), step.held.data(), model.shapes.data(),
                                           {start.torque_sum, start.rate_sum, force, force_rate, push.house, push.uniform}, state.q.data(),
                                           state.v.data(), workspace.q.data(), workspace.v.data());
  return {sums.angle, sums.speed,
          sums.acceleration_q + sums.acceleration_v + model.house_per_house_torque * push.house +
              model.house_per_tip_force * (force + step.length * force_rate) +
              model.house_per_uniform_force * push.uniform};
}


struct Change {
  double at = 2.0;
  int group = -1;
  int contact = 0;  // the new one
};

template <class Groups>
SLEWLAB_INLINE Change earliest_change(const PlantModel& model, Groups groups, const PlantState& state, const Trial& trial, double length) {
  Change change;
  for (int i = 0; i < groups; ++i) {
    const GearContact& gear = model.gear[i];
    const Deflection d{state.motor_angle[i] - state.house_angle, state.motor_speed[i] - state.house_speed,
                       trial.angle[i] - trial.house.angle, trial.speed[i] - trial.house.speed, length};
    if (state.contact[i] != 0) {
      if (!may_change(gear, state.contact[i], state.contact[i], d)) continue;
      const double at = first_change(gear, state.contact[i], state.contact[i], d);
      if (at < change.at) change = {at, i, 0};
      continue;
    }
    for (const int side : {-1, 1}) {
      if (!may_change(gear, 0, side, d)) continue;
      const double at = first_change(gear, 0, side, d);
      if (at < change.at) change = {at, i, side};
    }
  }
  return change;
}

void change_contact(PlantState& state, int group, int contact) {
  state.contact[group] = contact;
  ++state.contact_changes;
  if (contact == 0) return;
  if (state.last_flank[group] != 0 && state.last_flank[group] != contact) ++state.play_crossings[group];
  state.last_flank[group] = contact;
}

// Takes the trial's end for the state.
template <class Groups>
SLEWLAB_INLINE void accept(const PlantModel& model, Groups groups, const ModalStep& step, const LoadStep& load_step, const Push& push,
                           const Trial& trial, PlantWorkspace& workspace, PlantState& state) {
  const double house_friction = push.has_friction ? trial.house_friction : 0.0;
  const EndSums sums = model.passes->end(model.padded_count / kLanes, step.end.data(), step.held.data(), model.shapes.data(),
                                         {trial.torque_sum, trial.rate_sum, house_friction}, workspace.q.data(), workspace.v.data());
  const double tip = sums.tip;
  const double tip_velocity = sums.tip_velocity;
  state.modal_house_acceleration = sums.acceleration_q + sums.acceleration_v;
  if (push.uniform != 0.0) {
    state.supplied_work += push.uniform * (mode_product(model.uniform, workspace.q) - mode_product(model.uniform, state.q));
  }
  if (push.luffing != 0.0) {
    state.supplied_work += push.luffing * (mode_product(model.luffing, workspace.q) - mode_product(model.luffing, state.q));
  }
  state.q.swap(workspace.q);
  state.v.swap(workspace.v);

  for (int i = 0; i < groups; ++i) {
    state.supplied_work += (push.motor[i] + trial.friction[i]) * (trial.angle[i] - state.motor_angle[i]);
    state.motor_angle[i] = trial.angle[i];
    state.motor_speed[i] = trial.speed[i];
    state.gear_torque[i] = trial.torque[i];
    state.motor_friction[i] = trial.friction[i];
  }
  state.house_friction = trial.house_friction;
  if (push.has_friction && trial.friction_end != FrictionEnd::solved) ++state.unsolved_frictions;
  state.other_house_torque = push.house + trial.house_friction;
  state.supplied_work += state.other_house_torque * (trial.house.angle - state.house_angle);
  state.house_angle = trial.house.angle;
  state.house_speed = trial.house.speed;
  state.other_tip_force = push.tip;
  state.other_uniform_force = push.uniform;
  state.luffing_force = push.luffing;

  state.supplied_work += push.tip * (tip - state.tip_displacement);
  if (model.has_load) {
    double before = 0.0, after = 0.0;
    for (int j = 0; j < 2; ++j) {
      const double in[4] = {state.tip_displacement, tip, state.tip_velocity, tip_velocity};
      const double force = model.load.modes(0, j) * push.load + model.load.modes(1, j) * push.rod;
      before += force * state.load_q[j];
      double load_q = load_step.qq[j] * state.load_q[j] + load_step.qv[j] * state.load_v[j] +
                      load_step.q_force[j] * force;
      double load_v = load_step.vq[j] * state.load_q[j] + load_step.vv[j] * state.load_v[j] +
                      load_step.v_force[j] * force;
      for (int n = 0; n < 4; ++n) {
        load_q += load_step.q_in[j][n] * in[n];
        load_v += load_step.v_in[j][n] * in[n];
      }
      state.load_q[j] = load_q;
      state.load_v[j] = load_v;
      after += force * load_q;
    }
    state.supplied_work += after - before;
  }
  state.tip_displacement = tip;
  state.tip_velocity = tip_velocity;
  rope_forces(model, step.length, state);
}

// Advances by step.length with the contacts as they stand; the end is left in `trial` and the workspace.
template <class Groups>
SLEWLAB_INLINE void attempt(const PlantModel& model, Groups groups, const ModalStep& step, const PlantState& state, const Push& push,
                            Start& start, PlantWorkspace& workspace, Trial& trial) {
  start_of(model, groups, state, push, start);
  House free_house = advance_free(model, step, state, push, start, workspace);
  if (push.luffing != 0.0) free_house = push_luffing(model, step, push.luffing, free_house, workspace);
  trial.friction.fill(0.0);
  trial.house_friction = 0.0;
  trial.friction_end = FrictionEnd::solved;
  if (push.has_friction) {
    trial.friction = state.motor_friction;
    trial.house_friction = state.house_friction;
    solve_with_friction(model, step, state, push, start, free_house, trial);
  } else {
    solve_end(model, groups, step, state, push, start, free_house, trial);
  }
}

// The step in parts between changes of contact, the first of which is known.
[[gnu::noinline]] void step_in_parts(const PlantModel& model, PlantWorkspace& workspace, const Push& push, Change change, PlantState& state) {
  const int groups = model.group_count;
  Start start;
  Trial trial;
  double remaining = model.step;
  const double shortest = kShortestSplit * model.step;
  for (int split = 0; change.group >= 0 && split < kMaximumSplits; ++split) {
    const double until = std::min(change.at, 1.0) * remaining;
    if (until > shortest) {
      const StepLength part(until);
      discretise(model, part, workspace.partial);
      attempt(model, groups, workspace.partial, state, push, start, workspace, trial);
      accept(model, groups, workspace.partial, discretise_load(model, part), push, trial, workspace, state);
      remaining -= until;
    }
    change_contact(state, change.group, change.contact);
    if (remaining <= shortest) break;
    discretise(model, StepLength(remaining), workspace.partial);
    attempt(model, groups, workspace.partial, state, push, start, workspace, trial);
    change = earliest_change(model, groups, state, trial, remaining);
  }
  if (remaining > shortest) {
    accept(model, groups, workspace.partial, discretise_load(model, StepLength(remaining)), push, trial, workspace, state);
    if (change.group >= 0) ++state.unsplit_steps;
  }
}

template <class Groups>
SLEWLAB_INLINE void step_whole(const PlantModel& model, Groups groups, PlantWorkspace& workspace, const Push& push, PlantState& state) {
  Start start;
  Trial trial;
  attempt(model, groups, model.full, state, push, start, workspace, trial);
  const Change change = earliest_change(model, groups, state, trial, model.step);
  if (change.group >= 0) return step_in_parts(model, workspace, push, change, state);
  accept(model, groups, model.full, model.load_step, push, trial, workspace, state);
}

}  // namespace

PlantWorkspace make_plant_workspace(const PlantModel& model) {
  PlantWorkspace workspace;
  size_step(workspace.partial, model.padded_count);
  if (!model.luffing.empty()) {
    workspace.partial.luffing_q.assign(static_cast<std::size_t>(model.padded_count), 0.0);
    workspace.partial.luffing_v = workspace.partial.luffing_q;
  }
  workspace.q.assign(static_cast<std::size_t>(model.padded_count), 0.0);
  workspace.v = workspace.q;
  return workspace;
}

void step(const PlantModel& model, PlantWorkspace& workspace, const PlantInput& input, PlantState& state) {
  Push push;
  push.has_friction = input.friction.house_positive > 0.0 || input.friction.house_negative > 0.0;
  for (int i = 0; i < model.group_count; ++i) {
    push.motor[i] = input.motor_torque[i] * model.parameters.drive.motors_per_group * model.ratio +
                    input.ports.motor_torque[i];
    push.has_friction = push.has_friction || input.friction.motor[i] > 0.0;
  }
  push.friction = input.friction;
  push.house = input.ports.house_torque;
  if (model.has_axis_force) {
    push.house += axis_force_at(model.parameters.axis_force, state.house_angle + 0.5 * model.step * state.house_speed);
  }
  push.tip = input.ports.tip_force;
  push.uniform = input.ports.uniform_force;
  push.luffing = input.ports.luffing;
  push.load = input.ports.load_force;
  push.rod = input.ports.rod_moment;

  if (model.is_rigid) {
    step_rigid(model, push, state);
    ++state.step_count;
    return;
  }

  switch (model.group_count) {
    case 1:
      step_whole(model, std::integral_constant<int, 1>{}, workspace, push, state);
      break;
    case 2:
      step_whole(model, std::integral_constant<int, 2>{}, workspace, push, state);
      break;
    default:
      step_whole(model, model.group_count, workspace, push, state);
  }
  ++state.step_count;
}

}  // namespace slewlab::sim
