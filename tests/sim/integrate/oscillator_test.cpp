#include "sim/integrate/oscillator.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
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

}  // namespace
}  // namespace slewlab::sim
