#pragma once

// The plant's half of a recorded run once more: crane, drive and what failed on them, in the order of a run
// (sim/drive/lockstep_loop.h), with what the record says arrived on TORQUE in place of a controller.
//
// A lockstep log holds in its order what the drive received after each ENCODER: nothing, one message, several, broken
// bytes; exactly that arrives again. In any other log a TORQUE arrives with the ENCODER it answers. Where one is missing
// although the controller sent it - its alive counter tells: lost on the way to the logger - it is put on a straight line
// between its neighbours. Where none was sent nothing arrives, and the drive does what it does about silence: it holds
// the last torque, and trips in time. In a wall-clock run the torque acted when it came; here it acts from its ENCODER
// on, since the record does not tell more.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "msgs/run_log.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

// What arrived on TORQUE after each ENCODER, by that one's sequence number.
struct Arrivals {
  std::map<std::int64_t, std::vector<std::vector<std::uint8_t>>> messages;
  std::vector<std::string> remarks;
};

// By the ENCODER that each TORQUE answers.
Arrivals arrivals_by_answer(const msgs::RunLog& record);

// In the order of the file where it is a lockstep log (stamped with simulated time) with every ENCODER of this record in
// it; by the ENCODER answered otherwise.
Arrivals recorded_arrivals(const std::filesystem::path& log, const msgs::RunLog& record);

struct PlantReplay {
  msgs::RunLog run;                  // what the plant said this time
  std::vector<std::string> remarks;  // what the record did not give, one line each
};

// Crane, steps, periods and what fails on the crane are the scenario's; operator moves and configuration the record's.
// Ends one controller period behind the last ENCODER with an arrival. A record whose numbers speak of far more plant steps
// than its messages can stand for is not replayed, and a remark says so. Throws std::invalid_argument where the crane cannot
// be built.
PlantReplay replay_plant(const sim::Scenario& scenario, const msgs::RunLog& record, const Arrivals& arrivals);

}  // namespace slewlab::tools
