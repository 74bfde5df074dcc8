// Validation decides which cause leads: one by one, the likeliest is asked to predict data that were not fitted (validate.h), until one does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/problem.h"
#include "diagnosis/ranking.h"
#include "diagnosis/validate.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// A cause leads only if it predicts data that were not fitted better than the nominal machine and than parameters alone. Else its probability goes to
// nothing missing where the residual of either is noise there, and otherwise to what is not known. That of a cause with stochastic effects beside
// which an unknown power predicts as well goes to the causes that have its other effects. `parameters_of_all` is where parameters alone stand, fitted
// to all records. Where they stand farther off than machines of one make do, they are no rival of an effect that is one of them grown: both predict
// the same. Gives the machine of the cause that leads, fitted without what it was asked to predict; nothing where none was asked, or none predicted.
// Throws Interrupted.
std::optional<HeldOut> validate_lead(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all,
                                     bool are_parameters_likely, Ranking& ranking, std::vector<std::string>& remarks);

}  // namespace slewlab::diagnosis
