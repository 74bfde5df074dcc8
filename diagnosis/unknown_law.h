// A law that is in no catalogue, as a hypothesis of its own: a torque at the motors that is a smooth function of one variable (discrepancy.h), alone or beside one effect.
//
//   minimise over z and a   L(s (|d(z, a)|^2 - n)) + p(z) + a'a / rho
//
// d(z, a) are the differences of a fit's machine with parameters and effect z, under the function with the coefficients a, p the prior of what the fit has, L as in fit.h. The steps are
// those of a fit; the columns are the fit's and the function's traces, corrected by what each step shows. It is made for the rho that promises most and stands, at z and a, for every rho: how large such a torque is, is not known
// before, so that each of its values is a hypothesis, and so is each variable. Of a variable by which the slower differences say nothing (Discrepancy::evidence) there is none.
#pragma once

#include <Eigen/Core>
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

// Beside what a fit has. `residual_power` is that of the fit by which its cause is weighed, `discrepancies` are those that `smooth` tells of the
// fit's residual. Throws Interrupted.
std::vector<UnknownLaw> unknown_laws(Problem& problem, const FitResult& fit, double residual_power, const SmoothTorques& smooth, const std::vector<Discrepancy>& discrepancies, const EvidenceSettings& evidence,
                                     const MisfitCost& misfit_cost, double floor);

}  // namespace slewlab::diagnosis
