// The sensors' noise as another machine than the nominal one has it.
//
// Differences are divided by what the sensors' noise makes of them in the nominal machine (whitening.h). Another machine makes something else of it:
// a boom that is damped more shakes less with the noise of the accelerometer by which the observer leads it, and its residual is smaller than the
// noise without being right. So its differences count by their own covariance,
//
//   -2 ln P = sum over bins of z* V^-1 z,    V = L^-1 (B + (m - 1) E + W N(machine) W* / 2) L^-*
//
// with m = 1. N the power of the noise that comes through the observer, B what else there is in each channel, W and L as whitening.h has them: 1 in the nominal machine. E is what mesh and step make wrong of B, and m how many times it counts: unlike noise, that is
// not drawn anew from bin to bin. No ln det V: what is compared is the density of the readings, whose
// noise is the same whatever machine it is led through, and the determinant of that way takes it away.
#pragma once

#include <Eigen/Core>

#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

// What differences and their columns come to by their own covariance.
struct ByOwnNoise {
  double square = 0.0;    // z* V^-1 z
  Eigen::MatrixXd gram;   // J* V^-1 J
  Eigen::VectorXd slope;  // J* V^-1 z
};

// In the machine at the point, where what acts while it runs and is not linear changes nothing. Columns may be none; `discrepancy_count` is m. By the nominal machine's noise where that of the
// machine is no number: a machine that shakes without end has none.
ByOwnNoise by_own_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns, double discrepancy_count);

// z* V^-1 z where the machine makes nowhere more of the noise than the nominal one.
double square_by_less_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, double discrepancy_count);

// What the noise of the machine at the point alone would leave of differences as the problem divides them: the mean of V on its diagonal.
double mean_square_of_noise(const Problem& problem, const Point& point);

// K^-1 z, K K* = V of the machine at the point.
Eigen::VectorXd divided_by_own_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference);

}  // namespace slewlab::diagnosis
