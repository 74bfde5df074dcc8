// The sensors' noise as another machine than the nominal one has it.
//
// Differences are divided by what the sensors' noise makes of them in the nominal machine (whitening.h). Another machine makes something else of it: a boom that is damped more shakes
// less with the noise of the accelerometer by which the observer leads it, and leaves less than the noise without being right. So its differences count by their own variance,
//
//   -2 ln P = sum(d^2 / v),    v = 1 + (N(machine) - N(nominal)) w^2 / 2,
//
// N the power of the noise that comes through the observer, w the weight. No ln v: what is compared is the density of the readings, whose noise is the same whatever machine it
// is led through, and the determinant of that way takes ln v away.
#pragma once

#include <Eigen/Core>

#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

// v of every whitened difference, where the noise alone makes it, in the machine at the point. What acts while it runs and is not linear changes nothing.
Eigen::VectorXd own_noise(const Problem& problem, const Point& point);

}  // namespace slewlab::diagnosis
