#include "sim/integrate/reference_newton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

// The equations are linear as long as no contact changes: J x = derive(y + x) - derive(y), whatever y. So x has to give back b.
void expect_solution(ReferenceEquations& r, double gamma) {
  const auto n = static_cast<std::size_t>(r.size);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  // The gears just touch, so that nothing but x makes a torque.
  std::vector<double> b(n), x(n), touching(n, 0.0), beside(n), at_touching(n), at_beside(n);
  for (int i = 0; i < r.group_count; ++i) touching[static_cast<std::size_t>(i)] = r.contact[i] * r.machine.gear[i].half_play;
  for (double& value : b) value = between(random);
  ReferenceNewton newton;
  solve(r, newton, gamma, b.data(), x.data());
  for (std::size_t k = 0; k < n; ++k) beside[k] = touching[k] + x[k];
  derive(r, 0.0, touching.data(), at_touching.data());
  derive(r, 0.0, beside.data(), at_beside.data());
  for (std::size_t k = 0; k < n; ++k) {
    const double product = gamma * (at_beside[k] - at_touching[k]);
    EXPECT_NEAR(x[k] - product, b[k], 1e-8 * (std::fabs(x[k]) + 1.0)) << "state " << k << ", gamma " << gamma;
  }
}

TEST(ReferenceNewton, SolvesTheSystemOfEverySetOfContacts) {
  for (const auto& contacts : {std::array{0, 0}, std::array{1, 0}, std::array{-1, 1}, std::array{1, 1}}) {
    for (const double gamma : {1e-6, 1e-3, 0.1}) {
      ReferenceEquations r = make_reference_equations(reference_machine(thesis_crane()), {});
      r.contact[0] = contacts[0];
      r.contact[1] = contacts[1];
      expect_solution(r, gamma);
    }
  }
}

TEST(ReferenceNewton, SolvesThatOfACraneWithoutLoad) {
  CraneParameters crane = thesis_crane(0);
  crane.load.mass = 0.0;
  ReferenceEquations r = make_reference_equations(reference_machine(crane), {});
  expect_solution(r, 1e-3);
  r.contact[0] = 1;
  expect_solution(r, 1e-3);
}

TEST(ReferenceNewton, AnotherGammaIsWorkedOutAnew) {
  ReferenceEquations r = make_reference_equations(reference_machine(thesis_crane()), {});
  r.contact[0] = 1;
  const auto n = static_cast<std::size_t>(r.size);
  const std::vector<double> b(n, 1.0);
  std::vector<double> again(n), fresh(n);
  ReferenceNewton newton, other;
  solve(r, newton, 1e-2, b.data(), again.data());
  solve(r, newton, 1e-3, b.data(), again.data());
  solve(r, other, 1e-3, b.data(), fresh.data());
  EXPECT_EQ(again, fresh);
}

}  // namespace
}  // namespace slewlab::sim
