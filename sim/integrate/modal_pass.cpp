#include "sim/integrate/modal_pass.h"

namespace slewlab::sim {

namespace {

using Quad [[gnu::vector_size(32)]] = double;
using Pair [[gnu::vector_size(16)]] = double;
static_assert(kLanes == sizeof(Quad) / sizeof(double));

#define SLEWLAB_INLINE [[gnu::always_inline]] inline

// The lanes of a term, from where no vector need be aligned. (As a value of a function they would be subject to the processor's calling
// convention.)
struct Lanes {
  Quad value;
  SLEWLAB_INLINE Lanes(const double* block, int term) { __builtin_memcpy(&value, block + term * kLanes, sizeof(Quad)); }
};

// Pair by pair: the order of additions is this one, however wide the products were.
SLEWLAB_INLINE void add(Pair& sum, const Quad& a, const Quad& b) {
  const Quad product = a * b;
  sum += __builtin_shufflevector(product, product, 0, 1);
  sum += __builtin_shufflevector(product, product, 2, 3);
}

SLEWLAB_INLINE double total(const Pair& sum) { return sum[0] + sum[1]; }

template <bool kHeld>
SLEWLAB_INLINE FreeSums free_pass(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads,
                                  const double* q0, const double* v0, double* q_end, double* v_end) {
  using namespace free_term;
  const FreeLoads on = loads;
  Pair angle{}, speed{}, acceleration_q{}, acceleration_v{};
  for (int b = 0; b < blocks; ++b) {
    const double* const block = terms + b * free_term::count * kLanes;
    const Quad q_start = Lanes(q0, b).value, v_start = Lanes(v0, b).value;
    Quad q = Lanes(block, qq).value * q_start + Lanes(block, qv).value * v_start + Lanes(block, q_torque).value * on.torque + Lanes(block, q_rate).value * on.rate +
             Lanes(block, q_tip).value * on.tip + Lanes(block, q_tip_rate).value * on.tip_rate;
    Quad v = Lanes(block, vq).value * q_start + Lanes(block, vv).value * v_start + Lanes(block, v_torque).value * on.torque + Lanes(block, v_rate).value * on.rate +
             Lanes(block, v_tip).value * on.tip + Lanes(block, v_tip_rate).value * on.tip_rate;
    if constexpr (kHeld) {
      const double* const of_held = held + b * held_term::count * kLanes;
      q += Lanes(of_held, held_term::q_house).value * on.house + Lanes(of_held, held_term::q_uniform).value * on.uniform;
      v += Lanes(of_held, held_term::v_house).value * on.house + Lanes(of_held, held_term::v_uniform).value * on.uniform;
    }
    __builtin_memcpy(q_end + b * kLanes, &q, sizeof(Quad));
    __builtin_memcpy(v_end + b * kLanes, &v, sizeof(Quad));
    const double* const shape = shapes + b * shape_term::count * kLanes;
    add(angle, Lanes(shape, shape_term::house).value, q);
    add(speed, Lanes(shape, shape_term::house).value, v);
    add(acceleration_q, Lanes(shape, shape_term::house_acceleration_q).value, q);
    add(acceleration_v, Lanes(shape, shape_term::house_acceleration_v).value, v);
  }
  return {total(angle), total(speed), total(acceleration_q), total(acceleration_v)};
}

template <bool kHeld>
SLEWLAB_INLINE EndSums end_pass(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads,
                                double* q_end, double* v_end) {
  const EndLoads on = loads;
  Pair tip{}, tip_velocity{}, acceleration_q{}, acceleration_v{};
  for (int b = 0; b < blocks; ++b) {
    const double* const block = terms + b * end_term::count * kLanes;
    Quad q = Lanes(q_end, b).value + Lanes(block, end_term::q_torque).value * on.torque + Lanes(block, end_term::q_rate).value * on.rate;
    Quad v = Lanes(v_end, b).value + Lanes(block, end_term::v_torque).value * on.torque + Lanes(block, end_term::v_rate).value * on.rate;
    if constexpr (kHeld) {
      const double* const of_held = held + b * held_term::count * kLanes;
      q += Lanes(of_held, held_term::q_house).value * on.house;
      v += Lanes(of_held, held_term::v_house).value * on.house;
    }
    __builtin_memcpy(q_end + b * kLanes, &q, sizeof(Quad));
    __builtin_memcpy(v_end + b * kLanes, &v, sizeof(Quad));
    const double* const shape = shapes + b * shape_term::count * kLanes;
    add(tip, Lanes(shape, shape_term::tip).value, q);
    add(tip_velocity, Lanes(shape, shape_term::tip).value, v);
    add(acceleration_q, Lanes(shape, shape_term::house_acceleration_q).value, q);
    add(acceleration_v, Lanes(shape, shape_term::house_acceleration_v).value, v);
  }
  return {total(tip), total(tip_velocity), total(acceleration_q), total(acceleration_v)};
}

SLEWLAB_INLINE Accelerations sense_pass(int blocks, const double* terms, const double* places, const SenseLoads& loads, const double* q,
                                        const double* v) {
  using namespace sense_term;
  const SenseLoads on = loads;
  static_assert(place_term::count == 6);
  Quad first{};  // house, tip, boom, pivot
  Pair last{};   // middle, tip_sensor
  for (int b = 0; b < blocks; ++b) {
    const double* const block = terms + b * count * kLanes;
    const Quad acceleration = -Lanes(block, square).value * Lanes(q, b).value - Lanes(block, damping_rate).value * Lanes(v, b).value +
                              Lanes(block, house).value * on.house + Lanes(block, tip).value * on.tip + Lanes(block, uniform).value * on.uniform;
    double of_mode[kLanes];
    __builtin_memcpy(of_mode, &acceleration, sizeof(Quad));
    for (const double mode : of_mode) {
      Quad at_first;
      Pair at_last;
      __builtin_memcpy(&at_first, places, sizeof(Quad));
      __builtin_memcpy(&at_last, places + kLanes, sizeof(Pair));
      first += at_first * mode;
      last += at_last * mode;
      places += place_term::count;
    }
  }
  return {first[0], first[1], first[2], first[3], last[0], last[1]};
}

SLEWLAB_INLINE FreeSums free_of(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads,
                                const double* q0, const double* v0, double* q, double* v) {
  return loads.house != 0.0 || loads.uniform != 0.0 ? free_pass<true>(blocks, terms, held, shapes, loads, q0, v0, q, v)
                                                    : free_pass<false>(blocks, terms, held, shapes, loads, q0, v0, q, v);
}

SLEWLAB_INLINE EndSums end_of(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads, double* q,
                              double* v) {
  return loads.house != 0.0 ? end_pass<true>(blocks, terms, held, shapes, loads, q, v)
                            : end_pass<false>(blocks, terms, held, shapes, loads, q, v);
}

FreeSums free_portable(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads, const double* q0,
                       const double* v0, double* q, double* v) {
  return free_of(blocks, terms, held, shapes, loads, q0, v0, q, v);
}
EndSums end_portable(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads, double* q, double* v) {
  return end_of(blocks, terms, held, shapes, loads, q, v);
}
Accelerations sense_portable(int blocks, const double* terms, const double* places, const SenseLoads& loads, const double* q, const double* v) {
  return sense_pass(blocks, terms, places, loads, q, v);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] FreeSums free_wide(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads,
                                           const double* q0, const double* v0, double* q, double* v) {
  return free_of(blocks, terms, held, shapes, loads, q0, v0, q, v);
}
[[gnu::target("avx2")]] EndSums end_wide(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads,
                                         double* q, double* v) {
  return end_of(blocks, terms, held, shapes, loads, q, v);
}
[[gnu::target("avx2")]] Accelerations sense_wide(int blocks, const double* terms, const double* places, const SenseLoads& loads,
                                                 const double* q, const double* v) {
  return sense_pass(blocks, terms, places, loads, q, v);
}
#endif

}  // namespace

const ModalPasses& portable_passes() {
  static constexpr ModalPasses kPasses{free_portable, end_portable, sense_portable};
  return kPasses;
}

const ModalPasses* wide_passes() {
#ifdef __x86_64__
  static constexpr ModalPasses kPasses{free_wide, end_wide, sense_wide};
  if (__builtin_cpu_supports("avx2")) return &kPasses;
#endif
  return nullptr;
}

const ModalPasses& modal_passes() {
  const ModalPasses* const wide = wide_passes();
  return wide != nullptr ? *wide : portable_passes();
}

double mode_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum[2] = {};
  for (std::size_t k = 0; k + 1 < a.size(); k += 2) {
    sum[0] += a[k] * b[k];
    sum[1] += a[k + 1] * b[k + 1];
  }
  return sum[0] + sum[1];
}

}  // namespace slewlab::sim
