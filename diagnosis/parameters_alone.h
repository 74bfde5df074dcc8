// Where the hypotheses are compared: the machine of the file with its parameters alone fitted, and with what each record's beginning is like. The cost has several valleys - contacts make the differences uneven, parameters
// imitate each other - so it is descended in several ways.
#pragma once

#include <optional>

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

// The fit of the parameters alone, concluded. From the nominal machine in several ways, until two of them end at one cost, for others lead there as well; and from where a fit of a machine that is built a little otherwise
// has ended, if one has.
FitResult fit_parameters_alone(Problem& problem, const FitResult& nominal, const std::optional<Point>& ended_otherwise = {});

// Whether no record begins on a machine that has moved before.
bool all_begin_unmoved(const Problem& problem);

// The nominal machine, the parameters where the file has them, with what a record's beginning is like fitted (the load's swing, where motors and boom stand), which is no property of the machine: from where
// `fitted` has it. Nothing where all begin unmoved.
std::optional<FitResult> nominal_with_beginnings(Problem& problem, const FitResult& fitted);

}  // namespace slewlab::diagnosis
