#include "sim/integrate/oscillator.h"

#include <array>
#include <cmath>
#include <cstddef>

// Vectors are passed between functions that are all put in line.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace slewlab::sim {

namespace {

// Powers of h below which the closed forms lose digits to cancellation and the series is exact instead.
constexpr double kSeriesLimit = 1.0;
constexpr int kSeriesTerms = 24;  // 1/24! is below the rounding of a double

// 1/n, because the series divides by small integers only and a division costs five multiplications.
constexpr std::array<double, kSeriesTerms + 6> kReciprocal = [] {
  std::array<double, kSeriesTerms + 6> table{};
  for (std::size_t n = 1; n < table.size(); ++n) table[n] = 1.0 / static_cast<double>(n);
  return table;
}();

bool has_series(double square, double damping_rate, double h) {
  return std::fmax(std::sqrt(square), damping_rate) * h < kSeriesLimit;
}

void by_series(double square, double damping_rate, double h, double& s0, double& s1, double* integral) {
  s0 = 0.0;
  s1 = 0.0;
  for (int j = 0; j < 4; ++j) integral[j] = 0.0;
  double previous = 0.0;  // coefficient n times h^n of S
  double current = h;
  const double first = damping_rate * h;
  const double second = square * h * h;
  for (int n = 1; n <= kSeriesTerms; ++n) {
    const auto at = static_cast<std::size_t>(n);
    s0 += current;
    s1 += current * n;
    double term = current;
    for (std::size_t j = 0; j < 4; ++j) {
      term *= h * kReciprocal[at + j + 1];
      integral[j] += term;
    }
    const double next = -(first * n * current + second * previous) * kReciprocal[at + 1] * kReciprocal[at];
    previous = current;
    current = next;
    if (std::fabs(current) + std::fabs(previous) < 1e-18 * h) break;
  }
  s1 /= h;
}

// phi_n(x), n = 1 ... 4, x >= 0: exp(-r s) integrated n times from 0 to h is h^n phi_n(r h). By a series for small x, and
// by phi_n = (1 / (n-1)! - phi_(n-1)) / x, phi_0 = exp(-x), beyond, where that keeps its digits.
void exponential_integrals(double x, double* phi) {
  constexpr double kSmall = 2.0;
  constexpr double kReciprocalFactorial[] = {1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0};
  if (x >= kSmall) {
    double before = std::exp(-x);
    for (std::size_t n = 1; n <= 4; ++n) before = phi[n - 1] = (kReciprocalFactorial[n - 1] - before) / x;
    return;
  }
  for (std::size_t n = 1; n <= 4; ++n) {
    double term = kReciprocalFactorial[n], sum = term;
    for (std::size_t k = 1; k <= kSeriesTerms; ++k) {
      term *= -x * kReciprocal[n + k];
      sum += term;
    }
    phi[n - 1] = sum;
  }
}

// S integrated once ... four times where the slow one of two decays has hardly begun, down to no spring at all (slow = 0):
// S = (exp(-slow s) - exp(-fast s)) / (fast - slow), term by term.
void integrals_of_two_decays(double slow, double fast, double h, double* integral) {
  double of_slow[4], of_fast[4];
  exponential_integrals(slow * h, of_slow);
  exponential_integrals(fast * h, of_fast);
  double power = h / (fast - slow);
  for (std::size_t j = 0; j < 4; ++j) {
    integral[j] = power * (of_slow[j] - of_fast[j]);
    power *= h;
  }
}

}  // namespace

OscillatorResponse oscillator_response(double square, double damping_rate, double h) {
  double s0 = 0.0;  // S(h)
  double s1 = 0.0;  // S'(h)
  double integral[4];
  if (has_series(square, damping_rate, h)) {
    by_series(square, damping_rate, h, s0, s1, integral);
  } else {
    const double a = 0.5 * damping_rate;
    const double below = square - a * a;  // > 0: underdamped
    bool has_begun = true;  // the slower of the decays: the recursion over the integrals divides by it
    if (std::fabs(below) * h * h < 1e-2) {
      // Near critical damping sine and hyperbolic sine share this series; it avoids their 0/0.
      const double x = below * h * h;
      const double decay = std::exp(-a * h);
      const double sine = h * (1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0))));
      const double cosine = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)));
      s0 = decay * sine;
      s1 = decay * (cosine - a * sine);
    } else if (below > 0.0) {
      const double frequency = std::sqrt(below);
      const double decay = std::exp(-a * h);
      const double sine = std::sin(frequency * h);
      s0 = decay * sine / frequency;
      s1 = decay * (std::cos(frequency * h) - a / frequency * sine);
    } else {
      const double b = std::sqrt(-below);
      const double slow = square / (a + b);
      const double fast = a + b;
      const double slow_decay = std::exp(-slow * h);
      const double fast_decay = std::exp(-fast * h);
      s0 = (slow_decay - fast_decay) / (2.0 * b);
      s1 = (fast * fast_decay - slow * slow_decay) / (2.0 * b);
      has_begun = slow * h >= 1.0;
      if (!has_begun) integrals_of_two_decays(slow, fast, h, integral);
    }
    if (has_begun) {
      // S'' + d S' + w2 S = 0, integrated once, twice, ...
      integral[0] = (1.0 - s1 - damping_rate * s0) / square;
      integral[1] = (h - s0 - damping_rate * integral[0]) / square;
      integral[2] = (0.5 * h * h - integral[0] - damping_rate * integral[1]) / square;
      integral[3] = (h * h * h / 6.0 - integral[1] - damping_rate * integral[2]) / square;
    }
  }
  return {.qq = s1 + damping_rate * s0,
          .qv = s0,
          .vq = -square * s0,
          .vv = s1,
          .q = {integral[0], integral[1], integral[2], integral[3]},
          .v = {s0, integral[0], integral[1], integral[2]}};
}

HermiteResponse hermite_response(const OscillatorResponse& response, double h) {
  HermiteResponse result;
  const auto fill = [h](const double* r, double* value, double* rate) {
    value[0] = r[0] - 6.0 * r[2] / (h * h) + 12.0 * r[3] / (h * h * h);
    value[1] = 6.0 * r[2] / (h * h) - 12.0 * r[3] / (h * h * h);
    rate[0] = r[1] - 4.0 * r[2] / h + 6.0 * r[3] / (h * h);
    rate[1] = -2.0 * r[2] / h + 6.0 * r[3] / (h * h);
  };
  fill(response.q, result.q_value, result.q_rate);
  fill(response.v, result.v_value, result.v_rate);
  return result;
}

namespace {

using Four [[gnu::vector_size(32)]] = double;

#define SLEWLAB_INLINE [[gnu::always_inline]] inline

// From and to where no vector need be aligned.
SLEWLAB_INLINE void load(Four& vector, const double* from) { __builtin_memcpy(&vector, from, sizeof vector); }
SLEWLAB_INLINE void store(double* to, const Four& vector) { __builtin_memcpy(to, &vector, sizeof vector); }

// by_series() in every lane. A lane whose series has ended goes on with terms of zero.
SLEWLAB_INLINE void four_by_series(const double* square, const double* damping_rate, double h, FourResponses& to) {
  Four squares{}, rates{};
  for (int lane = 0; lane < 4; ++lane) {
    if (!has_series(square[lane], damping_rate[lane], h)) continue;  // that lane is not read
    squares[lane] = square[lane];
    rates[lane] = damping_rate[lane];
  }
  const Four none{};
  Four s0{}, s1{}, integral[4] = {}, previous{}, current = none + h;
  const Four first = rates * h, second = squares * h * h;
  auto ended = none != 0.0;
  for (int n = 1; n <= kSeriesTerms; ++n) {
    const auto at = static_cast<std::size_t>(n);
    const double number = n;
    s0 += current;
    s1 += current * number;
    Four term = current;
    for (std::size_t j = 0; j < 4; ++j) {
      term *= h * kReciprocal[at + j + 1];
      integral[j] += term;
    }
    const Four next = -(first * number * current + second * previous) * kReciprocal[at + 1] * kReciprocal[at];
    previous = current;
    const Four size = (next < 0.0 ? -next : next) + (previous < 0.0 ? -previous : previous);
    ended |= size < 1e-18 * h;
    current = ended ? none : next;
    if ((ended[0] & ended[1] & ended[2] & ended[3]) != 0) break;
  }
  s1 /= none + h;
  store(to.qq, s1 + rates * s0);
  store(to.qv, s0);
  store(to.vq, -squares * s0);
  store(to.vv, s1);
  for (int j = 0; j < 4; ++j) {
    store(to.q[j], integral[j]);
    store(to.v[j], j == 0 ? s0 : integral[j - 1]);
  }
}

SLEWLAB_INLINE void four_hermites(double (*r)[4], double h, double (*value)[4], double (*rate)[4]) {
  Four r0, r1, r2, r3;
  load(r0, r[0]);
  load(r1, r[1]);
  load(r2, r[2]);
  load(r3, r[3]);
  store(value[0], r0 - 6.0 * r2 / (h * h) + 12.0 * r3 / (h * h * h));
  store(value[1], 6.0 * r2 / (h * h) - 12.0 * r3 / (h * h * h));
  store(rate[0], r1 - 4.0 * r2 / h + 6.0 * r3 / (h * h));
  store(rate[1], -2.0 * r2 / h + 6.0 * r3 / (h * h));
}

void put(const OscillatorResponse& r, int lane, FourResponses& to) {
  to.qq[lane] = r.qq;
  to.qv[lane] = r.qv;
  to.vq[lane] = r.vq;
  to.vv[lane] = r.vv;
  for (int j = 0; j < 4; ++j) {
    to.q[j][lane] = r.q[j];
    to.v[j][lane] = r.v[j];
  }
}

SLEWLAB_INLINE void respond(const double* square, const double* damping_rate, double h, FourResponses& responses) {
  four_by_series(square, damping_rate, h, responses);
  for (int lane = 0; lane < 4; ++lane) {
    if (!has_series(square[lane], damping_rate[lane], h)) put(oscillator_response(square[lane], damping_rate[lane], h), lane, responses);
  }
  four_hermites(responses.q, h, responses.q_value, responses.q_rate);
  four_hermites(responses.v, h, responses.v_value, responses.v_rate);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void four_responses_wide(const double* square, const double* damping_rate, double h, FourResponses& responses) {
  respond(square, damping_rate, h, responses);
}
#endif

}  // namespace

void four_responses_portable(const double* square, const double* damping_rate, double h, FourResponses& responses) {
  respond(square, damping_rate, h, responses);
}

void four_responses(const double* square, const double* damping_rate, double h, FourResponses& responses) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return four_responses_wide(square, damping_rate, h, responses);
#endif
  respond(square, damping_rate, h, responses);
}

}  // namespace slewlab::sim
