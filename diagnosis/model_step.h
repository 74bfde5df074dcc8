// How many steps the model takes between two readings of the records, where a force or a friction acts between them.
//
// Modes are stepped exactly whatever the step, held torques too. A force or a friction of an effect is held over each step at its value in the
// middle, so its error falls with the square of the step: to next to nothing at the nominal machine's own, a thousandth of the characteristic time.
// Steps that small cost the same time whatever the records' rate, and a drag needs none of them where a friction that changes every degree does; so
// each effect gets as few as keep the misfit that they make of it, at its first start, below kStepShare of what the evidence allows every law
// (evidence.h), k + r G, G the gap that it makes.
#pragma once

#include <span>
#include <string>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

inline constexpr double kStepShare = 0.1;  // chosen
// Columns lead a fit to where the differences are small, and are corrected on the way by what each step shows, so that they may be wrong by more.
inline constexpr double kColumnShare = 0.2;  // of what an effect changes, that fewer steps may change otherwise; chosen

struct ModelSteps {
  ForceSteps of_differences, of_columns;
};

// Of each force and friction of the machine's catalogue but of `without`, what every machine does included, which every simulation may come to have: at least 1, at
// most as many as the nominal machine's step goes into the records'.
ModelSteps steps_for_forces(Problem& problem, std::span<const std::string> without, const EvidenceSettings& evidence);

}  // namespace slewlab::diagnosis
