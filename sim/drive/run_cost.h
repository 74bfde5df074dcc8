// What a scenario will cost in lockstep before it is run, from the figures of docs/benchmarks.md: good to a factor of two or
// three on a machine of these years, enough to tell a coffee from a night.
//
//   seconds = steps (151 ns + 14.9 ns per boom element) + controller periods * 20 us + elements^3 * 1e-7 s
//
// the last being the assembly of the boom's modes.
#pragma once

#include <string>

#include "sim/drive/scenario_file.h"

namespace slewlab::sim {

struct RunCost {
  double steps = 0.0;    // plant steps
  double seconds = 0.0;  // [s] of processor time
};

RunCost run_cost(const Scenario& scenario);

// "about 60 000 000 000 plant steps, some 4 hours"
std::string text_of(const RunCost& cost);

}  // namespace slewlab::sim
