// Impacts that a cause's machine has and the nominal one has not. Where gears let go and strike again small differences grow to full size,
// behind the nominal machine's own impacts and behind those of the machine that was really there: a torque that is late, or a load that is heavier, crosses the play at other moments. What lies near them tells as little, and outweighs
// all else where sensors are quiet.
#pragma once

#include "diagnosis/problem.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

// Where most of the residual of a cause's machine lies near its own impacts, these stretches are judged no more (Record::impacts_of_cause), and the
// records are whitened anew, with `admitted` the nominal machine that they were admitted with. Gives the share of all records that the stretches
// take. 0: nothing has changed, as where too little of a record would be left to judge. Assumes that the problem owns its records.
double take_out_impacts(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings, const Point& cause);

}  // namespace slewlab::diagnosis
