#include "sim/integrate/batch.h"

#include <algorithm>
#include <stdexcept>

// Vectors are passed between functions that are all put in line.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace slewlab::sim {

namespace {

template <int N>
struct VectorOf;
template <>
struct VectorOf<4> {
  using Type [[gnu::vector_size(32), gnu::may_alias]] = double;
};
template <>
struct VectorOf<8> {
  using Type [[gnu::vector_size(64), gnu::may_alias]] = double;
};
template <int N>
using Vec = typename VectorOf<N>::Type;
constexpr int kMostLanes = 8;
constexpr double kRounding = 1e-12;  // [-] of angles, more than the cubic of a deflection loses

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

// Of every mode, in the order in which the passes read it: the free terms of modal_pass.h first.
namespace mode_row {
enum : int {
  house = free_term::count, house_acceleration_q, house_acceleration_v, tip,
  end_q_torque, end_q_rate, end_v_torque, end_v_rate,
  q_house, q_uniform, v_house, v_uniform, count
};
}
namespace sensor_row {
enum : int { square, damping_rate, house, tip, uniform, pivot, middle, tip_sensor, count };
}
// Of every machine, and of every group behind them.
namespace machine_row {
enum : int {
  step, per_step, ratio, house,  // `house`: 3 by 2
  per_house_torque = house + 6, per_tip_force, per_uniform_force, sensor_radius, pivot_radius, rope_stiffness, rope_damping, rod_damping,
  load_modes,             // 2 by 2
  load = load_modes + 4,  // twice qq, qv, vq, vv, q_in[4], v_in[4], q_force, v_force
  count = load + 28
};
enum : int { load_terms = 14 };
}
namespace group_row {
enum : int { stiffness, damping, damping_per_stiffness, half_play, mobility, inverse, answer = inverse + 4, count = answer + 6 };
}
namespace state_row {
enum : int {
  house_angle, house_speed, modal_house_acceleration, tip_displacement, tip_velocity, rope_force, rope_force_rate, rope_damping_force,
  other_house_torque, other_tip_force, other_uniform_force, house_friction, supplied_work, load_q, load_v = load_q + 2, count = load_v + 2
};
}
namespace group_state_row {
enum : int { angle, speed, contact, torque, friction, count };
}
namespace push_row {
enum : int { house, tip, load, rod, motor, count = motor + kMaximumGroupCount };
}

// Machines of neighbouring lanes.
struct Bundle {
  int first = 0, used = 0;  // machines
  int out = 0;              // of them, in the current step
  bool has_held = false;    // a torque on a house, in the current step
  Rows modes, sensors, machines, groups;
  Rows state, group_state, q, v, q_end, v_end, push;
};

struct Topology {
  int groups = 0, modes = 0;
  bool has_load = false;
};

// A machine out of line: its state as plant.h's step() takes it, of which only what no lane holds is kept between the steps.
struct Alone {
  const PlantModel* model = nullptr;
  PlantWorkspace workspace;
  PlantState state;
  bool is_out = false;  // in the current step
};

void take_out(PlantBatch& batch, Bundle& bundle, int lane, const PlantInput& input);

using StepLanes = void (*)(PlantBatch&, Bundle&, const PlantInput*);
using ReadLanes = void (*)(const Topology&, const Bundle&, double* accelerations);

}  // namespace

struct PlantBatch {
  Topology topology;
  int lanes = 0;
  std::vector<Bundle> bundles;
  std::vector<Alone> alone;  // per machine
  std::int64_t steps = 0;
  std::int64_t out_of_line = 0;
  StepLanes step_lanes = nullptr;
  ReadLanes read_lanes = nullptr;
};

namespace {

#define SLEWLAB_INLINE [[gnu::always_inline]] inline

template <int N>
SLEWLAB_INLINE Vec<N>& row(double* rows, int index) {
  return *reinterpret_cast<Vec<N>*>(rows + index * N);
}
template <int N>
SLEWLAB_INLINE const Vec<N>& row(const double* rows, int index) {
  return *reinterpret_cast<const Vec<N>*>(rows + index * N);
}
template <int N>
SLEWLAB_INLINE Vec<N> magnitude(const Vec<N>& a) {
  return a < 0.0 ? -a : a;
}
template <int N>
struct FourSums {
  Vec<N> even[4], odd[4];
  SLEWLAB_INLINE Vec<N> total(int index) const { return even[index] + odd[index]; }
};

template <int N, bool kHeld>
SLEWLAB_INLINE void free_mode(const double* mode, const Vec<N>& q0, const Vec<N>& v0, const Vec<N>& torque, const Vec<N>& rate, const Vec<N>& tip, const Vec<N>& tip_rate,
                              const Vec<N>& house, const Vec<N>& uniform, Vec<N>& q_end, Vec<N>& v_end, Vec<N>* sums) {
  using namespace free_term;
  Vec<N> q = row<N>(mode, qq) * q0 + row<N>(mode, qv) * v0 + row<N>(mode, q_torque) * torque + row<N>(mode, q_rate) * rate +
        row<N>(mode, q_tip) * tip + row<N>(mode, q_tip_rate) * tip_rate;
  Vec<N> v = row<N>(mode, vq) * q0 + row<N>(mode, vv) * v0 + row<N>(mode, v_torque) * torque + row<N>(mode, v_rate) * rate +
        row<N>(mode, v_tip) * tip + row<N>(mode, v_tip_rate) * tip_rate;
  if constexpr (kHeld) {
    const auto held = house != 0.0;
    q = held ? q + (row<N>(mode, mode_row::q_house) * house + row<N>(mode, mode_row::q_uniform) * uniform) : q;
    v = held ? v + (row<N>(mode, mode_row::v_house) * house + row<N>(mode, mode_row::v_uniform) * uniform) : v;
  }
  q_end = q;
  v_end = v;
  sums[0] += row<N>(mode, mode_row::house) * q;
  sums[1] += row<N>(mode, mode_row::house) * v;
  sums[2] += row<N>(mode, mode_row::house_acceleration_q) * q;
  sums[3] += row<N>(mode, mode_row::house_acceleration_v) * v;
}

template <int N>
SLEWLAB_INLINE void end_mode(const double* mode, const Vec<N>& torque, const Vec<N>& rate, Vec<N>& q_end, Vec<N>& v_end, Vec<N>* sums) {
  const Vec<N> q = q_end + row<N>(mode, mode_row::end_q_torque) * torque + row<N>(mode, mode_row::end_q_rate) * rate;
  const Vec<N> v = v_end + row<N>(mode, mode_row::end_v_torque) * torque + row<N>(mode, mode_row::end_v_rate) * rate;
  q_end = q;
  v_end = v;
  sums[0] += row<N>(mode, mode_row::tip) * q;
  sums[1] += row<N>(mode, mode_row::tip) * v;
  sums[2] += row<N>(mode, mode_row::house_acceleration_q) * q;
  sums[3] += row<N>(mode, mode_row::house_acceleration_v) * v;
}

// Modes by pairs: the sums of modal_pass.h.
template <int N, bool kHeld>
SLEWLAB_INLINE FourSums<N> free_lanes(int modes, const Bundle& bundle, double* q_end, double* v_end, const Vec<N>& torque, const Vec<N>& rate,
                                      const Vec<N>& tip, const Vec<N>& tip_rate, const Vec<N>& house, const Vec<N>& uniform) {
  constexpr int kStride = mode_row::count * N;
  FourSums<N> sums{};
  const double* mode = bundle.modes.begin();
  const double* const q = bundle.q.begin();
  const double* const v = bundle.v.begin();
  for (int k = 0; k < modes; k += 2) {
    free_mode<N, kHeld>(mode, row<N>(q, k), row<N>(v, k), torque, rate, tip, tip_rate, house, uniform, row<N>(q_end, k), row<N>(v_end, k),
                        sums.even);
    free_mode<N, kHeld>(mode + kStride, row<N>(q, k + 1), row<N>(v, k + 1), torque, rate, tip, tip_rate, house, uniform,
                        row<N>(q_end, k + 1), row<N>(v_end, k + 1), sums.odd);
    mode += 2 * kStride;
  }
  return sums;
}

template <int N>
SLEWLAB_INLINE FourSums<N> end_lanes(int modes, const Bundle& bundle, double* q_end, double* v_end, const Vec<N>& torque, const Vec<N>& rate) {
  constexpr int kStride = mode_row::count * N;
  FourSums<N> sums{};
  const double* mode = bundle.modes.begin();
  for (int k = 0; k < modes; k += 2) {
    end_mode<N>(mode, torque, rate, row<N>(q_end, k), row<N>(v_end, k), sums.even);
    end_mode<N>(mode + kStride, torque, rate, row<N>(q_end, k + 1), row<N>(v_end, k + 1), sums.odd);
    mode += 2 * kStride;
  }
  return sums;
}

// The step of plant.cpp without friction and without a change of contact, line by line: attempt(), then accept(). Lanes in which a contact
// may change are taken out in between.
template <int N>
SLEWLAB_INLINE void step_lanes(PlantBatch& batch, Bundle& bundle, const PlantInput* inputs) {
  const int groups = batch.topology.groups, modes = batch.topology.modes;
  const double* const constants = bundle.machines.begin();
  const double* const push = bundle.push.begin();
  double* const state = bundle.state.begin();
  double* const q_end = bundle.q_end.begin();
  double* const v_end = bundle.v_end.begin();
  const auto group_of = [&](int i) { return bundle.groups.begin() + i * group_row::count * N; };
  const auto group_state_of = [&](int i) { return bundle.group_state.begin() + i * group_state_row::count * N; };

  const Vec<N> none{};
  const Vec<N> h = row<N>(constants, machine_row::step);
  const Vec<N> push_house = row<N>(push, push_row::house), push_tip = row<N>(push, push_row::tip), push_uniform{};
  const Vec<N> house_angle = row<N>(state, state_row::house_angle), house_speed = row<N>(state, state_row::house_speed);

  // start_of()
  Vec<N> start_torque[kMaximumGroupCount], start_rate[kMaximumGroupCount];
  Vec<N> start_torque_sum{}, start_rate_sum{};
  for (int i = 0; i < groups; ++i) {
    const double* const gear = group_of(i);
    const double* const of_group = group_state_of(i);
    const Vec<N> contact = row<N>(of_group, group_state_row::contact);
    const Vec<N> torque = row<N>(gear, group_row::stiffness) * (row<N>(of_group, group_state_row::angle) - house_angle -
                                                           contact * row<N>(gear, group_row::half_play)) +
                     row<N>(gear, group_row::damping) * (row<N>(of_group, group_state_row::speed) - house_speed);
    start_torque[i] = contact != 0.0 ? torque : none;
    start_torque_sum = contact != 0.0 ? start_torque_sum + torque : start_torque_sum;
  }
  const Vec<N> house_acceleration = row<N>(state, state_row::modal_house_acceleration) +
                               row<N>(constants, machine_row::per_house_torque) * (start_torque_sum + push_house) +
                               row<N>(constants, machine_row::per_tip_force) * (row<N>(state, state_row::rope_force) + push_tip) +
                               row<N>(constants, machine_row::per_uniform_force) * push_uniform;
  for (int i = 0; i < groups; ++i) {
    const double* const gear = group_of(i);
    const double* const of_group = group_state_of(i);
    const Vec<N> contact = row<N>(of_group, group_state_row::contact);
    const Vec<N> rate = row<N>(gear, group_row::stiffness) * (row<N>(of_group, group_state_row::speed) - house_speed) +
                   row<N>(gear, group_row::damping) *
                       ((row<N>(push, push_row::motor + i) - start_torque[i]) * row<N>(gear, group_row::mobility) - house_acceleration);
    start_rate[i] = contact != 0.0 ? rate : none;
    start_rate_sum = contact != 0.0 ? start_rate_sum + rate : start_rate_sum;
  }

  // advance_free()
  const Vec<N> force = row<N>(state, state_row::rope_force) + push_tip, force_rate = row<N>(state, state_row::rope_force_rate);
  const FourSums<N> free =
      bundle.has_held
          ? free_lanes<N, true>(modes, bundle, q_end, v_end, start_torque_sum, start_rate_sum, force, force_rate, push_house, push_uniform)
          : free_lanes<N, false>(modes, bundle, q_end, v_end, start_torque_sum, start_rate_sum, force, force_rate, push_house, push_uniform);
  const Vec<N> free_angle = free.total(0), free_speed = free.total(1);
  const Vec<N> free_acceleration = free.total(2) + free.total(3) + row<N>(constants, machine_row::per_house_torque) * push_house +
                              row<N>(constants, machine_row::per_tip_force) * (force + h * force_rate) +
                              row<N>(constants, machine_row::per_uniform_force) * push_uniform;

  // solve_end()
  Vec<N> right[kMaximumGroupCount][2], end_angle[kMaximumGroupCount], end_speed[kMaximumGroupCount], end_torque[kMaximumGroupCount];
  Vec<N> torque_right{}, rate_right{};
  Vec<N> answer[2][3] = {};
  for (int i = 0; i < groups; ++i) {
    const double* const gear = group_of(i);
    const double* const of_group = group_state_of(i);
    const Vec<N> contact = row<N>(of_group, group_state_row::contact), mobility = row<N>(gear, group_row::mobility);
    const Vec<N> speed = row<N>(of_group, group_state_row::speed);
    const Vec<N> motor = row<N>(push, push_row::motor + i) + 0.0;
    end_angle[i] = row<N>(of_group, group_state_row::angle) + h * speed +
                   h * h * (0.5 * motor - 0.35 * start_torque[i] - h * (1.0 / 20.0) * start_rate[i]) * mobility;
    end_speed[i] = speed + h * (motor - 0.5 * start_torque[i] - h * (1.0 / 12.0) * start_rate[i]) * mobility;
    const Vec<N> k = row<N>(gear, group_row::stiffness), c = row<N>(gear, group_row::damping);
    right[i][0] = k * (end_angle[i] - contact * row<N>(gear, group_row::half_play)) + c * end_speed[i];
    right[i][1] = k * end_speed[i] + c * motor * mobility;
    const Vec<N> torque_more = torque_right + (row<N>(gear, group_row::inverse) * right[i][0] + row<N>(gear, group_row::inverse + 1) * right[i][1]);
    const Vec<N> rate_more = rate_right + (row<N>(gear, group_row::inverse + 2) * right[i][0] + row<N>(gear, group_row::inverse + 3) * right[i][1]);
    torque_right = contact != 0.0 ? torque_more : torque_right;
    rate_right = contact != 0.0 ? rate_more : rate_right;
    for (int r = 0; r < 2; ++r) {
      for (int column = 0; column < 3; ++column) {
        const Vec<N> more = answer[r][column] + row<N>(gear, group_row::answer + 3 * r + column);
        answer[r][column] = contact != 0.0 ? more : answer[r][column];
      }
    }
  }
  const auto response = [&](int r, int column) -> const Vec<N>& { return row<N>(constants, machine_row::house + 2 * r + column); };
  Vec<N> system[2][2], side[2];
  for (int r = 0; r < 2; ++r) {
    side[r] = (r == 0 ? torque_right : rate_right) -
              (answer[r][0] * free_angle + answer[r][1] * free_speed + answer[r][2] * free_acceleration);
    for (int column = 0; column < 2; ++column) {
      system[r][column] = (r == column ? 1.0 : 0.0) + answer[r][0] * response(0, column) + answer[r][1] * response(1, column) +
                          answer[r][2] * response(2, column);
    }
  }
  const Vec<N> scale = 1.0 / (system[0][0] * system[1][1] - system[0][1] * system[1][0]);
  const Vec<N> torque_sum = (system[1][1] * side[0] - system[0][1] * side[1]) * scale;
  const Vec<N> rate_sum = (system[0][0] * side[1] - system[1][0] * side[0]) * scale;
  const Vec<N> end_house_angle = free_angle + response(0, 0) * torque_sum + response(0, 1) * rate_sum;
  const Vec<N> end_house_speed = free_speed + response(1, 0) * torque_sum + response(1, 1) * rate_sum;
  const Vec<N> end_house_acceleration = free_acceleration + response(2, 0) * torque_sum + response(2, 1) * rate_sum;

  auto may_change = none != 0.0;
  for (int i = 0; i < groups; ++i) {
    const double* const gear = group_of(i);
    const double* const of_group = group_state_of(i);
    const Vec<N> contact = row<N>(of_group, group_state_row::contact), mobility = row<N>(gear, group_row::mobility);
    const Vec<N> k = row<N>(gear, group_row::stiffness), c = row<N>(gear, group_row::damping);
    const Vec<N> r0 = right[i][0] - k * end_house_angle - c * end_house_speed;
    const Vec<N> r1 = right[i][1] - k * end_house_speed - c * end_house_acceleration;
    const Vec<N> torque = row<N>(gear, group_row::inverse) * r0 + row<N>(gear, group_row::inverse + 1) * r1;
    const Vec<N> rate = row<N>(gear, group_row::inverse + 2) * r0 + row<N>(gear, group_row::inverse + 3) * r1;
    end_torque[i] = contact != 0.0 ? torque : none;
    end_angle[i] = contact != 0.0 ? end_angle[i] - h * h * (0.15 * torque - h * (1.0 / 30.0) * rate) * mobility : end_angle[i];
    end_speed[i] = contact != 0.0 ? end_speed[i] - h * (0.5 * torque - h * (1.0 / 12.0) * rate) * mobility : end_speed[i];

    // may_change() of plant.cpp and turns_far_from_edge(), or a little more.
    const Vec<N> half_play = row<N>(gear, group_row::half_play), per_stiffness = row<N>(gear, group_row::damping_per_stiffness);
    const Vec<N> start = row<N>(of_group, group_state_row::angle) - house_angle, end = end_angle[i] - end_house_angle;
    const Vec<N> begin_rate = row<N>(of_group, group_state_row::speed) - house_speed, end_rate = end_speed[i] - end_house_speed;
    const Vec<N> flank = contact != 0.0 ? contact : none + 1.0;
    const Vec<N> depth = flank * end - half_play;
    const Vec<N> pushes = depth + per_stiffness * flank * end_rate;
    const Vec<N> below = -end - half_play;
    const Vec<N> pushes_below = below - per_stiffness * end_rate;
    const Vec<N> rates = magnitude<N>(begin_rate) + magnitude<N>(end_rate);
    const Vec<N> reach = h * rates + kRounding * (magnitude<N>(start) + magnitude<N>(end));
    const Vec<N> start_depth = flank * start - half_play;
    const Vec<N> fastest = 2.0 * row<N>(constants, machine_row::per_step) * magnitude<N>(end - start) + rates;
    const auto far_on_flank = (depth < start_depth ? depth : start_depth) - reach - per_stiffness * fastest > 0.0;
    const auto far_in_play = (magnitude<N>(start) + reach < half_play) & (magnitude<N>(end) + reach < half_play);
    const auto turns_back = (flank * begin_rate < 0.0) & (flank * end_rate > 0.0);
    const auto turns = ((begin_rate > 0.0) & (end_rate < 0.0)) | ((begin_rate < 0.0) & (end_rate > 0.0));
    const auto leaves = ~(pushes >= 0.0) | (turns_back & ~far_on_flank);
    const auto meets = ~((depth <= 0.0) | (pushes <= 0.0)) | ~((below <= 0.0) | (pushes_below <= 0.0)) | (turns & ~far_in_play);
    may_change |= contact != 0.0 ? leaves : meets;
  }
  for (int lane = 0; lane < bundle.used; ++lane) {
    if (may_change[lane] == 0) continue;
    if (!batch.alone[static_cast<std::size_t>(bundle.first + lane)].is_out) take_out(batch, bundle, lane, inputs[bundle.first + lane]);
  }

  // accept()
  const FourSums<N> ends = end_lanes<N>(modes, bundle, q_end, v_end, torque_sum, rate_sum);
  const Vec<N> tip = ends.total(0), tip_velocity = ends.total(1);
  row<N>(state, state_row::modal_house_acceleration) = ends.total(2) + ends.total(3);
  Vec<N> work = row<N>(state, state_row::supplied_work);
  for (int i = 0; i < groups; ++i) {
    double* const of_group = group_state_of(i);
    work += (row<N>(push, push_row::motor + i) + 0.0) * (end_angle[i] - row<N>(of_group, group_state_row::angle));
    row<N>(of_group, group_state_row::angle) = end_angle[i];
    row<N>(of_group, group_state_row::speed) = end_speed[i];
    row<N>(of_group, group_state_row::torque) = end_torque[i];
    row<N>(of_group, group_state_row::friction) = none;
  }
  const Vec<N> other_house_torque = push_house + 0.0;
  row<N>(state, state_row::house_friction) = none;
  row<N>(state, state_row::other_house_torque) = other_house_torque;
  work += other_house_torque * (end_house_angle - house_angle);
  row<N>(state, state_row::house_angle) = end_house_angle;
  row<N>(state, state_row::house_speed) = end_house_speed;
  row<N>(state, state_row::other_tip_force) = push_tip;
  row<N>(state, state_row::other_uniform_force) = push_uniform;
  const Vec<N> start_tip = row<N>(state, state_row::tip_displacement), start_tip_velocity = row<N>(state, state_row::tip_velocity);
  work += push_tip * (tip - start_tip);
  if (batch.topology.has_load) {
    const auto shape = [&](int r, int column) -> const Vec<N>& { return row<N>(constants, machine_row::load_modes + 2 * r + column); };
    Vec<N> before{}, after{};
    for (int j = 0; j < 2; ++j) {
      const double* const term = constants + (machine_row::load + j * machine_row::load_terms) * N;
      const Vec<N> in[4] = {start_tip, tip, start_tip_velocity, tip_velocity};
      const Vec<N> on_mode = shape(0, j) * row<N>(push, push_row::load) + shape(1, j) * row<N>(push, push_row::rod);
      Vec<N>& load_q = row<N>(state, state_row::load_q + j);
      Vec<N>& load_v = row<N>(state, state_row::load_v + j);
      before += on_mode * load_q;
      Vec<N> new_q = row<N>(term, 0) * load_q + row<N>(term, 1) * load_v + row<N>(term, 12) * on_mode;
      Vec<N> new_v = row<N>(term, 2) * load_q + row<N>(term, 3) * load_v + row<N>(term, 13) * on_mode;
      for (int n = 0; n < 4; ++n) {
        new_q += row<N>(term, 4 + n) * in[n];
        new_v += row<N>(term, 8 + n) * in[n];
      }
      load_q = new_q;
      load_v = new_v;
      after += on_mode * new_q;
    }
    work += after - before;

    // rope_forces()
    const Vec<N> y = shape(0, 0) * row<N>(state, state_row::load_q) + shape(0, 1) * row<N>(state, state_row::load_q + 1);
    const Vec<N> y_rate = shape(0, 0) * row<N>(state, state_row::load_v) + shape(0, 1) * row<N>(state, state_row::load_v + 1);
    const Vec<N> rod_rate = shape(1, 0) * row<N>(state, state_row::load_v) + shape(1, 1) * row<N>(state, state_row::load_v + 1);
    const Vec<N> damping = row<N>(constants, machine_row::rope_damping) * (y_rate - tip_velocity) +
                      row<N>(constants, machine_row::rod_damping) * rod_rate;
    const Vec<N> stiffness = row<N>(constants, machine_row::rope_stiffness);
    Vec<N> rope_force_rate = stiffness * (y_rate - tip_velocity);
    rope_force_rate += (damping - row<N>(state, state_row::rope_damping_force)) / h;
    row<N>(state, state_row::rope_force_rate) = rope_force_rate;
    row<N>(state, state_row::rope_damping_force) = damping;
    row<N>(state, state_row::rope_force) = stiffness * (y - tip) + damping;
  }
  row<N>(state, state_row::supplied_work) = work;
  row<N>(state, state_row::tip_displacement) = tip;
  row<N>(state, state_row::tip_velocity) = tip_velocity;
}

// read() of plant.cpp: accelerations of house and pivot (rows 0, 1), middle and tip.
template <int N>
SLEWLAB_INLINE void read_lanes(const Topology& topology, const Bundle& bundle, double* accelerations) {
  const double* const state = bundle.state.begin();
  Vec<N> gear_torque{};
  for (int i = 0; i < topology.groups; ++i) {
    gear_torque += row<N>(bundle.group_state.begin(), i * group_state_row::count + group_state_row::torque);
  }
  const Vec<N> house_torque = gear_torque + row<N>(state, state_row::other_house_torque);
  const Vec<N> tip_force = row<N>(state, state_row::rope_force) + row<N>(state, state_row::other_tip_force);
  const Vec<N> uniform_force = row<N>(state, state_row::other_uniform_force);
  Vec<N> pivot{}, middle{}, tip{};
  const double* mode = bundle.sensors.begin();
  for (int k = 0; k < topology.modes; ++k, mode += sensor_row::count * N) {
    const Vec<N> acceleration = -row<N>(mode, sensor_row::square) * row<N>(bundle.q.begin(), k) -
                           row<N>(mode, sensor_row::damping_rate) * row<N>(bundle.v.begin(), k) +
                           row<N>(mode, sensor_row::house) * house_torque + row<N>(mode, sensor_row::tip) * tip_force +
                           row<N>(mode, sensor_row::uniform) * uniform_force;
    pivot += row<N>(mode, sensor_row::pivot) * acceleration;
    middle += row<N>(mode, sensor_row::middle) * acceleration;
    tip += row<N>(mode, sensor_row::tip_sensor) * acceleration;
  }
  const double* const constants = bundle.machines.begin();
  row<N>(accelerations, 0) = row<N>(constants, machine_row::sensor_radius) * pivot;
  row<N>(accelerations, 1) = row<N>(constants, machine_row::pivot_radius) * pivot;
  row<N>(accelerations, 2) = middle;
  row<N>(accelerations, 3) = tip;
}

void step_portable(PlantBatch& batch, Bundle& bundle, const PlantInput* inputs) {
  step_lanes<4>(batch, bundle, inputs);
}
void read_portable(const Topology& topology, const Bundle& bundle, double* accelerations) {
  read_lanes<4>(topology, bundle, accelerations);
}
#ifdef __x86_64__
[[gnu::target("avx2")]] void step_four(PlantBatch& batch, Bundle& bundle, const PlantInput* inputs) {
  step_lanes<4>(batch, bundle, inputs);
}
[[gnu::target("avx2")]] void read_four(const Topology& topology, const Bundle& bundle, double* accelerations) {
  read_lanes<4>(topology, bundle, accelerations);
}
[[gnu::target("avx512f,avx512dq,avx512vl")]] void step_eight(PlantBatch& batch, Bundle& bundle, const PlantInput* inputs) {
  step_lanes<8>(batch, bundle, inputs);
}
[[gnu::target("avx512f,avx512dq,avx512vl")]] void read_eight(const Topology& topology, const Bundle& bundle, double* accelerations) {
  read_lanes<8>(topology, bundle, accelerations);
}
#else
constexpr auto step_four = step_portable, step_eight = step_portable;
constexpr auto read_four = read_portable, read_eight = read_portable;
#endif

// Calls `with(number of the state, row, lane)` for every number of a state that lies in a lane.
template <class Number, class State>
void for_each_number(State& state, Number&& with) {
  using namespace state_row;
  with(state.house_angle, house_angle);
  with(state.house_speed, house_speed);
  with(state.modal_house_acceleration, modal_house_acceleration);
  with(state.tip_displacement, tip_displacement);
  with(state.tip_velocity, tip_velocity);
  with(state.rope_force, rope_force);
  with(state.rope_force_rate, rope_force_rate);
  with(state.rope_damping_force, rope_damping_force);
  with(state.other_house_torque, other_house_torque);
  with(state.other_tip_force, other_tip_force);
  with(state.other_uniform_force, other_uniform_force);
  with(state.house_friction, house_friction);
  with(state.supplied_work, supplied_work);
  for (int j = 0; j < 2; ++j) {
    with(state.load_q[static_cast<std::size_t>(j)], load_q + j);
    with(state.load_v[static_cast<std::size_t>(j)], load_v + j);
  }
}

void from_lane(const Topology& topology, const Bundle& bundle, int lane, PlantState& state) {
  for_each_number(state, [&](double& number, int row) { number = bundle.state.at(row, lane); });
  for (int i = 0; i < topology.groups; ++i) {
    const auto at = [&](int row) { return bundle.group_state.at(i * group_state_row::count + row, lane); };
    state.motor_angle[i] = at(group_state_row::angle);
    state.motor_speed[i] = at(group_state_row::speed);
    state.gear_torque[i] = at(group_state_row::torque);
    state.motor_friction[i] = at(group_state_row::friction);
  }
  for (int k = 0; k < topology.modes; ++k) {
    state.q[static_cast<std::size_t>(k)] = bundle.q.at(k, lane);
    state.v[static_cast<std::size_t>(k)] = bundle.v.at(k, lane);
  }
}

void into_lane(const Topology& topology, Bundle& bundle, int lane, const PlantState& state) {
  for_each_number(state, [&](double number, int row) { bundle.state.at(row, lane) = number; });
  for (int i = 0; i < topology.groups; ++i) {
    const auto at = [&](int row) -> double& { return bundle.group_state.at(i * group_state_row::count + row, lane); };
    at(group_state_row::angle) = state.motor_angle[i];
    at(group_state_row::speed) = state.motor_speed[i];
    at(group_state_row::contact) = state.contact[i];
    at(group_state_row::torque) = state.gear_torque[i];
    at(group_state_row::friction) = state.motor_friction[i];
  }
  for (int k = 0; k < topology.modes; ++k) {
    bundle.q.at(k, lane) = state.q[static_cast<std::size_t>(k)];
    bundle.v.at(k, lane) = state.v[static_cast<std::size_t>(k)];
  }
}

// Steps the machine from the lane's state, which stays as it is; the end waits in `alone`.
[[gnu::noinline]] void take_out(PlantBatch& batch, Bundle& bundle, int lane, const PlantInput& input) {
  Alone& alone = batch.alone[static_cast<std::size_t>(bundle.first + lane)];
  from_lane(batch.topology, bundle, lane, alone.state);
  step(*alone.model, alone.workspace, input, alone.state);
  --alone.state.step_count;  // counted for all machines together
  alone.is_out = true;
  ++bundle.out;
  ++batch.out_of_line;
}

void fill_lane(const PlantModel& model, Bundle& bundle, int lane) {
  const auto machine = [&](int row) -> double& { return bundle.machines.at(row, lane); };
  machine(machine_row::step) = model.full.length;
  machine(machine_row::per_step) = 1.0 / model.full.length;
  machine(machine_row::ratio) = model.ratio;
  for (int r = 0; r < 3; ++r) {
    for (int column = 0; column < 2; ++column) machine(machine_row::house + 2 * r + column) = model.full.house[r][column];
  }
  machine(machine_row::per_house_torque) = model.house_per_house_torque;
  machine(machine_row::per_tip_force) = model.house_per_tip_force;
  machine(machine_row::per_uniform_force) = model.house_per_uniform_force;
  machine(machine_row::sensor_radius) = model.parameters.house.sensor_radius;
  machine(machine_row::pivot_radius) = model.parameters.boom.pivot_radius;
  machine(machine_row::rope_stiffness) = model.load.rope_stiffness;
  machine(machine_row::rope_damping) = model.load.damping(0, 0);
  machine(machine_row::rod_damping) = model.load.damping(0, 1);
  for (int r = 0; r < 2; ++r) {
    for (int column = 0; column < 2; ++column) machine(machine_row::load_modes + 2 * r + column) = model.load.modes(r, column);
  }
  const LoadStep& load = model.load_step;
  for (int j = 0; j < 2; ++j) {
    const auto term = [&](int n) -> double& { return machine(machine_row::load + j * machine_row::load_terms + n); };
    term(0) = load.qq[j];
    term(1) = load.qv[j];
    term(2) = load.vq[j];
    term(3) = load.vv[j];
    for (int n = 0; n < 4; ++n) {
      term(4 + n) = load.q_in[j][n];
      term(8 + n) = load.v_in[j][n];
    }
    term(12) = load.q_force[j];
    term(13) = load.v_force[j];
  }
  for (int i = 0; i < model.group_count; ++i) {
    const auto group = [&](int row) -> double& { return bundle.groups.at(i * group_row::count + row, lane); };
    const GearStep& gear = model.full.gear[static_cast<std::size_t>(i)];
    const GearContact& contact = model.gear[static_cast<std::size_t>(i)];
    group(group_row::stiffness) = contact.stiffness;
    group(group_row::damping) = contact.damping;
    group(group_row::damping_per_stiffness) = contact.damping / contact.stiffness;
    group(group_row::half_play) = contact.half_play;
    group(group_row::mobility) = gear.reciprocal_inertia;
    for (int r = 0; r < 2; ++r) {
      for (int column = 0; column < 2; ++column) group(group_row::inverse + 2 * r + column) = gear.inverse[r][column];
      for (int column = 0; column < 3; ++column) group(group_row::answer + 3 * r + column) = gear.answer[r][column];
    }
  }
  for (int k = 0; k < model.mode_count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const auto mode = [&](int row) -> double& { return bundle.modes.at(k * mode_row::count + row, lane); };
    const auto sensor = [&](int row) -> double& { return bundle.sensors.at(k * sensor_row::count + row, lane); };
    for (int term = 0; term < free_term::count; ++term) mode(term) = model.full.free[place(k, term, free_term::count)];
    for (int term = 0; term < end_term::count; ++term) mode(mode_row::end_q_torque + term) = model.full.end[place(k, term, end_term::count)];
    for (int term = 0; term < held_term::count; ++term) mode(mode_row::q_house + term) = model.full.held[place(k, term, held_term::count)];
    mode(mode_row::house) = sensor(sensor_row::house) = model.house[at];
    mode(mode_row::house_acceleration_q) = model.house_acceleration_q[at];
    mode(mode_row::house_acceleration_v) = model.house_acceleration_v[at];
    mode(mode_row::tip) = sensor(sensor_row::tip) = model.tip[at];
    sensor(sensor_row::square) = model.square[at];
    sensor(sensor_row::damping_rate) = model.damping_rate[at];
    sensor(sensor_row::uniform) = model.uniform[at];
    sensor(sensor_row::pivot) = model.pivot[at];
    sensor(sensor_row::middle) = model.middle[at];
    sensor(sensor_row::tip_sensor) = model.tip_sensor[at];
  }
}

// As step() of plant.cpp. True where the machine has to be taken out: friction, or a force along the boom.
bool fill_push(const PlantModel& model, const PlantInput& input, Bundle& bundle, int lane, bool& has_held) {
  bool out = input.friction.house_positive > 0.0 || input.friction.house_negative > 0.0 || input.ports.uniform_force != 0.0;
  for (int i = 0; i < model.group_count; ++i) {
    bundle.push.at(push_row::motor + i, lane) =
        input.motor_torque[i] * model.parameters.drive.motors_per_group * model.ratio + input.ports.motor_torque[i];
    out = out || input.friction.motor[i] > 0.0;
  }
  double house = input.ports.house_torque;
  if (model.has_axis_force) {
    const double angle = bundle.state.at(state_row::house_angle, lane), speed = bundle.state.at(state_row::house_speed, lane);
    house += axis_force_at(model.parameters.axis_force, angle + 0.5 * model.step * speed);
  }
  has_held = has_held || house != 0.0;
  bundle.push.at(push_row::house, lane) = house;
  bundle.push.at(push_row::tip, lane) = input.ports.tip_force;
  bundle.push.at(push_row::load, lane) = input.ports.load_force;
  bundle.push.at(push_row::rod, lane) = input.ports.rod_moment;
  return out;
}

}  // namespace

bool is_supported(BatchWidth width) {
  if (width == BatchWidth::portable) return true;
#ifdef __x86_64__
  if (width == BatchWidth::four) return __builtin_cpu_supports("avx2");
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

BatchWidth usual_width() { return is_supported(BatchWidth::four) ? BatchWidth::four : BatchWidth::portable; }

void FreePlantBatch::operator()(PlantBatch* batch) const { delete batch; }

PlantBatchHandle make_plant_batch(const std::vector<const PlantModel*>& models, BatchWidth width) {
  if (models.empty()) throw std::invalid_argument("a batch needs at least one machine");
  if (!is_supported(width)) throw std::invalid_argument("this processor has no vectors of the width that the batch asks for");
  const PlantModel& first = *models.front();
  for (const PlantModel* const model : models) {
    if (model->is_rigid) throw std::invalid_argument("a machine with a rigid drive is one inertia, which is not stepped in a batch");
    if (model->group_count != first.group_count || model->mode_count != first.mode_count || model->has_load != first.has_load) {
      throw std::invalid_argument("the machines of a batch need the same number of motor groups and modes, and all a load or none");
    }
  }
  PlantBatchHandle batch(new PlantBatch);
  batch->topology = {first.group_count, first.mode_count, first.has_load};
  batch->lanes = width == BatchWidth::eight ? 8 : 4;
  batch->step_lanes = width == BatchWidth::eight ? step_eight : width == BatchWidth::four ? step_four : step_portable;
  batch->read_lanes = width == BatchWidth::eight ? read_eight : width == BatchWidth::four ? read_four : read_portable;
  const int count = static_cast<int>(models.size()), lanes = batch->lanes;
  for (const PlantModel* const model : models) {
    batch->alone.push_back({model, make_plant_workspace(*model), make_plant_state(*model)});
  }
  const int whole_pairs = (first.mode_count + 1) / 2 * 2;
  for (int from = 0; from < count; from += lanes) {
    Bundle bundle;
    bundle.first = from;
    bundle.used = std::min(lanes, count - from);
    bundle.modes.size(whole_pairs * mode_row::count, lanes);
    bundle.sensors.size(whole_pairs * sensor_row::count, lanes);
    bundle.machines.size(machine_row::count, lanes);
    bundle.groups.size(first.group_count * group_row::count, lanes);
    bundle.state.size(state_row::count, lanes);
    bundle.group_state.size(first.group_count * group_state_row::count, lanes);
    for (Rows* const rows : {&bundle.q, &bundle.v, &bundle.q_end, &bundle.v_end}) rows->size(whole_pairs, lanes);
    bundle.push.size(push_row::count, lanes);
    for (int lane = 0; lane < lanes; ++lane) fill_lane(*models[static_cast<std::size_t>(std::min(from + lane, count - 1))], bundle, lane);
    batch->bundles.push_back(std::move(bundle));
  }
  return batch;
}

int machine_count(const PlantBatch& batch) { return static_cast<int>(batch.alone.size()); }

void set_state(PlantBatch& batch, int machine, const PlantState& state) {
  PlantState& kept = batch.alone[static_cast<std::size_t>(machine)].state;
  kept = state;
  kept.step_count -= batch.steps;
  into_lane(batch.topology, batch.bundles[static_cast<std::size_t>(machine / batch.lanes)], machine % batch.lanes, kept);
}

void state_of(const PlantBatch& batch, int machine, PlantState& state) {
  state = batch.alone[static_cast<std::size_t>(machine)].state;
  state.step_count += batch.steps;
  from_lane(batch.topology, batch.bundles[static_cast<std::size_t>(machine / batch.lanes)], machine % batch.lanes, state);
}

void step_batch(PlantBatch& batch, const PlantInput* inputs) {
  // All bundles' inputs first: a vector load of what was written number by number a moment ago would wait for the writes.
  for (Bundle& bundle : batch.bundles) {
    bundle.has_held = false;
    bundle.out = 0;
    for (int lane = 0; lane < bundle.used; ++lane) {
      const int machine = bundle.first + lane;
      Alone& alone = batch.alone[static_cast<std::size_t>(machine)];
      alone.is_out = false;
      if (!fill_push(*alone.model, inputs[machine], bundle, lane, bundle.has_held)) continue;
      take_out(batch, bundle, lane, inputs[machine]);
    }
  }
  for (Bundle& bundle : batch.bundles) {
    if (bundle.out < bundle.used) {
      batch.step_lanes(batch, bundle, inputs);
      std::swap(bundle.q, bundle.q_end);
      std::swap(bundle.v, bundle.v_end);
    }
    if (bundle.out == 0) continue;
    for (int lane = 0; lane < bundle.used; ++lane) {
      const Alone& alone = batch.alone[static_cast<std::size_t>(bundle.first + lane)];
      if (alone.is_out) into_lane(batch.topology, bundle, lane, alone.state);
    }
  }
  ++batch.steps;
}

std::int64_t steps_out_of_line(const PlantBatch& batch) { return batch.out_of_line; }

void read_batch(const PlantBatch& batch, PlantReadings* readings) {
  for (const Bundle& bundle : batch.bundles) {
    Line accelerations[4];
    batch.read_lanes(batch.topology, bundle, accelerations[0].number);
    for (int lane = 0; lane < bundle.used; ++lane) {
      const auto acceleration = [&](int row) { return accelerations[0].number[row * batch.lanes + lane]; };
      const double ratio = bundle.machines.at(machine_row::ratio, lane);
      PlantReadings& reading = readings[bundle.first + lane];
      reading = {};
      for (int i = 0; i < batch.topology.groups; ++i) {
        const auto of_group = [&](int row) { return bundle.group_state.at(i * group_state_row::count + row, lane); };
        reading.shaft_speed[i] = of_group(group_state_row::speed) * ratio;
        reading.shaft_position[i] = of_group(group_state_row::angle) * ratio;
      }
      reading.house_acceleration = acceleration(0);
      reading.pivot_acceleration = acceleration(1);
      reading.middle_acceleration = acceleration(2);
      reading.tip_acceleration = acceleration(3);
      reading.slew_angle = bundle.state.at(state_row::house_angle, lane);
    }
  }
}

}  // namespace slewlab::sim
