// Rod and boom swing on behind a record's beginning, each with a phase that the first seconds, which are not judged, do not tell: a descent that ended at another
// one's lets them swing hard where they are quiet, and goes on from where they are.
#pragma once

#include "diagnosis/nuisance.h"
#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

// Rod and boom, and what swings outwards, of every record in which one of them swings farther than machines do: at rest. False where none does.
bool quieten_beginnings(const Nuisances& nuisances, Point& point);

}  // namespace slewlab::diagnosis
