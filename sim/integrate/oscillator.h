// One damped oscillator advanced exactly over a time h, for forces that are polynomials of time.
#pragma once

#include <array>

namespace slewlab::sim {

// x'' + d x' + w2 x = f(s), 0 <= s <= h. With S(s) the response to a unit start velocity:
// x(h) = qq x0 + qv v0 + sum_j f_j q[j], v(h) = vq x0 + vv v0 + sum_j f_j v[j] for f = sum_j f_j s^j / j!.
// q[j] is S integrated j+1 times, v[0] = S and v[j] = q[j-1].
struct OscillatorResponse {
  double qq, qv, vq, vv;
  double q[4];
  double v[4];
};

// `square` w^2 [1/s^2] >= 0, `damping_rate` d [1/s] >= 0, any of them 0, under- or overdamped; `h` [s] > 0.
OscillatorResponse oscillator_response(double square, double damping_rate, double h);

// The same for a force that is the cubic Hermite polynomial through value and rate at both ends:
// q_value[0] belongs to the value at the start, q_rate[1] to the rate at the end, and so on.
struct HermiteResponse {
  double q_value[2], q_rate[2];
  double v_value[2], v_rate[2];
};
HermiteResponse hermite_response(const OscillatorResponse& response, double h);

// [1/s] the faster of swinging and decaying.
double fastest_rate(double square, double damping_rate);

// Both of four oscillators, side by side; each to the bit as the functions above give it alone, whatever the processor's vectors hold.
struct FourResponses {
  double qq[4], qv[4], vq[4], vv[4];
  double q[4][4];  // q[j][oscillator]
  double v[4][4];
  double q_value[2][4], q_rate[2][4], v_value[2][4], v_rate[2][4];
};
// What depends on the length h [s] alone: worked out once for many oscillators.
inline constexpr int kSeriesTerms = 24;  // 1/24! is below the rounding of a double
inline constexpr int kSeriesShares = kSeriesTerms + 6;
struct StepLength {
  explicit StepLength(double h);
  double length;
  std::array<double, kSeriesShares> share{};  // h / n
};

// `fastest`: their fastest_rate().
void four_responses(const double* square, const double* damping_rate, const double* fastest, const StepLength& step, FourResponses& responses);
// The same without the processor's wider vectors, for the test that compares the two.
void four_responses_portable(const double* square, const double* damping_rate, const double* fastest, const StepLength& step,
                             FourResponses& responses);

}  // namespace slewlab::sim
