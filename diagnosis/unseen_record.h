// The answer on records that had no part in it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/problem.h"
#include "diagnosis/cause.h"
#include "diagnosis/record.h"
#include "diagnosis/validate.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// How the answer predicts a record that no fit has seen.
struct UnseenRecord {
  std::string record;
  std::string cause;      // that was tried, by name; empty where nothing is missing or no known effect is the answer: parameters alone
  Validation validation;
  double nominal_torque = 0.0, parameters_torque = 0.0, cause_torque = 0.0;  // [Nm per motor] RMS of the missing torque
};

// `lead` is the first cause; nothing where it is no known effect: then parameters alone, from where `parameters_of_all` has them, predict in its place. A record that is not admitted is told in `remarks`.
// Throws Interrupted.
std::vector<UnseenRecord> judge_unseen(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all,
                                       const Cause* lead, std::vector<Record> unseen, std::vector<std::string>& remarks);

}  // namespace slewlab::diagnosis
