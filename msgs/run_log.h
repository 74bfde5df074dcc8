#pragma once

// A whole log in memory, message by message, each channel in the order of its sequence numbers (TORQUE and
// CONTROLLER_STATE: of the ENCODER they answer): duplicates are dropped, out-of-order events sorted, and what could not
// be used is told. Several runs in one file come out apart, by the rules of
// msgs/run_order.h.

#include <filesystem>
#include <string>
#include <vector>

#include "msgs/log_reader.h"
#include "msgs/messages.h"

namespace slewlab::msgs {

struct RunLog {
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::vector<Encoder> encoder;
  std::vector<Torque> torque;
  std::vector<Operator> operator_moves;
  std::vector<Sensors> sensors;
  std::vector<Truth> truth;
  std::vector<ControllerState> controller_state;
  std::vector<PlantStatus> plant_status;
};

struct RunLogs {
  std::vector<RunLog> runs;          // in the order in which they begin in the file
  std::vector<std::string> remarks;  // what could not be used, one line each
  // Signs that the file is not as it was written. TORQUE and CONTROLLER_STATE do not count as such: they are logged as
  // they came from the controller, whatever that was.
  std::int64_t lost_bytes = 0;       // that are no event
  std::int64_t lost_messages = 0;    // of the plant, undecodable or strays
};

// Throws LogError where the file cannot be read or holds no message of slewlab.
RunLogs read_run_logs(const std::filesystem::path& path);

}  // namespace slewlab::msgs
