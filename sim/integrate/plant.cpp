#include "sim/integrate/plant.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "sim/integrate/friction.h"
#include "sim/integrate/oscillator.h"
#include "sim/model/cannot_be_built.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

// Vectors are passed between functions that are all put in line.
#pragma GCC diagnostic ignored "-Wpsabi"

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
constexpr double kRounding = 1e-12;  // [-] of angles, more than the cubic of a deflection loses

void size_step(ModalStep& step, int padded_count) {
  const auto n = static_cast<std::size_t>(padded_count);
  step.free.assign(n * free_term::count, 0.0);
  step.end.assign(n * end_term::count, 0.0);
  step.held.assign(n * held_term::count, 0.0);
}

void discretise_gears(const PlantModel& model, double h, ModalStep& step) {
  for (int i = 0; i < model.group_count; ++i) {
    const double k = model.gear[i].stiffness, c = model.gear[i].damping;
    const double mobility = 1.0 / model.group_inertia[i];
    const double e00 = 1.0 + (0.15 * k * h * h + 0.5 * c * h) * mobility;
    const double e01 = -(k * h * h * h / 30.0 + c * h * h / 12.0) * mobility;
    const double e10 = (0.5 * k * h + c) * mobility;
    const double e11 = 1.0 - k * h * h / 12.0 * mobility;
    const double determinant = e00 * e11 - e01 * e10;
    GearStep& gear = step.gear[i];
    gear.reciprocal_inertia = mobility;
    gear.inverse[0][0] = e11 / determinant;
    gear.inverse[0][1] = -e01 / determinant;
    gear.inverse[1][0] = -e10 / determinant;
    gear.inverse[1][1] = e00 / determinant;
    for (int row = 0; row < 2; ++row) {
      gear.answer[row][0] = gear.inverse[row][0] * k;
      gear.answer[row][1] = gear.inverse[row][0] * c + gear.inverse[row][1] * k;
      gear.answer[row][2] = gear.inverse[row][1] * c;
    }
  }
}

using Block [[gnu::vector_size(32)]] = double;  // of modes, as in modal_pass.h
static_assert(sizeof(Block) == kLanes * sizeof(double));
struct BlockOf {
  Block value;
  explicit BlockOf(const double* from) { __builtin_memcpy(&value, from, sizeof value); }
};
void store(double* to, const Block& block) { __builtin_memcpy(to, &block, sizeof block); }

// What a block of modes adds to how the house answers the step, mode by mode: the order of these sums is that of the modes.
void add_house(const PlantModel& model, int first, const FourResponses& r, const double (*q_end)[kLanes], const double (*v_end)[kLanes],
               ModalStep& step) {
  for (int lane = 0; lane < std::min(kLanes, model.mode_count - first); ++lane) {
    const auto k = static_cast<std::size_t>(first + lane);
    const double house = model.house[k], on_q = model.house_acceleration_q[k], on_v = model.house_acceleration_v[k];
    for (int j = 0; j < 2; ++j) {
      step.house[0][j] += house * q_end[j][lane];
      step.house[1][j] += house * v_end[j][lane];
      step.house[2][j] += on_q * q_end[j][lane] + on_v * v_end[j][lane];
    }
    step.house_angle_to_torque += house * house * r.q[0][lane];
    step.house_speed_to_torque += house * house * r.v[0][lane];
    step.house_acceleration_to_torque += house * (on_q * r.q[0][lane] + on_v * r.v[0][lane]);
  }
}

// Answers to the port `luffing`, of a boom that does.
[[gnu::noinline]] void discretise_luffing(const PlantModel& model, const StepLength& of_length, ModalStep& step) {
  for (double& answer : step.house_to_luffing) answer = 0.0;
  FourResponses r;
  for (int mode = 0; mode < model.mode_count; ++mode) {
    const auto k = static_cast<std::size_t>(mode);
    const int lane = mode % kLanes;
    if (lane == 0) four_responses(&model.square[k], &model.damping_rate[k], &model.fastest[k], of_length, r);
    const double q = step.luffing_q[k] = model.luffing[k] * r.q[0][lane];
    const double v = step.luffing_v[k] = model.luffing[k] * r.v[0][lane];
    step.house_to_luffing[0] += model.house[k] * q;
    step.house_to_luffing[1] += model.house[k] * v;
    step.house_to_luffing[2] += model.house_acceleration_q[k] * q + model.house_acceleration_v[k] * v;
  }
  step.house_to_luffing[2] += model.per_luffing.house;
}

void discretise(const PlantModel& model, const StepLength& of_length, ModalStep& step) {
  const double h = of_length.length;
  step.length = h;
  if (!model.luffing.empty()) discretise_luffing(model, of_length, step);
  discretise_gears(model, h, step);
  for (auto& row : step.house) row[0] = row[1] = 0.0;
  step.house_angle_to_torque = step.house_speed_to_torque = 0.0;
  step.house_acceleration_to_torque = model.house_per_house_torque;
  FourResponses r;
  for (int first = 0; first < model.padded_count; first += kLanes) {
    four_responses(&model.square[first], &model.damping_rate[first], &model.fastest[first], of_length, r);
    double* const free = &step.free[place(first, 0, free_term::count)];
    double* const end = &step.end[place(first, 0, end_term::count)];
    double* const held = &step.held[place(first, 0, held_term::count)];
    const Block house = BlockOf(&model.house[first]).value, tip = BlockOf(&model.tip[first]).value,
                uniform = BlockOf(&model.uniform[first]).value;
    const auto put = [](double* terms, int term, const Block& block) { store(terms + term * kLanes, block); };
    put(free, free_term::qq, BlockOf(r.qq).value);
    put(free, free_term::qv, BlockOf(r.qv).value);
    const Block q_torque = house * BlockOf(r.q_value[0]).value;
    put(free, free_term::q_torque, q_torque);
    put(free, free_term::q_rate, house * BlockOf(r.q_rate[0]).value);
    put(free, free_term::q_tip, tip * BlockOf(r.q[0]).value);
    put(free, free_term::q_tip_rate, tip * BlockOf(r.q[1]).value);
    put(free, free_term::vq, BlockOf(r.vq).value);
    put(free, free_term::vv, BlockOf(r.vv).value);
    const Block v_torque = house * BlockOf(r.v_value[0]).value;
    put(free, free_term::v_torque, v_torque);
    put(free, free_term::v_rate, house * BlockOf(r.v_rate[0]).value);
    put(free, free_term::v_tip, tip * BlockOf(r.v[0]).value);
    put(free, free_term::v_tip_rate, tip * BlockOf(r.v[1]).value);
    double q_end[2][kLanes], v_end[2][kLanes];  // for T and T' at the end
    store(q_end[0], house * BlockOf(r.q_value[1]).value);
    store(q_end[1], house * BlockOf(r.q_rate[1]).value);
    store(v_end[0], house * BlockOf(r.v_value[1]).value);
    store(v_end[1], house * BlockOf(r.v_rate[1]).value);
    put(end, end_term::q_torque, BlockOf(q_end[0]).value);
    put(end, end_term::q_rate, BlockOf(q_end[1]).value);
    put(end, end_term::v_torque, BlockOf(v_end[0]).value);
    put(end, end_term::v_rate, BlockOf(v_end[1]).value);
    put(held, held_term::q_house, q_torque + BlockOf(q_end[0]).value);
    put(held, held_term::v_house, v_torque + BlockOf(v_end[0]).value);
    put(held, held_term::q_uniform, uniform * BlockOf(r.q[0]).value);
    put(held, held_term::v_uniform, uniform * BlockOf(r.v[0]).value);
    add_house(model, first, r, q_end, v_end, step);
  }
  step.house[2][0] += model.house_per_house_torque;
}

// `is_in_contact`: group i's gear by bit i.
[[gnu::noinline]] void work_out(const ModalStep& step, int group_count, unsigned is_in_contact, GearSystem& result) {
  result.answer = {};
  for (int i = 0; i < group_count; ++i) {
    if ((is_in_contact >> i & 1u) == 0) continue;
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 3; ++column) result.answer[row][column] += step.gear[i].answer[row][column];
    }
  }
  const auto& answer = result.answer;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      result.system[row][column] = (row == column ? 1.0 : 0.0) + answer[row][0] * step.house[0][column] +
                                   answer[row][1] * step.house[1][column] + answer[row][2] * step.house[2][column];
    }
  }
  result.scale = 1.0 / (result.system[0][0] * result.system[1][1] - result.system[0][1] * result.system[1][0]);
}

LoadStep discretise_load(const PlantModel& model, const StepLength& of_length) {
  const double h = of_length.length;
  LoadStep step{};
  if (!model.has_load) return step;
  const LoadOnSpring& load = model.load;
  FourResponses r;
  four_responses(model.load_square.data(), model.load_decay.data(), model.load_fastest.data(), of_length, r);
  for (int j = 0; j < 2; ++j) {
    step.qq[j] = r.qq[j];
    step.qv[j] = r.qv[j];
    step.vq[j] = r.vq[j];
    step.vv[j] = r.vv[j];
    const double displacement_in = load.modes(0, j) * load.rope_stiffness, damping_in = model.load_damping_in[j];
    const auto put_in = [&](double (&in)[4], double first, double second) {
      in[0] = displacement_in * (first - second / h);
      in[1] = displacement_in * second / h;
      in[2] = damping_in * (first - second / h);
      in[3] = damping_in * second / h;
    };
    put_in(step.q_in[j], r.q[0][j], r.q[1][j]);
    put_in(step.v_in[j], r.v[0][j], r.v[1][j]);
    step.q_force[j] = r.q[0][j];
    step.v_force[j] = r.v[0][j];
  }
  return step;
}

// In the order of modal_pass.h.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum[2] = {};
  for (std::size_t k = 0; k + 1 < a.size(); k += 2) {
    sum[0] += a[k] * b[k];
    sum[1] += a[k + 1] * b[k + 1];
  }
  return sum[0] + sum[1];
}

struct House {
  double angle, speed, acceleration;
};

// What pushes during a step or a part of it, on the slew axis.
struct Push {
  GroupArray motor;  // motors and ports, held
  double house;      // ports on the house, held
  double tip;        // ports on the tip, held
  double uniform;    // ports along the boom, held
  double luffing;    // port of a boom that luffs, held
  double load;
  double rod;
  FrictionLevels friction;
  bool has_friction;
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

// Value and slope of the gear deflection on the cubic through both ends of the step; `at` is a share of it.
struct Deflection {
  double start, start_rate, end, end_rate, length;

  template <class Number>
  Number value(const Number& at) const {
    const Number at2 = at * at, at3 = at2 * at;
    return start * (2.0 * at3 - 3.0 * at2 + 1.0) + length * start_rate * (at3 - 2.0 * at2 + at) +
           end * (3.0 * at2 - 2.0 * at3) + length * end_rate * (at3 - at2);
  }
  template <class Number>
  Number rate(const Number& at) const {
    const Number at2 = at * at;
    return (end - start) * 6.0 * (at - at2) / length + start_rate * (3.0 * at2 - 4.0 * at + 1.0) +
           end_rate * (3.0 * at2 - 2.0 * at);
  }
};

// > 0 where the group's contact would change: teeth of flank `contact` that would pull, or free teeth that
// have met flank `side` and push.
template <class Number>
Number change_measure(const GearContact& gear, int contact, int side, const Number& deflection, const Number& rate) {
  const double flank = side;
  const Number depth = flank * deflection - gear.half_play;
  const Number push = depth + gear.damping / gear.stiffness * flank * rate;
  if (contact != 0) return -push;
  return push < depth ? push : depth;
}

// Whether the contact may change within the step: it has changed at the end, or the deflection turns on the way. Asked in every step.
SLEWLAB_INLINE bool may_change(const GearContact& gear, int contact, int side, const Deflection& d) {
  if (!(change_measure(gear, contact, side, d.end, d.end_rate) <= 0.0)) return true;
  const double towards = contact != 0 ? -side : side;
  return towards * d.start_rate > 0.0 && towards * d.end_rate < 0.0;
}

// Whether the deflection's cubic turns too far from the edge to reach it: from the straight line between its ends it is off by less than
// the way that its start and end rates would go in the step, and its rate from twice the mean rate by less than their sum.
bool turns_far_from_edge(const GearContact& gear, int contact, int side, const Deflection& d) {
  const double rates = std::fabs(d.start_rate) + std::fabs(d.end_rate);
  const double reach = d.length * rates + kRounding * (std::fabs(d.start) + std::fabs(d.end));
  if (contact == 0) return std::max(side * d.start, side * d.end) + reach < gear.half_play;
  const double fastest = 2.0 * std::fabs(d.end - d.start) / d.length + rates;
  return std::min(side * d.start, side * d.end) - gear.half_play - reach - gear.damping / gear.stiffness * fastest > 0.0;
}

using Points [[gnu::vector_size(16)]] = double;  // as every 64-bit processor has them

// Halves [before, after] towards where `is_beyond` begins and returns `after`. Three times at once: all places that may come next are asked
// together, and the way through them is found without a branch that the processor would have to guess.
template <class IsBeyond>
SLEWLAB_INLINE double halved(double before, double after, int halvings, const IsBeyond& is_beyond) {
  for (; halvings >= 3; halvings -= 3) {
    const double middle = 0.5 * (before + after);
    if (middle == before || middle == after) return after;  // neighbouring numbers: no halving moves them
    const double left = 0.5 * (before + middle), right = 0.5 * (middle + after);
    const double places[] = {before, 0.5 * (before + left), left,  0.5 * (left + middle), middle, 0.5 * (middle + right), right, 0.5 * (right + after),
                             after};
    const auto left_half = is_beyond(Points{left, middle}), right_half = is_beyond(Points{right, middle});
    const auto left_quarters = is_beyond(Points{places[1], places[3]}), right_quarters = is_beyond(Points{places[5], places[7]});
    const bool in_left = left_half[1] != 0;
    const auto quarters = in_left ? left_quarters : right_quarters;
    const bool in_first = (in_left ? left_half[0] : right_half[0]) != 0;
    const bool in_begin = (in_first ? quarters[0] : quarters[1]) != 0;
    const int eighth = (in_left ? 0 : 4) + (in_first ? 0 : 2) + (in_begin ? 0 : 1);
    before = places[eighth];
    after = places[eighth + 1];
  }
  for (; halvings > 0; --halvings) {
    const double middle = 0.5 * (before + after);
    (is_beyond(Points{middle, middle})[0] != 0 ? after : before) = middle;
  }
  return after;
}

// The first share of the step at which the contact changes, 2 when it does not; where may_change() says yes. Out of line, so that the
// question stays small.
[[gnu::noinline]] double first_change(const GearContact& gear, int contact, int side, const Deflection& d) {
  const auto measure = [&](double at) {
    return change_measure(gear, contact, side, d.value(at), d.rate(at));
  };
  double after = 1.0;
  if (change_measure(gear, contact, side, d.end, d.end_rate) <= 0.0) {
    // Both ends keep the contact; it may still have changed where the deflection turns inside the step.
    if (turns_far_from_edge(gear, contact, side, d)) return 2.0;
    const double towards = contact != 0 ? -side : side;
    after = halved(0.0, 1.0, 50, [&](const Points& at) { return ~(towards * d.rate(at) > 0.0); });
    if (measure(after) <= 0.0) return 2.0;
  }
  if (measure(0.0) > 0.0) return 0.0;
  return halved(0.0, after, 60, [&](const Points& at) { return change_measure<Points>(gear, contact, side, d.value(at), d.rate(at)) > 0.0; });
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

// The rope's force on the tip and its rate. The damping's share of the rate is its change over the last
// `length` seconds; with 0 it counts as steady.
SLEWLAB_INLINE void rope_forces(const PlantModel& model, double length, PlantState& state) {
  if (!model.has_load) return;
  const LoadOnSpring& load = model.load;
  const double y = load.modes(0, 0) * state.load_q[0] + load.modes(0, 1) * state.load_q[1];
  const double y_rate = load.modes(0, 0) * state.load_v[0] + load.modes(0, 1) * state.load_v[1];
  const double rod_rate = load.modes(1, 0) * state.load_v[0] + load.modes(1, 1) * state.load_v[1];
  const double damping = load.damping(0, 0) * (y_rate - state.tip_velocity) + load.damping(0, 1) * rod_rate;
  state.rope_force_rate = load.rope_stiffness * (y_rate - state.tip_velocity);
  if (length > 0.0) state.rope_force_rate += (damping - state.rope_damping_force) / length;
  state.rope_damping_force = damping;
  state.rope_force = load.rope_stiffness * (y - state.tip_displacement) + damping;
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
    state.supplied_work += push.uniform * (dot(model.uniform, workspace.q) - dot(model.uniform, state.q));
  }
  if (push.luffing != 0.0) {
    state.supplied_work += push.luffing * (dot(model.luffing, workspace.q) - dot(model.luffing, state.q));
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

// The whole step of a machine that is one inertia. Friction has its full level against the motion, and at rest takes
// what holds it there, up to the level: at most two pieces, one until it stops and one from then on.
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

// What the passes over the modes read, in the order in which they read it.
void put_in_blocks(PlantModel& model) {
  const auto put = [&](std::vector<double>& blocks, int terms, int term, const std::vector<double>& values) {
    blocks.resize(values.size() * static_cast<std::size_t>(terms));
    for (int k = 0; k < model.padded_count; ++k) blocks[place(k, term, terms)] = values[static_cast<std::size_t>(k)];
  };
  const auto put_shape = [&](int term, const std::vector<double>& values) { put(model.shapes, shape_term::count, term, values); };
  put_shape(shape_term::house, model.house);
  put_shape(shape_term::house_acceleration_q, model.house_acceleration_q);
  put_shape(shape_term::house_acceleration_v, model.house_acceleration_v);
  put_shape(shape_term::tip, model.tip);
  const auto put_sensed = [&](int term, const std::vector<double>& values) { put(model.sensed, sense_term::count, term, values); };
  put_sensed(sense_term::square, model.square);
  put_sensed(sense_term::damping_rate, model.damping_rate);
  put_sensed(sense_term::house, model.house);
  put_sensed(sense_term::tip, model.tip);
  put_sensed(sense_term::uniform, model.uniform);
  model.places.resize(model.house.size() * place_term::count);
  double* next = model.places.data();
  for (std::size_t k = 0; k < model.house.size(); ++k) {
    for (const double shape : {model.house[k], model.tip[k], model.uniform[k], model.pivot[k], model.middle[k], model.tip_sensor[k]}) *next++ = shape;
  }
}

// How what is measured and asked for answers the port `luffing`, of a boom that does.
void take_luffing(PlantModel& model) {
  Accelerations& per = model.per_luffing;
  per = {};
  for (std::size_t k = 0; k < model.luffing.size(); ++k) {
    const double luffing = model.luffing[k];
    per.house += model.house[k] * luffing;
    per.tip += model.tip[k] * luffing;
    per.boom += model.uniform[k] * luffing;
    per.pivot += model.pivot[k] * luffing;
    per.middle += model.middle[k] * luffing;
    per.tip_sensor += model.tip_sensor[k] * luffing;
  }
  model.full.luffing_q.resize(model.luffing.size(), 0.0);
  model.full.luffing_v.resize(model.luffing.size(), 0.0);
}

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

PlantModel make_plant_model(const CraneParameters& crane, double step) {
  GroupArray inertia{};
  std::array<GearContact, kMaximumGroupCount> gear{};
  inertia.fill(group_inertia(crane.drive));
  gear.fill(gear_contact(crane));
  return make_plant_model(crane, step, inertia, gear);
}

PlantModel make_plant_model(const CraneParameters& crane, double step, const GroupArray& group_inertia,
                            const std::array<GearContact, kMaximumGroupCount>& gear) {
  const int groups = crane.drive.group_count;
  if (!(step > 0.0)) throw std::invalid_argument("the plant's step must be greater than 0 s");
  if (groups < 1 || groups > kMaximumGroupCount) {
    throw std::invalid_argument("the number of motor groups must be 1 ... 8");
  }
  for (int i = 0; i < groups; ++i) {
    if (!crane.drive.is_rigid && !(group_inertia[i] > 0.0)) throw CannotBeBuilt("a motor group needs an inertia above 0");
    if (!crane.drive.is_rigid && !(gear[i].stiffness > 0.0)) throw CannotBeBuilt("gearboxes need a stiffness above 0");
  }
  if (!(driven_inertia(crane) > 0.0)) throw CannotBeBuilt("what the motors drive has no inertia");

  PlantModel model;
  model.parameters = crane;
  model.step = step;
  model.group_count = groups;
  model.ratio = total_ratio(crane.drive);
  model.gear = gear;
  model.group_inertia = group_inertia;
  model.modes = free_house_modes(crane);
  model.mode_count = static_cast<int>(model.modes.frequency.size());
  model.padded_count = block_count(model.mode_count) * kLanes;
  model.passes = &modal_passes();
  model.has_load = crane.load.mass > 0.0;
  model.has_axis_force = crane.axis_force.constant != 0.0 || crane.axis_force.gravity != 0.0;
  model.is_rigid = crane.drive.is_rigid;
  if (model.is_rigid) {
    if (model.mode_count > 1 || model.has_load) {
      throw std::invalid_argument("a rigid drive is stepped as one inertia: it goes with neither a boom that bends nor a load on a rope");
    }
    model.rigid_inertia = driven_inertia(crane);
    for (int i = 0; i < groups; ++i) model.rigid_inertia += group_inertia[i];
  }
  if (model.has_load) {
    model.load = load_on_spring(crane.load);
    const LoadOnSpring& load = model.load;
    const Eigen::Vector2d damping_in = load.modes.transpose() * load.damping.col(0);
    const Eigen::Vector2d decay = (load.modes.transpose() * load.damping * load.modes).diagonal();
    for (int j = 0; j < 2; ++j) {
      model.load_square[j] = load.frequency(j) * load.frequency(j);
      model.load_decay[j] = decay(j);
      model.load_fastest[j] = fastest_rate(model.load_square[j], decay(j));
      model.load_damping_in[j] = damping_in(j);
    }
  }
  size_step(model.full, model.padded_count);
  if (!model.is_rigid && groups <= kTabulatedGroups) model.full.systems.resize(std::size_t{1} << groups);
  take_modes(model);
  model.load_step = discretise_load(model, StepLength(step));
  return model;
}

void take_modes(PlantModel& model) {
  const FreeHouseModes& modes = model.modes;
  const auto count = static_cast<std::size_t>(model.padded_count);
  const auto pad = [&](const std::vector<double>& values, std::vector<double>& result) {
    result.resize(count, 0.0);
    std::copy(values.begin(), values.end(), result.begin());
  };
  pad(modes.house, model.house);
  pad(modes.pivot, model.pivot);
  pad(modes.tip, model.tip);
  pad(modes.tip, model.tip_sensor);
  for (std::size_t k = 0; k < modes.tip_twist.size(); ++k) {
    model.tip_sensor[k] -= model.parameters.boom.jib_eccentricity * modes.tip_twist[k];
  }
  pad(modes.middle, model.middle);
  pad(modes.uniform_load, model.uniform);
  pad(modes.damping_rate, model.damping_rate);
  pad(modes.frequency, model.square);
  for (double& value : model.square) value *= value;
  model.fastest.resize(count);
  model.house_acceleration_q.resize(count);
  model.house_acceleration_v.resize(count);
  model.house_per_house_torque = model.house_per_tip_force = model.house_per_uniform_force = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    model.fastest[k] = fastest_rate(model.square[k], model.damping_rate[k]);
    model.house_acceleration_q[k] = -model.house[k] * model.square[k];
    model.house_acceleration_v[k] = -model.house[k] * model.damping_rate[k];
    model.house_per_house_torque += model.house[k] * model.house[k];
    model.house_per_tip_force += model.house[k] * model.tip[k];
    model.house_per_uniform_force += model.house[k] * model.uniform[k];
  }
  put_in_blocks(model);
  if (model.is_rigid) return;
  if (!model.luffing.empty()) take_luffing(model);
  discretise(model, StepLength(model.step), model.full);
  for (unsigned gears = 0; gears < model.full.systems.size(); ++gears) work_out(model.full, model.group_count, gears, model.full.systems[gears]);
}

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
  state.house_angle = dot(model.house, state.q);
  state.house_speed = dot(model.house, state.v);
  state.tip_displacement = dot(model.tip, state.q);
  state.tip_velocity = dot(model.tip, state.v);
  state.modal_house_acceleration =
      dot(model.house_acceleration_q, state.q) + dot(model.house_acceleration_v, state.v);
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
