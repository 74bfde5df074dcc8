#include "sim/integrate/friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace slewlab::sim {
namespace {

// The law, of a solution: held at rest, or sliding against the full friction.
void expect_law(const FrictionProblem& problem, const double* friction, const std::string& what) {
  double scale = 0.0;
  for (int i = 0; i < problem.count; ++i) scale = std::max(scale, std::fabs(problem.free_speed[i]));
  for (int i = 0; i < problem.count; ++i) {
    ASSERT_GE(friction[i], problem.lowest[i]) << what << ", body " << i;
    ASSERT_LE(friction[i], problem.highest[i]) << what << ", body " << i;
    double speed = problem.free_speed[i];
    for (int j = 0; j < problem.count; ++j) speed += problem.mobility[i][j] * friction[j];
    const double rounding = 1e-9 * scale;
    if (friction[i] > problem.lowest[i]) {
      EXPECT_LE(speed, rounding) << what << ", body " << i;
    }
    if (friction[i] < problem.highest[i]) {
      EXPECT_GE(speed, -rounding) << what << ", body " << i;
    }
  }
}

TEST(Friction, OneBody) {
  FrictionProblem problem;
  problem.count = 1;
  problem.mobility[0][0] = 0.5;
  problem.lowest[0] = -3.0;
  problem.highest[0] = 2.0;
  for (const auto& [speed, expected] : {std::pair{1.0, -2.0}, {-0.8, 1.6}, {4.0, -3.0}, {-4.0, 2.0}, {0.0, 0.0}}) {
    problem.free_speed[0] = speed;
    double friction = 0.0;
    EXPECT_EQ(solve_frictions(problem, &friction), FrictionEnd::solved);
    EXPECT_DOUBLE_EQ(friction, expected) << speed;
  }
}

// Bodies on one another through springs and dampers of all stiffnesses: mobility = inverse(inertias + couplings), from
// not coupled at all to as good as one body. Frictions and inertias scatter over six orders of magnitude.
TEST(Friction, AnyCoupledBodiesFindTheirFrictions) {
  std::mt19937_64 random(1);
  const auto between = [&](double lowest, double highest) {
    return std::uniform_real_distribution<double>(lowest, highest)(random);
  };
  const auto scattered = [&] { return std::pow(10.0, between(-3.0, 3.0)); };
  for (int k = 0; k < 20000; ++k) {
    FrictionProblem problem;
    const int n = problem.count = 1 + k % kMaximumFrictions;
    // By Gauss-Jordan.
    double matrix[kMaximumFrictions][2 * kMaximumFrictions] = {};
    const double coupling = std::pow(10.0, between(-6.0, 6.0));
    for (int i = 0; i < n; ++i) {
      matrix[i][i] = scattered();
      matrix[i][n + i] = 1.0;
    }
    for (int i = 0; i + 1 < n; ++i) {  // each group on the last, the house
      matrix[i][i] += coupling;
      matrix[n - 1][n - 1] += coupling;
      matrix[i][n - 1] = matrix[n - 1][i] = -coupling;
    }
    for (int p = 0; p < n; ++p) {
      for (int c = 2 * n - 1; c >= p; --c) matrix[p][c] /= matrix[p][p];
      for (int r = 0; r < n; ++r) {
        if (r == p) continue;
        for (int c = 2 * n - 1; c >= p; --c) matrix[r][c] -= matrix[r][p] * matrix[p][c];
      }
    }
    double friction[kMaximumFrictions];
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) problem.mobility[i][j] = matrix[i][n + j];
      problem.free_speed[i] = between(-1.0, 1.0);
      const bool none = between(0.0, 1.0) < 0.1;
      problem.lowest[i] = none ? 0.0 : -scattered();
      problem.highest[i] = none ? 0.0 : scattered();
      friction[i] = between(problem.lowest[i], problem.highest[i]);
    }
    ASSERT_EQ(solve_frictions(problem, friction), FrictionEnd::solved) << "problem " << k;
    expect_law(problem, friction, "problem " + std::to_string(k));
  }
}

TEST(Friction, ASystemWithoutASolutionIsToldApart) {
  FrictionProblem problem;
  problem.count = 1;
  problem.free_speed[0] = 1.0;
  problem.lowest[0] = -1.0;
  problem.highest[0] = 1.0;
  double friction = 0.0;
  EXPECT_EQ(solve_frictions(problem, &friction), FrictionEnd::singular);
  EXPECT_GE(friction, -1.0);
  EXPECT_LE(friction, 1.0);
}

}  // namespace
}  // namespace slewlab::sim
