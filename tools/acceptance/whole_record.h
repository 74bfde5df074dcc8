#pragma once

// Whether a record, by itself, holds everything that its scenario promises. Asked where no summary.json tells which log the
// run wrote: what is missing then shows in the messages alone.

#include <string>

#include "msgs/run_log.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

// Why it does not; empty where it does. Every channel of the plant has to be there from the run's beginning to its end at its
// period, an answer to every ENCODER, and finite numbers; a sensor without any number is not fitted. ENCODER's numbers and the
// answers are looked at up to the first fault on purpose, the answers' numbers up to a trip of the drive. `of_own_plant`: SENSORS,
// TRUTH and PLANT_STATUS may be left out (docs/wire.md, what a plant must do).
std::string why_not_whole(const msgs::RunLog& run, const sim::Scenario& scenario, bool of_own_plant);

}  // namespace slewlab::tools
