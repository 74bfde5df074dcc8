#pragma once

// The plant's half of a recorded run once more: the very loop of the run (sim/drive/lockstep_loop.h), with the
// recorded TORQUE messages in the controller's place. Every ENCODER is answered at once by the TORQUE that answered
// it in the record.
//
// Where the record has no answer (lost on its way to the logger, cut off, a controller that was too slow) the last
// torque holds, as it does in the drives, and before the first one there is none. In a record of a wall-clock run
// the torque acted when it came; here it acts from its ENCODER on, since the record does not tell more.

#include <filesystem>
#include <string>
#include <vector>

#include "msgs/run_log.h"
#include "sim/scenario_file.h"

namespace slewlab::tools {

struct PlantReplay {
  msgs::RunLog run;                  // what the plant said this time
  std::vector<std::string> remarks;  // what the record did not give, one line each
};

// Crane, steps and periods are the scenario's; operator moves and configuration the record's. Ends one controller
// period behind the last recorded TORQUE. `scratch` is a folder for a log that is removed again. Throws
// std::invalid_argument where the crane cannot be built or periods do not fit, msgs::LogError.
PlantReplay replay_plant(const sim::Scenario& scenario, const msgs::RunLog& record,
                         const std::filesystem::path& scratch);

}  // namespace slewlab::tools
