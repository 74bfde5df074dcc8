// The diagnosis on one withheld case, as score.h asks for it.
#pragma once

#include <functional>

#include "diagnosis/diagnose.h"
#include "diagnosis/evaluation/score.h"

namespace slewlab::diagnosis {

struct CaseSettings {
  DiagnosisSettings diagnosis;
  bool accelerometers = true;  // false: encoders and torques alone
};

// Nominal crane, controller and records of the case. Throws common::InputError, NotAdmitted.
struct CaseData {
  sim::MachineSettings nominal;
  controller::ControllerSettings controller;
  std::vector<Record> records;
  Record unseen;
};
CaseData load_case(const withheld::CaseInput& input, bool accelerometers);

// Both throw Interrupted where `is_stopped` says so, which is asked before every simulation.
withheld::CaseResult diagnose_case(const withheld::CaseInput& input, const CaseSettings& settings,
                                   const std::function<bool()>& is_stopped = {});

// The gap in the unseen manoeuvre, of a fit that is told the effects.
double informed_gap(const withheld::CaseInput& input, const std::vector<std::string>& effects,
                    const CaseSettings& settings, const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis
