// A law that is in no catalogue, as a hypothesis of its own: a torque at the motors that is a smooth function of one variable (discrepancy.h), alone or beside one effect.
//
//   minimise over z and a   L(s (|d(z, a)|^2 - n)) + p(z) + a'a / rho
//
// d(z, a) are the differences of a fit's machine with parameters and effect z, under the function with the coefficients a, p the prior of what the fit has, L as in fit.h. The steps are
// those of a fit; the columns are the fit's and the function's traces, corrected by what each step shows, and difference quotients where it then stands, until that is worth little. It is made for the rho that promises most and stands, at z and a, for every rho: how large such a torque is, is not known
// before, so that each of its values is a hypothesis, and so is each variable. Of a variable by which the slower differences say nothing (Discrepancy::evidence) there is none.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/discrepancy.h"
#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

struct UnknownLaw {
  std::string variable;  // as Discrepancy's
  double residual_power = 0.0, prior = 0.0;  // as Relaxed's
  Eigen::VectorXd information;       // as FitResult's, of its columns and the function's
};

// A law where it is fitted best.
struct FittedLaw {
  SmoothFunction function;
  double rho = 0.0;
  Point point;
  Eigen::VectorXd coefficients;  // in standard deviations of their prior for rho = 1
  Eigen::VectorXd difference;
  Eigen::MatrixXd columns;  // the fit's, then the function's for rho = 1
};

struct UnknownLaws {
  std::vector<UnknownLaw> of_every_size;
  std::optional<FittedLaw> best;  // of all variables
  double least_cost = std::numeric_limits<double>::infinity();  // that one's
};

// Beside what a fit has. `residual_power` is that of the fit by which its cause is weighed, `discrepancies` are those that `smooth` tells of the
// fit's residual. Of a fit without effects the law of one variable is also begun where that variable's law is fitted best beside an effect,
// `elsewhere`, without the effect: from far off parameters alone lead to valleys of their own. `least_cost` is that of the best hypothesis that is known: laws that
// cannot come near it, nor near each other, are left where the columns at hand lead them. Throws Interrupted.
UnknownLaws unknown_laws(Problem& problem, const FitResult& fit, double residual_power, const SmoothTorques& smooth, const std::vector<Discrepancy>& discrepancies, const EvidenceSettings& evidence,
                         const MisfitCost& misfit_cost, double floor, double least_cost, const FittedLaw* elsewhere = nullptr);

}  // namespace slewlab::diagnosis
