// Impacts that a cause's machine has and the nominal one has not. Where gears let go and strike again small differences grow to full size,
// behind the nominal machine's own impacts and behind those of the machine that was really there: a torque that is late, or a load that is heavier, crosses the play at other moments. What lies near them tells as little, and outweighs
// all else where sensors are quiet.
#pragma once

#include <optional>

#include "diagnosis/fit.h"
#include "diagnosis/problem.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// Where most of the residual of a cause's machine lies near its own impacts, these stretches are judged no more (Record::impacts_of_cause), and the
// records are whitened anew, with `admitted` the nominal machine that they were admitted with. Gives the share of all records that the stretches
// take. 0: nothing has changed, as where too little of a record would be left to judge. Assumes that the problem owns its records.
double take_out_impacts(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings, const Point& cause);

// The nominal machine as records begin on it that begin on a machine that has moved before, told by what lies before its first impacts. Load and boom
// may swing otherwise than the nominal machine is taken to, and no fit finds that through impacts that come at other moments; the impacts of the
// machine found are those to take out. Nothing where all begin unmoved, where no impact follows, or where too little lies before it. The problem is
// left as it was.
std::optional<FitResult> begun_before_impacts(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings);

}  // namespace slewlab::diagnosis
