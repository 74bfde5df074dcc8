// The diagnosis on one withheld case, as score.h asks for it.
#pragma once

#include <atomic>

#include "diagnosis/diagnose.h"
#include "diagnosis/withheld/score.h"

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

withheld::CaseResult diagnose_case(const withheld::CaseInput& input, const CaseSettings& settings,
                                   const std::atomic<bool>* stop = nullptr);

// The gap that is left in the unseen manoeuvre by a fit that is told the effects.
double informed_gap(const withheld::CaseInput& input, const std::vector<std::string>& effects,
                    const CaseSettings& settings);

}  // namespace slewlab::diagnosis
