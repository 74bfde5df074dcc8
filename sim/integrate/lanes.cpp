#include "sim/integrate/lanes.h"

#include <bit>
#include <limits>
#include <utility>

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
template <int N>
using Bits = decltype(Vec<N>{} < Vec<N>{});

constexpr long kSignBit = std::numeric_limits<long>::min();
constexpr long kInfinity = std::bit_cast<long>(std::numeric_limits<double>::infinity());  // no number is beyond
constexpr double kRounding = 1e-12;  // [-] of angles, more than the cubic of a deflection loses

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
  return (Vec<N>)((Bits<N>)a & ~kSignBit);
}
// `a` where the mask has all bits, +0 elsewhere: sums that begin at +0 go on as if nothing had been added.
template <int N>
SLEWLAB_INLINE Vec<N> where(const Vec<N>& mask, const Vec<N>& a) {
  return (Vec<N>)((Bits<N>)mask & (Bits<N>)a);
}
template <int N>
SLEWLAB_INLINE Vec<N> chosen(const Vec<N>& mask, const Vec<N>& a, const Vec<N>& b) {
  return (Vec<N>)(((Bits<N>)mask & (Bits<N>)a) | (~(Bits<N>)mask & (Bits<N>)b));
}

// The rows of a bundle as a step reads and writes them.
template <int N>
struct Lanes {
  const double *constants, *groups, *push;
  double *state, *group_state, *trial;

  SLEWLAB_INLINE explicit Lanes(Bundle& bundle)
      : constants(bundle.machines.begin()),
        groups(bundle.groups.begin()),
        push(bundle.push.begin()),
        state(bundle.state.begin()),
        group_state(bundle.group_state.begin()),
        trial(bundle.trial.begin()) {}
  SLEWLAB_INLINE const Vec<N>& of_machine(int index) const { return row<N>(constants, index); }
  SLEWLAB_INLINE const Vec<N>& response(int r, int column) const { return of_machine(machine_row::house + 2 * r + column); }
  SLEWLAB_INLINE const Vec<N>& of_gear(int group, int index) const { return row<N>(groups, group * group_row::count + index); }
  SLEWLAB_INLINE const Vec<N>& pushed(int index) const { return row<N>(push, index); }
  SLEWLAB_INLINE Vec<N>& of_state(int index) const { return row<N>(state, index); }
  SLEWLAB_INLINE Vec<N>& of_group(int group, int index) const { return row<N>(group_state, group * group_state_row::count + index); }
  SLEWLAB_INLINE Vec<N>& tried(int index) const { return row<N>(trial, index); }
  SLEWLAB_INLINE Vec<N>& tried(int group, int index) const { return tried(trial_row::group + group * trial_row::group_terms + index); }
};

template <int N>
struct Start {
  Vec<N> torque[kMaximumGroupCount], rate[kMaximumGroupCount];
  Vec<N> torque_sum, rate_sum;
};
template <int N>
struct House {
  Vec<N> angle, speed, acceleration;
};
template <int N>
struct FourSums {
  Vec<N> even[4], odd[4];
  SLEWLAB_INLINE Vec<N> total(int index) const { return even[index] + odd[index]; }
};

// start_of()
template <int N>
SLEWLAB_INLINE void start_of(const Lanes<N>& lanes, int groups, Start<N>& start) {
  const Vec<N> none{};
  const Vec<N> house_angle = lanes.of_state(state_row::house_angle), house_speed = lanes.of_state(state_row::house_speed);
  start.torque_sum = start.rate_sum = none;
  for (int i = 0; i < groups; ++i) {
    const Vec<N> torque = lanes.of_gear(i, group_row::stiffness) *
                              (lanes.of_group(i, group_state_row::angle) - house_angle - lanes.of_group(i, group_state_row::edge)) +
                          lanes.of_gear(i, group_row::damping) * (lanes.of_group(i, group_state_row::speed) - house_speed);
    start.torque[i] = where<N>(lanes.of_group(i, group_state_row::touches), torque);
    start.torque_sum += start.torque[i];
  }
  const Vec<N> house_acceleration = lanes.of_state(state_row::modal_house_acceleration) +
                                    lanes.of_machine(machine_row::per_house_torque) * (start.torque_sum + lanes.pushed(push_row::house)) +
                                    lanes.of_machine(machine_row::per_tip_force) *
                                        (lanes.of_state(state_row::rope_force) + lanes.pushed(push_row::tip)) +
                                    lanes.of_machine(machine_row::per_uniform_force) * none;
  for (int i = 0; i < groups; ++i) {
    const Vec<N> rate = lanes.of_gear(i, group_row::stiffness) * (lanes.of_group(i, group_state_row::speed) - house_speed) +
                        lanes.of_gear(i, group_row::damping) *
                            ((lanes.pushed(push_row::motor + i) - start.torque[i]) * lanes.of_gear(i, group_row::mobility) - house_acceleration);
    start.rate[i] = where<N>(lanes.of_group(i, group_state_row::touches), rate);
    start.rate_sum += start.rate[i];
  }
}

template <int N>
struct FreeLoadsOf {
  Vec<N> torque, rate, tip, tip_rate, house, uniform, is_held;
};

template <int N, bool kHeld>
SLEWLAB_INLINE void free_mode(const double* mode, const FreeLoadsOf<N>& on, const Vec<N>& q0, const Vec<N>& v0, Vec<N>& q_end, Vec<N>& v_end,
                              Vec<N>* sums) {
  using namespace mode_row;
  Vec<N> q = row<N>(mode, qq) * q0 + row<N>(mode, qv) * v0 + row<N>(mode, q_torque) * on.torque + row<N>(mode, q_rate) * on.rate +
             row<N>(mode, tip_once) * on.tip + row<N>(mode, q_tip_rate) * on.tip_rate;
  Vec<N> v = row<N>(mode, vq) * q0 + row<N>(mode, vv) * v0 + row<N>(mode, v_torque) * on.torque + row<N>(mode, v_rate) * on.rate +
             row<N>(mode, v_tip) * on.tip + row<N>(mode, tip_once) * on.tip_rate;
  if constexpr (kHeld) {
    q = chosen<N>(on.is_held, q + (row<N>(mode, q_house) * on.house + row<N>(mode, q_uniform) * on.uniform), q);
    v = chosen<N>(on.is_held, v + (row<N>(mode, v_house) * on.house + row<N>(mode, v_uniform) * on.uniform), v);
  }
  q_end = q;
  v_end = v;
  sums[0] += row<N>(mode, house) * q;
  sums[1] += row<N>(mode, house) * v;
  sums[2] += row<N>(mode, house_acceleration_q) * q;
  sums[3] += row<N>(mode, house_acceleration_v) * v;
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
SLEWLAB_INLINE FourSums<N> free_pass(int modes, Bundle& bundle, const FreeLoadsOf<N>& on) {
  constexpr int kStride = mode_row::count * N;
  FourSums<N> sums{};
  const double* mode = bundle.modes.begin();
  const double* const q = bundle.q.begin();
  const double* const v = bundle.v.begin();
  double* const q_end = bundle.q_end.begin();
  double* const v_end = bundle.v_end.begin();
  for (int k = 0; k < modes; k += 2, mode += 2 * kStride) {
    free_mode<N, kHeld>(mode, on, row<N>(q, k), row<N>(v, k), row<N>(q_end, k), row<N>(v_end, k), sums.even);
    free_mode<N, kHeld>(mode + kStride, on, row<N>(q, k + 1), row<N>(v, k + 1), row<N>(q_end, k + 1), row<N>(v_end, k + 1), sums.odd);
  }
  return sums;
}

template <int N>
SLEWLAB_INLINE FourSums<N> end_pass(int modes, Bundle& bundle, const Vec<N>& torque, const Vec<N>& rate) {
  constexpr int kStride = mode_row::count * N;
  FourSums<N> sums{};
  const double* mode = bundle.modes.begin();
  double* const q_end = bundle.q_end.begin();
  double* const v_end = bundle.v_end.begin();
  for (int k = 0; k < modes; k += 2, mode += 2 * kStride) {
    end_mode<N>(mode, torque, rate, row<N>(q_end, k), row<N>(v_end, k), sums.even);
    end_mode<N>(mode + kStride, torque, rate, row<N>(q_end, k + 1), row<N>(v_end, k + 1), sums.odd);
  }
  return sums;
}

// advance_free()
template <int N>
SLEWLAB_INLINE House<N> advance_free(const Lanes<N>& lanes, int modes, Bundle& bundle, const Start<N>& start) {
  const Vec<N> house = lanes.pushed(push_row::house), uniform{};
  const Vec<N> force = lanes.of_state(state_row::rope_force) + lanes.pushed(push_row::tip), force_rate = lanes.of_state(state_row::rope_force_rate);
  const FreeLoadsOf<N> on{start.torque_sum, start.rate_sum, force, force_rate, house, uniform, lanes.pushed(push_row::is_held)};
  const FourSums<N> sums = bundle.has_held ? free_pass<N, true>(modes, bundle, on) : free_pass<N, false>(modes, bundle, on);
  return {sums.total(0), sums.total(1),
          sums.total(2) + sums.total(3) + lanes.of_machine(machine_row::per_house_torque) * house +
              lanes.of_machine(machine_row::per_tip_force) * (force + lanes.of_machine(machine_row::step) * force_rate) +
              lanes.of_machine(machine_row::per_uniform_force) * uniform};
}

// solve_end(), into the trial's rows.
template <int N>
SLEWLAB_INLINE House<N> solve_end(const Lanes<N>& lanes, int groups, const Start<N>& start, const House<N>& free) {
  const Vec<N> h = lanes.of_machine(machine_row::step);
  Vec<N> right[kMaximumGroupCount][2], angle[kMaximumGroupCount], speed[kMaximumGroupCount];
  Vec<N> torque_right{}, rate_right{};
  for (int i = 0; i < groups; ++i) {
    const Vec<N> mobility = lanes.of_gear(i, group_row::mobility), touches = lanes.of_group(i, group_state_row::touches);
    const Vec<N> k = lanes.of_gear(i, group_row::stiffness), c = lanes.of_gear(i, group_row::damping);
    const Vec<N> start_speed = lanes.of_group(i, group_state_row::speed), motor = lanes.pushed(push_row::motor + i) + 0.0;
    angle[i] = lanes.of_group(i, group_state_row::angle) + h * start_speed +
               h * h * (0.5 * motor - 0.35 * start.torque[i] - h * (1.0 / 20.0) * start.rate[i]) * mobility;
    speed[i] = start_speed + h * (motor - 0.5 * start.torque[i] - h * (1.0 / 12.0) * start.rate[i]) * mobility;
    right[i][0] = k * (angle[i] - lanes.of_group(i, group_state_row::edge)) + c * speed[i];
    right[i][1] = k * speed[i] + c * motor * mobility;
    const auto inverse = [&](int r, int column) { return lanes.of_gear(i, group_row::inverse + 2 * r + column); };
    torque_right += where<N>(touches, inverse(0, 0) * right[i][0] + inverse(0, 1) * right[i][1]);
    rate_right += where<N>(touches, inverse(1, 0) * right[i][0] + inverse(1, 1) * right[i][1]);
  }
  const auto answer = [&](int r, int column) { return lanes.of_state(state_row::answer + 3 * r + column); };
  const auto system = [&](int r, int column) { return lanes.of_state(state_row::system + 2 * r + column); };
  Vec<N> side[2];
  for (int r = 0; r < 2; ++r) {
    side[r] = (r == 0 ? torque_right : rate_right) - (answer(r, 0) * free.angle + answer(r, 1) * free.speed + answer(r, 2) * free.acceleration);
  }
  const Vec<N> scale = lanes.of_state(state_row::scale);
  const Vec<N> torque_sum = (system(1, 1) * side[0] - system(0, 1) * side[1]) * scale;
  const Vec<N> rate_sum = (system(0, 0) * side[1] - system(1, 0) * side[0]) * scale;
  const House<N> house{free.angle + lanes.response(0, 0) * torque_sum + lanes.response(0, 1) * rate_sum,
                       free.speed + lanes.response(1, 0) * torque_sum + lanes.response(1, 1) * rate_sum,
                       free.acceleration + lanes.response(2, 0) * torque_sum + lanes.response(2, 1) * rate_sum};
  lanes.tried(trial_row::torque_sum) = torque_sum;
  lanes.tried(trial_row::rate_sum) = rate_sum;
  lanes.tried(trial_row::house_angle) = house.angle;
  lanes.tried(trial_row::house_speed) = house.speed;
  for (int i = 0; i < groups; ++i) {
    const Vec<N> mobility = lanes.of_gear(i, group_row::mobility), touches = lanes.of_group(i, group_state_row::touches);
    const Vec<N> k = lanes.of_gear(i, group_row::stiffness), c = lanes.of_gear(i, group_row::damping);
    const auto inverse = [&](int r, int column) { return lanes.of_gear(i, group_row::inverse + 2 * r + column); };
    const Vec<N> r0 = right[i][0] - k * house.angle - c * house.speed;
    const Vec<N> r1 = right[i][1] - k * house.speed - c * house.acceleration;
    const Vec<N> torque = where<N>(touches, inverse(0, 0) * r0 + inverse(0, 1) * r1);
    const Vec<N> rate = where<N>(touches, inverse(1, 0) * r0 + inverse(1, 1) * r1);
    lanes.tried(i, trial_row::torque) = torque;
    lanes.tried(i, trial_row::angle) = angle[i] - h * h * (0.15 * torque - h * (1.0 / 30.0) * rate) * mobility;
    lanes.tried(i, trial_row::speed) = speed[i] - h * (0.5 * torque - h * (1.0 / 12.0) * rate) * mobility;
  }
  return house;
}

// By lane: may_change() of plant.cpp where turns_far_from_edge() does not say no, or a little more. Asked by sign bits alone: comparisons of
// vectors are slow where the processor keeps their answers apart. What is no number may change.
template <int N>
SLEWLAB_INLINE unsigned may_change(const Lanes<N>& lanes, int groups, const House<N>& house) {
  const Vec<N> h = lanes.of_machine(machine_row::step), per_step = lanes.of_machine(machine_row::per_step);
  const Vec<N> house_angle = lanes.of_state(state_row::house_angle), house_speed = lanes.of_state(state_row::house_speed);
  Bits<N> may{};
  for (int i = 0; i < groups; ++i) {
    const Vec<N> half_play = lanes.of_gear(i, group_row::half_play), per_stiffness = lanes.of_gear(i, group_row::damping_per_stiffness);
    const Vec<N> contact = lanes.of_group(i, group_state_row::contact);
    const Vec<N> start = lanes.of_group(i, group_state_row::angle) - house_angle, end = lanes.tried(i, trial_row::angle) - house.angle;
    const Vec<N> start_rate = lanes.of_group(i, group_state_row::speed) - house_speed, end_rate = lanes.tried(i, trial_row::speed) - house.speed;
    const Vec<N> rates = magnitude<N>(start_rate) + magnitude<N>(end_rate);
    const Vec<N> reach = h * rates + kRounding * (magnitude<N>(start) + magnitude<N>(end));
    const Bits<N> turns = (Bits<N>)start_rate ^ (Bits<N>)end_rate;
    const Bits<N> is_no_number = kInfinity - (Bits<N>)reach;

    // In contact, all by the flank's side.
    const Vec<N> depth = contact * end - half_play;
    const Vec<N> far = reach + per_stiffness * (2.0 * per_step * magnitude<N>(end - start) + rates);
    const Bits<N> pulls = (Bits<N>)(depth + per_stiffness * (contact * end_rate));
    const Bits<N> is_far = (Bits<N>)(far - (contact * start - half_play)) & (Bits<N>)(far - depth);
    const Bits<N> leaves = pulls | (turns & (Bits<N>)(contact * start_rate) & ~is_far);

    // In the play, by the side at which it ends.
    const Vec<N> from_middle = magnitude<N>(end), outwards = (Vec<N>)((Bits<N>)end_rate ^ ((Bits<N>)end & kSignBit));
    const Bits<N> pushes = (Bits<N>)(half_play - from_middle) & ~(Bits<N>)(from_middle - half_play + per_stiffness * outwards);
    const Bits<N> is_far_inside = (Bits<N>)(magnitude<N>(start) + reach - half_play) & (Bits<N>)(from_middle + reach - half_play);
    const Bits<N> meets = pushes | (turns & ~is_far_inside);

    const Bits<N> touches = (Bits<N>)lanes.of_group(i, group_state_row::touches);
    may |= is_no_number | (touches & leaves) | (~touches & meets);
  }
  unsigned lanes_that_may = 0;
  for (int lane = 0; lane < N; ++lane) lanes_that_may |= static_cast<unsigned>(static_cast<unsigned long>(may[lane]) >> 63) << lane;
  return lanes_that_may;
}

// With the number of groups known when this is compiled, or 0.
template <int N, int kGroups>
SLEWLAB_INLINE void attempt_of(const Topology& topology, Bundle* bundles, int count) {
  const int groups = kGroups > 0 ? kGroups : topology.groups;
  Start<N> starts[kBundlesTogether];
  House<N> free[kBundlesTogether];
  for (int b = 0; b < count; ++b) start_of<N>(Lanes<N>(bundles[b]), groups, starts[b]);
  for (int b = 0; b < count; ++b) free[b] = advance_free<N>(Lanes<N>(bundles[b]), topology.modes, bundles[b], starts[b]);
  for (int b = 0; b < count; ++b) {
    const Lanes<N> lanes(bundles[b]);
    bundles[b].may_change = may_change<N>(lanes, groups, solve_end<N>(lanes, groups, starts[b], free[b]));
  }
}

template <int N>
SLEWLAB_INLINE void attempt_lanes(const Topology& topology, Bundle* bundles, int count) {
  if (topology.groups == 2) {
    attempt_of<N, 2>(topology, bundles, count);
  } else {
    attempt_of<N, 0>(topology, bundles, count);
  }
}

// The load's modes under a tip that moves linearly over the step, and rope_forces(). Returns what forces on the load did [J].
template <int N>
SLEWLAB_INLINE Vec<N> swing_load(const Lanes<N>& lanes, const Vec<N>& tip, const Vec<N>& tip_velocity) {
  const auto shape = [&](int r, int column) { return lanes.of_machine(machine_row::load_modes + 2 * r + column); };
  const Vec<N> in[4] = {lanes.of_state(state_row::tip_displacement), tip, lanes.of_state(state_row::tip_velocity), tip_velocity};
  Vec<N> q[2], v[2], before{}, after{};
  for (int j = 0; j < 2; ++j) {
    const auto term = [&](int n) { return lanes.of_machine(machine_row::load + j * machine_row::load_terms + n); };
    const Vec<N> on_mode = shape(0, j) * lanes.pushed(push_row::load) + shape(1, j) * lanes.pushed(push_row::rod);
    const Vec<N> start_q = lanes.of_state(state_row::load_q + j), start_v = lanes.of_state(state_row::load_v + j);
    before += on_mode * start_q;
    q[j] = term(0) * start_q + term(1) * start_v + term(12) * on_mode;
    v[j] = term(2) * start_q + term(3) * start_v + term(13) * on_mode;
    for (int n = 0; n < 4; ++n) {
      q[j] += term(4 + n) * in[n];
      v[j] += term(8 + n) * in[n];
    }
    lanes.of_state(state_row::load_q + j) = q[j];
    lanes.of_state(state_row::load_v + j) = v[j];
    after += on_mode * q[j];
  }
  const Vec<N> y = shape(0, 0) * q[0] + shape(0, 1) * q[1];
  const Vec<N> y_rate = shape(0, 0) * v[0] + shape(0, 1) * v[1];
  const Vec<N> rod_rate = shape(1, 0) * v[0] + shape(1, 1) * v[1];
  const Vec<N> damping = lanes.of_machine(machine_row::rope_damping) * (y_rate - tip_velocity) + lanes.of_machine(machine_row::rod_damping) * rod_rate;
  const Vec<N> stiffness = lanes.of_machine(machine_row::rope_stiffness);
  Vec<N> force_rate = stiffness * (y_rate - tip_velocity);
  force_rate += (damping - lanes.of_state(state_row::rope_damping_force)) / lanes.of_machine(machine_row::step);
  lanes.of_state(state_row::rope_force_rate) = force_rate;
  lanes.of_state(state_row::rope_damping_force) = damping;
  lanes.of_state(state_row::rope_force) = stiffness * (y - tip) + damping;
  return after - before;
}

// accept() without friction and without a force along the boom.
template <int N>
SLEWLAB_INLINE void accept_one(const Topology& topology, Bundle& bundle) {
  const Lanes<N> lanes(bundle);
  const Vec<N> none{};
  const FourSums<N> ends = end_pass<N>(topology.modes, bundle, lanes.tried(trial_row::torque_sum), lanes.tried(trial_row::rate_sum));
  std::swap(bundle.q, bundle.q_end);
  std::swap(bundle.v, bundle.v_end);
  const Vec<N> tip = ends.total(0), tip_velocity = ends.total(1);
  lanes.of_state(state_row::modal_house_acceleration) = ends.total(2) + ends.total(3);

  Vec<N> work = lanes.of_state(state_row::supplied_work);
  for (int i = 0; i < topology.groups; ++i) {
    const Vec<N> angle = lanes.tried(i, trial_row::angle);
    work += (lanes.pushed(push_row::motor + i) + 0.0) * (angle - lanes.of_group(i, group_state_row::angle));
    lanes.of_group(i, group_state_row::angle) = angle;
    lanes.of_group(i, group_state_row::speed) = lanes.tried(i, trial_row::speed);
    lanes.of_group(i, group_state_row::torque) = lanes.tried(i, trial_row::torque);
    lanes.of_group(i, group_state_row::friction) = none;
  }
  const Vec<N> house_torque = lanes.pushed(push_row::house) + 0.0, tip_force = lanes.pushed(push_row::tip);
  const Vec<N> house_angle = lanes.tried(trial_row::house_angle);
  work += house_torque * (house_angle - lanes.of_state(state_row::house_angle));
  work += tip_force * (tip - lanes.of_state(state_row::tip_displacement));
  lanes.of_state(state_row::house_friction) = none;
  lanes.of_state(state_row::other_house_torque) = house_torque;
  lanes.of_state(state_row::other_tip_force) = tip_force;
  lanes.of_state(state_row::other_uniform_force) = none;
  lanes.of_state(state_row::house_angle) = house_angle;
  lanes.of_state(state_row::house_speed) = lanes.tried(trial_row::house_speed);
  if (topology.has_load) work += swing_load<N>(lanes, tip, tip_velocity);
  lanes.of_state(state_row::supplied_work) = work;
  lanes.of_state(state_row::tip_displacement) = tip;
  lanes.of_state(state_row::tip_velocity) = tip_velocity;
}

template <int N>
SLEWLAB_INLINE void accept_lanes(const Topology& topology, Bundle* bundles, int count) {
  for (int b = 0; b < count; ++b) accept_one<N>(topology, bundles[b]);
}

template <int N>
SLEWLAB_INLINE void accelerations_of(const Topology& topology, const Bundle& bundle, LaneAccelerations& result) {
  const double* const state = bundle.state.begin();
  Vec<N> gear_torque{};
  for (int i = 0; i < topology.groups; ++i) {
    gear_torque += row<N>(bundle.group_state.begin(), i * group_state_row::count + group_state_row::torque);
  }
  const Vec<N> house_torque = gear_torque + row<N>(state, state_row::other_house_torque);
  const Vec<N> tip_force = row<N>(state, state_row::rope_force) + row<N>(state, state_row::other_tip_force);
  const Vec<N> uniform_force = row<N>(state, state_row::other_uniform_force);
  Vec<N> at_house{}, at_tip{}, at_boom{}, at_pivot{}, at_middle{}, at_tip_sensor{};
  const double* mode = bundle.sensors.begin();
  for (int k = 0; k < topology.modes; ++k, mode += sensor_row::count * N) {
    const Vec<N> acceleration = -row<N>(mode, sensor_row::square) * row<N>(bundle.q.begin(), k) -
                                row<N>(mode, sensor_row::damping_rate) * row<N>(bundle.v.begin(), k) +
                                row<N>(mode, sensor_row::house) * house_torque + row<N>(mode, sensor_row::tip) * tip_force +
                                row<N>(mode, sensor_row::uniform) * uniform_force;
    at_house += row<N>(mode, sensor_row::house) * acceleration;
    at_tip += row<N>(mode, sensor_row::tip) * acceleration;
    at_boom += row<N>(mode, sensor_row::uniform) * acceleration;
    at_pivot += row<N>(mode, sensor_row::pivot) * acceleration;
    at_middle += row<N>(mode, sensor_row::middle) * acceleration;
    at_tip_sensor += row<N>(mode, sensor_row::tip_sensor) * acceleration;
  }
  row<N>(result.rows[place_term::house].number, 0) = at_house;
  row<N>(result.rows[place_term::tip].number, 0) = at_tip;
  row<N>(result.rows[place_term::boom].number, 0) = at_boom;
  row<N>(result.rows[place_term::pivot].number, 0) = at_pivot;
  row<N>(result.rows[place_term::middle].number, 0) = at_middle;
  row<N>(result.rows[place_term::tip_sensor].number, 0) = at_tip_sensor;
}

void attempt_portable(const Topology& topology, Bundle* bundles, int count) { attempt_lanes<4>(topology, bundles, count); }
void accept_portable(const Topology& topology, Bundle* bundles, int count) { accept_lanes<4>(topology, bundles, count); }
void accelerations_portable(const Topology& topology, const Bundle& bundle, LaneAccelerations& result) {
  accelerations_of<4>(topology, bundle, result);
}
#ifdef __x86_64__
#define SLEWLAB_AVX2 [[gnu::target("avx2")]]
#define SLEWLAB_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl")]]
SLEWLAB_AVX2 void attempt_four(const Topology& topology, Bundle* bundles, int count) { attempt_lanes<4>(topology, bundles, count); }
SLEWLAB_AVX2 void accept_four(const Topology& topology, Bundle* bundles, int count) { accept_lanes<4>(topology, bundles, count); }
SLEWLAB_AVX2 void accelerations_four(const Topology& topology, const Bundle& bundle, LaneAccelerations& result) {
  accelerations_of<4>(topology, bundle, result);
}
SLEWLAB_AVX512 void attempt_eight(const Topology& topology, Bundle* bundles, int count) { attempt_lanes<8>(topology, bundles, count); }
SLEWLAB_AVX512 void accept_eight(const Topology& topology, Bundle* bundles, int count) { accept_lanes<8>(topology, bundles, count); }
SLEWLAB_AVX512 void accelerations_eight(const Topology& topology, const Bundle& bundle, LaneAccelerations& result) {
  accelerations_of<8>(topology, bundle, result);
}
#else
constexpr auto attempt_four = attempt_portable, attempt_eight = attempt_portable;
constexpr auto accept_four = accept_portable, accept_eight = accept_portable;
constexpr auto accelerations_four = accelerations_portable, accelerations_eight = accelerations_portable;
#endif

}  // namespace

const LaneFunctions& four_portable_lanes() {
  static constexpr LaneFunctions kFunctions{attempt_portable, accept_portable, accelerations_portable};
  return kFunctions;
}
const LaneFunctions& four_wide_lanes() {
  static constexpr LaneFunctions kFunctions{attempt_four, accept_four, accelerations_four};
  return kFunctions;
}
const LaneFunctions& eight_wide_lanes() {
  static constexpr LaneFunctions kFunctions{attempt_eight, accept_eight, accelerations_eight};
  return kFunctions;
}

}  // namespace slewlab::sim
