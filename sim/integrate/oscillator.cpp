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

// 1/n, because the series divides by small integers only and a division costs five multiplications.
constexpr std::array<double, kSeriesShares> kReciprocal = [] {
  std::array<double, kSeriesShares> table{};
  for (std::size_t n = 1; n < table.size(); ++n) table[n] = 1.0 / static_cast<double>(n);
  return table;
}();

constexpr std::array<double, kSeriesShares> kNumber = [] {
  std::array<double, kSeriesShares> table{};
  for (std::size_t n = 1; n < table.size(); ++n) table[n] = static_cast<double>(n);
  return table;
}();
static_assert(kSeriesTerms % 2 == 0);  // they are taken by twos

bool has_series(double fastest, double h) { return fastest * h < kSeriesLimit; }

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

StepLength::StepLength(double h) : length(h) {
  for (std::size_t n = 1; n < share.size(); ++n) share[n] = h * kReciprocal[n];
}

double fastest_rate(double square, double damping_rate) { return std::fmax(std::sqrt(square), damping_rate); }

OscillatorResponse oscillator_response(double square, double damping_rate, double h) {
  double s0 = 0.0;  // S(h)
  double s1 = 0.0;  // S'(h)
  double integral[4];
  if (has_series(fastest_rate(square, damping_rate), h)) {
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

using FourBits = decltype(Four{} < Four{});
SLEWLAB_INLINE Four magnitude(const Four& a) { return (Four)((FourBits)a & 0x7fffffffffffffff); }

// by_series() in every lane of a block. What follows a lane's end is chosen away, not added: so no step of the recurrence waits for the
// question whether it has ended. Lanes that have no series are not read.
struct Series {
  Four square, rate, first, second;
  Four s0{}, s1{}, integral[4] = {}, previous{}, current;
  FourBits ended{};

  SLEWLAB_INLINE void begin(const double* squares, const double* rates, const double* fastest, double h) {
    Four fast;
    load(square, squares);
    load(rate, rates);
    load(fast, fastest);
    square = fast * h < kSeriesLimit ? square : Four{};
    rate = fast * h < kSeriesLimit ? rate : Four{};
    first = rate * h;
    second = square * h * h;
    current = Four{} + h;
  }
  SLEWLAB_INLINE void add(std::size_t n, const StepLength& step) {
    Four term = (Four)((FourBits)current & ~ended);
    s0 += term;
    s1 += term * kNumber[n];
    for (std::size_t j = 0; j < 4; ++j) {
      term *= step.share[n + j + 1];
      integral[j] += term;
    }
    const Four next = -(first * kNumber[n] * current + second * previous) * kReciprocal[n + 1] * kReciprocal[n];
    previous = current;
    current = next;
    ended |= magnitude(next) + magnitude(previous) < 1e-18 * step.length;
  }
  SLEWLAB_INLINE bool has_ended() const { return (ended[0] & ended[1] & ended[2] & ended[3]) != 0; }
  SLEWLAB_INLINE void end(double h, FourResponses& to) {
    s1 /= Four{} + h;
    store(to.qq, s1 + rate * s0);
    store(to.qv, s0);
    store(to.vq, -square * s0);
    store(to.vv, s1);
    for (int j = 0; j < 4; ++j) {
      store(to.q[j], integral[j]);
      store(to.v[j], j == 0 ? s0 : integral[j - 1]);
    }
  }
};

// hermite_response() in every lane. q and v share what they share, and what differs by a power of two is divided once.
SLEWLAB_INLINE void four_hermites(double h, FourResponses& to) {
  Four s[5], by_1[5], by_2[5], by_3[5];  // S and its integrals; twice, six times, twelve times over h, h^2, h^3
  load(s[0], to.v[0]);
  for (int j = 0; j < 4; ++j) load(s[j + 1], to.q[j]);
  for (int j = 2; j < 5; ++j) {
    by_1[j] = 2.0 * s[j] / h;
    by_2[j] = 6.0 * s[j] / (h * h);
    by_3[j] = 12.0 * s[j] / (h * h * h);
  }
  const auto fill = [&](int from, double (*value)[4], double (*rate)[4]) {
    store(value[0], s[from] - by_2[from + 2] + by_3[from + 3]);
    store(value[1], by_2[from + 2] - by_3[from + 3]);
    store(rate[0], s[from + 1] - 2.0 * by_1[from + 2] + by_2[from + 3]);
    store(rate[1], by_2[from + 3] - by_1[from + 2]);
  };
  fill(1, to.q_value, to.q_rate);
  fill(0, to.v_value, to.v_rate);
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

SLEWLAB_INLINE void respond(const double* square, const double* damping_rate, const double* fastest, const StepLength& step, FourResponses& responses) {
  const double h = step.length;
  Series series;
  series.begin(square, damping_rate, fastest, h);
  for (std::size_t n = 1; n <= kSeriesTerms && !series.has_ended(); n += 2) {
    series.add(n, step);
    series.add(n + 1, step);
  }
  series.end(h, responses);
  for (int lane = 0; lane < 4; ++lane) {
    if (!has_series(fastest[lane], h)) put(oscillator_response(square[lane], damping_rate[lane], h), lane, responses);
  }
  four_hermites(h, responses);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void four_responses_wide(const double* square, const double* damping_rate, const double* fastest,
                                                 const StepLength& step, FourResponses& responses) {
  respond(square, damping_rate, fastest, step, responses);
}
#endif

}  // namespace

void four_responses_portable(const double* square, const double* damping_rate, const double* fastest, const StepLength& step, FourResponses& responses) {
  respond(square, damping_rate, fastest, step, responses);
}

void four_responses(const double* square, const double* damping_rate, const double* fastest, const StepLength& step, FourResponses& responses) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return four_responses_wide(square, damping_rate, fastest, step, responses);
#endif
  respond(square, damping_rate, fastest, step, responses);
}

}  // namespace slewlab::sim
