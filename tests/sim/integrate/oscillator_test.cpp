#include "sim/integrate/oscillator.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <unsupported/Eigen/MatrixFunctions>

namespace slewlab::sim {
namespace {

// Expected numbers: the matrix exponential of the oscillator with its polynomial force as further states
// (Van Loan), by Eigen's Pade approximation. h, w, zeta span series, under-, over- and critically damped.
class Oscillator : public testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(Oscillator, AgreesWithTheMatrixExponential) {
  const auto [h, frequency, ratio] = GetParam();
  const double square = frequency * frequency;
  const double damping = 2.0 * ratio * frequency;
  // States x, h v, h^2 f and the force's derivatives likewise: scaled so that the exponential keeps its digits.
  Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
  system(0, 1) = 1.0;
  system(1, 0) = -square * h * h;
  system(1, 1) = -damping * h;
  system(1, 2) = system(2, 3) = system(3, 4) = system(4, 5) = 1.0;
  const Eigen::Matrix<double, 6, 6> expected = system.exp();
  const OscillatorResponse r = oscillator_response(square, damping, h);
  EXPECT_NEAR(r.qq, expected(0, 0), 1e-11);
  EXPECT_NEAR(r.qv / h, expected(0, 1), 1e-11);
  EXPECT_NEAR(r.vq * h, expected(1, 0), 1e-11 * std::max(1.0, square * h * h));
  EXPECT_NEAR(r.vv, expected(1, 1), 1e-11);
  double scale = h;
  for (int j = 0; j < 4; ++j) {
    EXPECT_NEAR(r.v[j] / scale, expected(1, 2 + j), 1e-11) << "j " << j;
    scale *= h;
    EXPECT_NEAR(r.q[j] / scale, expected(0, 2 + j), 1e-11) << "j " << j;
  }
}

INSTANTIATE_TEST_SUITE_P(Ranges, Oscillator,
                         testing::Combine(testing::Values(1e-6, 1e-3, 2e-3, 0.02),
                                          testing::Values(0.0, 0.4, 33.0, 900.0, 1100.0, 5e3),
                                          testing::Values(0.0, 0.01, 0.999999999, 1.0, 2.5)));

// Expected numbers: the response over a short piece by its Taylor series, doubled until it spans h, in long double. A force
// f = s^j / j! that goes on for another piece is sum_i (piece^(j-i) / (j-i)!) s^i / i! there.
struct Doubled {
  long double qq, qv, vq, vv, q[4], v[4];
};

Doubled by_doubling(long double square, long double damping_rate, long double h) {
  int doublings = 0;
  long double piece = h;
  while (std::max(std::sqrt(square), damping_rate) * piece > 0.5L) {
    piece *= 0.5L;
    ++doublings;
  }
  constexpr int kTerms = 40;
  Doubled r{};
  long double coefficient[kTerms + 6] = {0.0L, 1.0L};  // of S: s^n
  long double power = 1.0L;
  for (int n = 2; n < kTerms; ++n) {
    coefficient[n] = -(damping_rate * (n - 1) * coefficient[n - 1] + square * coefficient[n - 2]) / (n * (n - 1));
  }
  for (int n = 1; n < kTerms; ++n) {
    r.vv += n * coefficient[n] * power;
    power *= piece;
    r.qv += coefficient[n] * power;
    long double term = coefficient[n] * power;
    for (int j = 0; j < 4; ++j) r.q[j] += term *= piece / (n + j + 1);
  }
  r.qq = r.vv + damping_rate * r.qv;
  r.vq = -square * r.qv;
  r.v[0] = r.qv;
  for (int j = 1; j < 4; ++j) r.v[j] = r.q[j - 1];
  for (; doublings > 0; --doublings, piece *= 2.0L) {
    Doubled twice{r.qq * r.qq + r.qv * r.vq, r.qq * r.qv + r.qv * r.vv, r.vq * r.qq + r.vv * r.vq,
                  r.vq * r.qv + r.vv * r.vv, {}, {}};
    for (int j = 0; j < 4; ++j) {
      twice.q[j] = r.qq * r.q[j] + r.qv * r.v[j];
      twice.v[j] = r.vq * r.q[j] + r.vv * r.v[j];
      long double share = 1.0L;
      for (int i = j; i >= 0; --i) {
        twice.q[j] += share * r.q[i];
        twice.v[j] += share * r.v[i];
        share *= piece / (j - i + 1);
      }
    }
    r = twice;
  }
  return r;
}

// All that the header allows, from no spring and no damper to ones that settle within a hundred-millionth of the step.
TEST(OscillatorResponse, HoldsOverAllOrdersOfMagnitude) {
  constexpr double kTolerance = 1e-9;  // [-] doubling 28 times leaves 1e-11
  constexpr double kDecayed = 1e-14;   // [-] of the largest value within the step: what has decayed below is gone
  for (const double h : {1e-6, 1e-3, 10.0}) {
    for (const double stiff : {0.0, 1e-12, 1e-6, 1e-3, 0.3, 0.9, 1.0, 3.0, 30.0, 1e3, 1e6}) {  // w h
      for (const double damped : {0.0, 1e-9, 1e-3, 0.6, 0.999, 1.0, 1.9, 2.0, 2.1, 6.0, 60.0, 1e3, 1e6, 1e8}) {  // d h
        const double square = stiff * stiff / (h * h), damping_rate = damped / h;
        const Doubled expected = by_doubling(square, damping_rate, h);
        const OscillatorResponse r = oscillator_response(square, damping_rate, h);
        // What rounding of w h leaves of a phase: relative to the envelope, not to a sine that happens to be small.
        const long double envelope = std::exp(-0.5L * static_cast<long double>(damped)) * (stiff > 0.5 * damped ? 1.0L : 0.0L);
        const auto expect = [&](const char* what, double value, long double wanted, long double scale, long double largest) {
          EXPECT_TRUE(std::isfinite(value)) << what << ": w h = " << stiff << ", d h = " << damped << ", h = " << h;
          EXPECT_LE(std::fabs(value - wanted),
                    kTolerance * (std::fabs(wanted) + envelope * scale) + kDecayed * largest)
              << what << ": " << value << " for " << wanted << ", w h = " << stiff << ", d h = " << damped << ", h = " << h;
        };
        const long double period = stiff > 0.0 ? static_cast<long double>(h) / stiff : h;
        const long double largest = h / std::max({1.0, stiff, damped});  // of S within the step
        expect("qq", r.qq, expected.qq, 1.0L, 1.0L);
        expect("qv", r.qv, expected.qv, period, largest);
        expect("vq", r.vq, expected.vq, 1.0L / period, square * largest);
        expect("vv", r.vv, expected.vv, 1.0L, 1.0L);
        for (int j = 0; j < 4; ++j) {
          expect("q", r.q[j], expected.q[j], period * period, 0.0L);
          expect("v", r.v[j], expected.v[j], period, j == 0 ? largest : 0.0L);
        }
      }
    }
  }
}

// Without a spring: S = (1 - exp(-d h)) / d.
TEST(OscillatorResponse, WithoutASpringTheSpeedDecays) {
  const OscillatorResponse r = oscillator_response(0.0, 2000.0, 1e-3);
  EXPECT_DOUBLE_EQ(r.vv, std::exp(-2.0));
  EXPECT_DOUBLE_EQ(r.qv, -std::expm1(-2.0) / 2000.0);
  EXPECT_EQ(r.qq, 1.0);
  EXPECT_EQ(r.vq, 0.0);
  EXPECT_NEAR(r.q[0], (1e-3 - r.qv) / 2000.0, 1e-15 * 1e-6);
  EXPECT_NEAR(r.q[1], (0.5e-6 - r.q[0]) / 2000.0, 1e-15 * 1e-9);
}

// A cubic force has itself as its Hermite polynomial, so the response must equal the monomials' one.
TEST(HermiteResponse, IsExactForACubicForce) {
  const double h = 2e-3;
  const OscillatorResponse r = oscillator_response(700.0 * 700.0, 30.0, h);
  const HermiteResponse hermite = hermite_response(r, h);
  const double a = 2.0, b = -300.0, c = 4e5, d = 7e8;  // f = a + b s + c s^2/2 + d s^3/6
  const double start_value = a, start_rate = b;
  const double end_value = a + b * h + c * h * h / 2 + d * h * h * h / 6;
  const double end_rate = b + c * h + d * h * h / 2;
  const double q = a * r.q[0] + b * r.q[1] + c * r.q[2] + d * r.q[3];
  const double v = a * r.v[0] + b * r.v[1] + c * r.v[2] + d * r.v[3];
  EXPECT_NEAR(hermite.q_value[0] * start_value + hermite.q_rate[0] * start_rate +
                  hermite.q_value[1] * end_value + hermite.q_rate[1] * end_rate,
              q, 1e-12 * std::fabs(q));
  EXPECT_NEAR(hermite.v_value[0] * start_value + hermite.v_rate[0] * start_rate +
                  hermite.v_value[1] * end_value + hermite.v_rate[1] * end_rate,
              v, 1e-12 * std::fabs(v));
}

// Whatever stands beside it: in the series, beyond it, damped or not; portable or by wide vectors.
TEST(Oscillator, FourSideBySideHaveTheirBits) {
  const double frequencies[] = {0.0, 0.4, 33.0, 150.0, 700.0, 900.0, 1100.0, 5e3}, ratios[] = {0.0, 0.01, 1.0, 2.5};
  const auto same = [](double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); };
  for (const double h : {1e-9, 1e-6, 3e-4, 1e-3, 0.02}) {
    for (int drawn = 0; drawn < 512; ++drawn) {
      double square[4], damping[4], fastest[4];
      for (int lane = 0; lane < 4; ++lane) {
        const int which = (drawn * 7 + lane * (drawn / 8 + 3)) % 32;
        const double frequency = frequencies[which % 8];
        square[lane] = frequency * frequency;
        damping[lane] = 2.0 * ratios[which / 8] * frequency;
        fastest[lane] = fastest_rate(square[lane], damping[lane]);
      }
      FourResponses wide, portable;
      four_responses(square, damping, fastest, StepLength(h), wide);
      four_responses_portable(square, damping, fastest, StepLength(h), portable);
      for (int lane = 0; lane < 4; ++lane) {
        const OscillatorResponse one = oscillator_response(square[lane], damping[lane], h);
        const HermiteResponse hermite = hermite_response(one, h);
        for (const FourResponses* const four : {&wide, &portable}) {
          bool equal = same(one.qq, four->qq[lane]) && same(one.qv, four->qv[lane]) && same(one.vq, four->vq[lane]) &&
                       same(one.vv, four->vv[lane]);
          for (int j = 0; j < 4; ++j) equal = equal && same(one.q[j], four->q[j][lane]) && same(one.v[j], four->v[j][lane]);
          for (int end = 0; end < 2; ++end) {
            equal = equal && same(hermite.q_value[end], four->q_value[end][lane]) && same(hermite.q_rate[end], four->q_rate[end][lane]) &&
                    same(hermite.v_value[end], four->v_value[end][lane]) && same(hermite.v_rate[end], four->v_rate[end][lane]);
          }
          ASSERT_TRUE(equal) << "h " << h << " square " << square[lane] << " damping " << damping[lane];
        }
      }
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
