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
#include <functional>
#include <string>
#include <vector>

#include "msgs/run_stream.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

// What arrived on TORQUE after one ENCODER.
struct Arrival {
  std::int64_t encoder = 0;  // sequence number
  std::vector<std::vector<std::uint8_t>> messages;
};

// All of them, the ENCODER's sequence numbers rising; those after which nothing arrived are left out.
struct Arrivals {
  using Next = std::function<bool(Arrival&)>;  // false behind the last
  std::function<Next()> open;                  // from the beginning
  std::vector<std::string> remarks;
};

// By the ENCODER that each TORQUE answers.
Arrivals arrivals_by_answer(const msgs::RunStream& record);

// In the order of the file where it is a lockstep log (stamped with simulated time) with every ENCODER of this record in
// it; by the ENCODER answered otherwise.
Arrivals recorded_arrivals(const std::filesystem::path& log, const msgs::RunStream& record);

// Takes what the plant says this time, message by message.
struct PlantListener {
  std::function<void(const msgs::Encoder&)> encoder;
  std::function<void(const msgs::Sensors&)> sensors;
  std::function<void(const msgs::Truth&)> truth;
  std::function<void(const msgs::PlantStatus&)> plant_status;
};

// Crane, steps, periods and what fails on the crane are the scenario's; operator moves and configuration the record's.
// Ends one controller period behind the last ENCODER with an arrival. Answers with what the record did not give, one line each.
// A record whose numbers speak of far more plant steps than its messages can stand for is not replayed, and a line says so.
// Throws std::invalid_argument where the crane cannot be built.
std::vector<std::string> replay_plant(const sim::Scenario& scenario, const msgs::RunStream& record, const Arrivals& arrivals,
                                      const PlantListener& listener);

}  // namespace slewlab::tools
