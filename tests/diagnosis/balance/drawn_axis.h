// Axes drawn from a seed, as real ones differ, and integrated by time stepping of its own: friction with its jump solved for in every fine step
// (Moreau's scheme; bristles exactly over the step), motor and load on an elastic, clearanced shaft, a drive that lags, a recorder
// that counts, delays and samples. Nothing of the project's plant or balance is in it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "diagnosis/balance/axis_diagnosis.h"

namespace slewlab::diagnosis {

struct DrawnAxis {
  std::string kind;             // what was drawn: "stribeck", "nothing"
  std::string conditions;       // rate, excitation and what the recorder does, in words
  std::set<std::string> laws;   // that act, by their names in the balance
  std::set<std::string> alike;  // that these records may show in their place, or beside them: no error
  bool is_unknown = false;      // most of the gap is of no law
  std::string machine;          // the axis's file
  std::vector<NamedRun> runs;   // to diagnose
  std::vector<NamedRun> unseen;
};

// All kinds that there are, in their order.
const std::vector<std::string>& drawn_kinds();

DrawnAxis drawn_axis(const std::string& kind, unsigned seed);

}  // namespace slewlab::diagnosis
