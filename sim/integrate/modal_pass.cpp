#include "sim/integrate/modal_pass.h"

namespace slewlab::sim {

namespace {

using Quad [[gnu::vector_size(32), gnu::may_alias, gnu::aligned(16)]] = double;
using Pair [[gnu::vector_size(16), gnu::may_alias]] = double;
static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16, "std::vector<double> must start where a Pair may");
static_assert(kLanes == sizeof(Quad) / sizeof(double));

#define SLEWLAB_INLINE [[gnu::always_inline]] inline

SLEWLAB_INLINE const Quad& lanes(const double* block, int term) { return *reinterpret_cast<const Quad*>(block + term * kLanes); }

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
    const Quad q_start = lanes(q0, b), v_start = lanes(v0, b);
    Quad q = lanes(block, qq) * q_start + lanes(block, qv) * v_start + lanes(block, q_torque) * on.torque + lanes(block, q_rate) * on.rate +
             lanes(block, q_tip) * on.tip + lanes(block, q_tip_rate) * on.tip_rate;
    Quad v = lanes(block, vq) * q_start + lanes(block, vv) * v_start + lanes(block, v_torque) * on.torque + lanes(block, v_rate) * on.rate +
             lanes(block, v_tip) * on.tip + lanes(block, v_tip_rate) * on.tip_rate;
    if constexpr (kHeld) {
      const double* const of_held = held + b * held_term::count * kLanes;
      q += lanes(of_held, held_term::q_house) * on.house + lanes(of_held, held_term::q_uniform) * on.uniform;
      v += lanes(of_held, held_term::v_house) * on.house + lanes(of_held, held_term::v_uniform) * on.uniform;
    }
    *reinterpret_cast<Quad*>(q_end + b * kLanes) = q;
    *reinterpret_cast<Quad*>(v_end + b * kLanes) = v;
    const double* const shape = shapes + b * shape_term::count * kLanes;
    add(angle, lanes(shape, shape_term::house), q);
    add(speed, lanes(shape, shape_term::house), v);
    add(acceleration_q, lanes(shape, shape_term::house_acceleration_q), q);
    add(acceleration_v, lanes(shape, shape_term::house_acceleration_v), v);
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
    Quad q = lanes(q_end, b) + lanes(block, end_term::q_torque) * on.torque + lanes(block, end_term::q_rate) * on.rate;
    Quad v = lanes(v_end, b) + lanes(block, end_term::v_torque) * on.torque + lanes(block, end_term::v_rate) * on.rate;
    if constexpr (kHeld) {
      const double* const of_held = held + b * held_term::count * kLanes;
      q += lanes(of_held, held_term::q_house) * on.house;
      v += lanes(of_held, held_term::v_house) * on.house;
    }
    *reinterpret_cast<Quad*>(q_end + b * kLanes) = q;
    *reinterpret_cast<Quad*>(v_end + b * kLanes) = v;
    const double* const shape = shapes + b * shape_term::count * kLanes;
    add(tip, lanes(shape, shape_term::tip), q);
    add(tip_velocity, lanes(shape, shape_term::tip), v);
    add(acceleration_q, lanes(shape, shape_term::house_acceleration_q), q);
    add(acceleration_v, lanes(shape, shape_term::house_acceleration_v), v);
  }
  return {total(tip), total(tip_velocity), total(acceleration_q), total(acceleration_v)};
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

#ifdef __x86_64__
[[gnu::target("avx2")]] FreeSums free_wide(int blocks, const double* terms, const double* held, const double* shapes, const FreeLoads& loads,
                                           const double* q0, const double* v0, double* q, double* v) {
  return free_of(blocks, terms, held, shapes, loads, q0, v0, q, v);
}
[[gnu::target("avx2")]] EndSums end_wide(int blocks, const double* terms, const double* held, const double* shapes, const EndLoads& loads,
                                         double* q, double* v) {
  return end_of(blocks, terms, held, shapes, loads, q, v);
}
#endif

}  // namespace

const ModalPasses& portable_passes() {
  static constexpr ModalPasses kPasses{free_portable, end_portable};
  return kPasses;
}

const ModalPasses* wide_passes() {
#ifdef __x86_64__
  static constexpr ModalPasses kPasses{free_wide, end_wide};
  if (__builtin_cpu_supports("avx2")) return &kPasses;
#endif
  return nullptr;
}

const ModalPasses& modal_passes() {
  const ModalPasses* const wide = wide_passes();
  return wide != nullptr ? *wide : portable_passes();
}

}  // namespace slewlab::sim
