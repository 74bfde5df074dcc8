#include "diagnosis/least_squares.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace slewlab::diagnosis {
namespace {

constexpr std::array<double, 4> kDampings{0.0, 0.1, 1.0, 10.0};

// The sum of squares of residuals with a Jacobian, within bounds.
struct Residuals {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residual;
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> jacobian;
  double lower = -1e300, upper = 1e300;
};

struct Result {
  Eigen::VectorXd x;
  Descent descent;
};

Result solve(const Residuals& problem, Eigen::VectorXd x, const std::function<Descent(const Descending&, double)>& by) {
  Eigen::VectorXd trial;
  Descending here;
  here.model = [&]() -> LocalModel {
    const Eigen::MatrixXd jacobian = problem.jacobian(x);
    return {jacobian.transpose() * jacobian, jacobian.transpose() * problem.residual(x)};
  };
  here.attempt = [&](const Eigen::VectorXd& step) -> std::optional<double> {
    trial = (x + step).cwiseMax(problem.lower).cwiseMin(problem.upper);
    if (trial == x) return std::nullopt;
    return problem.residual(trial).squaredNorm();
  };
  here.accept = [&] { x = trial; };
  const Descent descent = by(here, problem.residual(x).squaredNorm());
  return {x, descent};
}

Result solve(const Residuals& problem, Eigen::VectorXd x, const DescentSettings& settings) {
  return solve(problem, std::move(x), [&](const Descending& here, double cost) { return descend(here, cost, settings); });
}

Result solve(const Residuals& problem, Eigen::VectorXd x, const AdaptingSettings& settings, double& damping) {
  return solve(problem, std::move(x), [&](const Descending& here, double cost) { return descend(here, cost, settings, damping); });
}

// A straight line through (0, 1), (1, 2), (2, 4): normal equations give 5/6 + 3/2 t, the residual's sum of squares is 1/6.
const Residuals kLine{[](const Eigen::VectorXd& x) -> Eigen::VectorXd {
                        return Eigen::Vector3d(x(0) - 1.0, x(0) + x(1) - 2.0, x(0) + 2.0 * x(1) - 4.0);
                      },
                      [](const Eigen::VectorXd&) -> Eigen::MatrixXd { return (Eigen::MatrixXd(3, 2) << 1, 0, 1, 1, 1, 2).finished(); }};

TEST(LeastSquares, OneStepSolvesALinearProblem) {
  const Result result = solve(kLine, Eigen::Vector2d(10.0, -7.0), {10, kDampings, 0.0, 1e-12});
  EXPECT_NEAR(result.x(0), 5.0 / 6.0, 1e-12);
  EXPECT_NEAR(result.x(1), 1.5, 1e-12);
  EXPECT_NEAR(result.descent.cost, 1.0 / 6.0, 1e-12);
  EXPECT_LE(result.descent.iterations, 2);
}

// Of a linear problem the undamped step promises all that it takes away, here down to 1/6. By slopes of the wrong sign it promises as much and leads nowhere.
TEST(LeastSquares, SaysWhatWasPromisedWhereNoStepLeadsOn) {
  Residuals wrong = kLine;
  wrong.jacobian = [](const Eigen::VectorXd& x) -> Eigen::MatrixXd { return -kLine.jacobian(x); };
  const Eigen::Vector2d start(10.0, -7.0);
  const double cost = kLine.residual(start).squaredNorm();
  const Result result = solve(wrong, start, {10, kDampings, 0.0, 1e-12});
  EXPECT_EQ(result.descent.ending, Ending::no_descent);
  EXPECT_NEAR(result.descent.promised, cost - 1.0 / 6.0, 1e-9);
  EXPECT_NEAR(solve(kLine, start, {1, kDampings, 0.0, 1e-12}).descent.promised, cost - 1.0 / 6.0, 1e-9);
}

// Rosenbrock's valley as residuals 10 (y - x^2) and 1 - x: the least is 0 at (1, 1).
const Residuals kValley{[](const Eigen::VectorXd& x) -> Eigen::VectorXd { return Eigen::Vector2d(10.0 * (x(1) - x(0) * x(0)), 1.0 - x(0)); },
                        [](const Eigen::VectorXd& x) -> Eigen::MatrixXd { return (Eigen::Matrix2d() << -20.0 * x(0), 10.0, -1.0, 0.0).finished(); }};

TEST(LeastSquares, FollowsACurvedValley) {
  constexpr std::array<double, 6> kFine{0.0, 0.1, 1.0, 10.0, 100.0, 1000.0};
  const Result result = solve(kValley, Eigen::Vector2d(-1.2, 1.0), {2000, kFine, 0.0, 0.0});
  EXPECT_NEAR(result.x(0), 1.0, 1e-9);
  EXPECT_NEAR(result.x(1), 1.0, 1e-9);
}

// atan(x) from 2: full Gauss-Newton steps run away beyond 1.39, damped ones do not.
TEST(LeastSquares, IsHeldBackWhereAFullStepIsTooBold) {
  const Residuals bend{[](const Eigen::VectorXd& x) -> Eigen::VectorXd { return Eigen::VectorXd::Constant(1, std::atan(x(0))); },
                       [](const Eigen::VectorXd& x) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(1, 1, 1.0 / (1.0 + x(0) * x(0))); }};
  EXPECT_NEAR(solve(bend, Eigen::VectorXd::Constant(1, 2.0), {50, kDampings, 0.0, 0.0}).x(0), 0.0, 1e-9);
  constexpr std::array<double, 1> kFull{0.0};
  const Result full = solve(bend, Eigen::VectorXd::Constant(1, 2.0), {50, kFull, 0.0, 0.0});
  EXPECT_EQ(full.x(0), 2.0);
  EXPECT_EQ(full.descent.ending, Ending::no_descent);
}

// From (-1.2, 1) the whole first step leads up the wall, and the valley is followed in some twenty attempts (by the ladder of dampings above it takes more than a hundred).
TEST(AdaptingDescent, FollowsACurvedValleyInFewAttempts) {
  double damping = 1e-3;
  const Result result = solve(kValley, Eigen::Vector2d(-1.2, 1.0), AdaptingSettings{60, 60, 1e-24}, damping);
  EXPECT_NEAR(result.x(0), 1.0, 1e-9);
  EXPECT_NEAR(result.x(1), 1.0, 1e-9);
  EXPECT_LT(result.descent.iterations, 60);
}

// What one descent has learned of how bold a step may be the next one begins with: cut into parts, the way takes fewer attempts than with parts that begin with whole steps.
TEST(AdaptingDescent, GoesOnWithTheDampingThatLedOn) {
  const auto attempts_in_parts = [](bool goes_on) {
    double damping = 1e-6;
    Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
    int attempts = 0;
    while ((x - Eigen::Vector2d(1.0, 1.0)).norm() > 1e-9 && attempts < 1000) {
      const Result part = solve(kValley, x, AdaptingSettings{8, 8, 0.0}, damping);
      x = part.x;
      attempts += part.descent.iterations;
      if (!goes_on) damping = 1e-6;
    }
    return attempts;
  };
  EXPECT_LT(attempts_in_parts(true), attempts_in_parts(false));
  EXPECT_LT(attempts_in_parts(true), 100);
}

TEST(AdaptingDescent, EndsWhereSlopesAreWorthNoMore) {
  double damping = 1e-3;
  Residuals wrong = kLine;
  wrong.jacobian = [](const Eigen::VectorXd& x) -> Eigen::MatrixXd { return -kLine.jacobian(x); };
  const Eigen::Vector2d start(10.0, -7.0);
  const Result lost = solve(wrong, start, AdaptingSettings{10, 3, 0.0}, damping);
  EXPECT_EQ(lost.descent.ending, Ending::no_descent);
  EXPECT_EQ(lost.x, start);
  EXPECT_EQ(damping, 1e-3);
  EXPECT_EQ(solve(kLine, start, AdaptingSettings{10, 3, 1e-9}, damping).descent.ending, Ending::settled);
  EXPECT_EQ(solve(kLine, start, AdaptingSettings{1, 3, 1e-9}, damping).descent.ending, Ending::most_iterations);
  Residuals bounded = kLine;
  bounded.lower = bounded.upper = 0.0;
  EXPECT_EQ(solve(bounded, Eigen::Vector2d(0.0, 0.0), AdaptingSettings{10, 3, 0.0}, damping).descent.ending, Ending::at_the_bounds);
  Residuals broken = kLine;
  broken.jacobian = [](const Eigen::VectorXd&) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(3, 2, std::numeric_limits<double>::quiet_NaN()); };
  EXPECT_EQ(solve(broken, start, AdaptingSettings{10, 3, 0.0}, damping).descent.ending, Ending::no_direction);
}

TEST(LeastSquares, SaysWhyItEnded) {
  const Eigen::VectorXd start = Eigen::Vector2d(10.0, -7.0);
  EXPECT_EQ(solve(kLine, start, {1, kDampings, 0.0, 0.0}).descent.ending, Ending::most_iterations);
  EXPECT_EQ(solve(kLine, start, {10, kDampings, 1e9, 0.0}).descent.ending, Ending::settled);
  Residuals bounded = kLine;
  bounded.lower = bounded.upper = 0.0;
  EXPECT_EQ(solve(bounded, Eigen::Vector2d(0.0, 0.0), {10, kDampings, 0.0, 0.0}).descent.ending, Ending::at_the_bounds);
  Residuals broken = kLine;
  broken.jacobian = [](const Eigen::VectorXd&) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(3, 2, std::numeric_limits<double>::quiet_NaN()); };
  const Result lost = solve(broken, start, {10, kDampings, 0.0, 0.0});
  EXPECT_EQ(lost.descent.ending, Ending::no_direction);
  EXPECT_EQ(lost.x, start);
  EXPECT_EQ(name_of(Ending::most_iterations), "most iterations");
}

}  // namespace
}  // namespace slewlab::diagnosis
