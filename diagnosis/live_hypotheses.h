// What a diagnosis leaves open: whether its answer is sure, which causes are live beside it, and the manoeuvre that tells them apart.
#pragma once

#include <functional>
#include <optional>

#include "diagnosis/diagnose.h"
#include "diagnosis/next_manoeuvre.h"

namespace slewlab::diagnosis {

inline constexpr double kSure = 0.9;  // probability from which an answer is stated without a doubt

// That the effects of one cause act, alone or beside another, or that nothing is missing that the records would show, with at least kSure.
bool is_sure(const Diagnosis& found);

// The likeliest causes, as fitted, and the controller with them, at the record's own period.
std::vector<Hypothesis> live_hypotheses(const sim::MachineSettings& nominal, const controller::ControllerSettings& controller,
                                        const Diagnosis& found, const Record& like);

// What to run next where the answer is not sure; nothing where it is, or fewer than two known causes are live. Throws Interrupted.
std::optional<NextManoeuvre> manoeuvre_after(const sim::MachineSettings& nominal, const controller::ControllerSettings& controller,
                                             const Diagnosis& found, const Record& like, const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis
