// The least-squares descents of every fit: Gauss-Newton steps that are held back where the cost would rise (Levenberg 1944, Marquardt 1963),
//
//   (H + damping diag(H)) step = -g,
//
// g half the slope of the cost where the descent stands and H the curvature that goes with it (J^T W J and the prior's). The dampings
// are tried in turn until the cost falls. A damped step is shorter and turns towards the steepest descent, which a shorter one of
// the same direction would not. Along a narrow curved valley neither the whole step leads on nor one of a few that are damped by orders of magnitude: there the damping follows what
// the attempts made of the fall that the model had promised (Nielsen, IMM-REP-1999-05, 1999), and new slopes begin with the damping that led on last.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace slewlab::diagnosis {

// Why a descent ended.
enum class Ending {
  settled,          // the last step was worth too little
  no_descent,       // with no damping does the cost fall
  at_the_bounds,    // the bounds, or a slope of zero, leave no step
  no_direction,     // the equations have no finite solution
  most_iterations,  // it still fell
};
std::string_view name_of(Ending ending);

struct LocalModel {
  Eigen::MatrixXd curvature;  // H
  Eigen::VectorXd slope;      // g
};

struct Descending {
  std::function<LocalModel()> model;  // where the descent stands; asked before every step tried, which may have corrected it
  std::function<std::optional<double>(const Eigen::VectorXd& step)> attempt;  // the cost there; nothing where the bounds leave no step
  std::function<void()> accept;  // goes on from the last attempt
};

struct AdaptingSettings {
  int attempts = 0;
  int failures = 0;     // in a row that end a descent which has led on: the slopes are worn out
  double enough = 0.0;  // fall of the cost: where no more is promised, the descent has settled
};

struct DescentSettings {
  int iterations = 0;
  std::span<const double> dampings;
  // A fall of the cost by no more than this ends the descent.
  double enough = 0.0, enough_share = 0.0;
};

struct Descent {
  double cost = 0.0;
  int iterations = 0;
  Ending ending = Ending::most_iterations;
  double promised = 0.0;  // fall of the cost, -g^T step, by the undamped step from where it ended: where no step makes it fall and much was promised, the slopes were wrong
};

// From where `problem` stands, with `cost` there and from a damping on, which becomes the one that led on last.
Descent descend(const Descending& problem, double cost, const AdaptingSettings& settings, double& damping);

// From where `problem` stands, with `cost` there.
Descent descend(const Descending& problem, double cost, const DescentSettings& settings);

}  // namespace slewlab::diagnosis
