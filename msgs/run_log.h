#pragma once

// A whole log in memory, message by message, each channel in the order of its sequence numbers (TORQUE and
// CONTROLLER_STATE: of the ENCODER they answer): duplicates are dropped, out-of-order events sorted, and what could not
// be used is told. Several runs in one file come out apart. tools/python/run_log.py goes by the same rules:
//
// - A run is what one pair of run_identity and configuration_hash says, if at least two different messages of the plant
//   (ENCODER, SENSORS, TRUTH, PLANT_STATUS) say it, or if it is the largest part of a file without such a pair. Messages
//   of any other pair are strays: a bit that turned over, or another controller on the bus.
// - Of one pair, the simulated time of ENCODER (without any: of the plant's channel with most messages) tells the runs
//   apart, in the order of the file. Where it falls back by more than 1 s or leaps ahead by more (or by four times the usual distance between messages, if that is
//   more still), the next message decides: if it goes on from there, another run has begun, or there is a gap; if not,
//   the message that leapt is a stray. All other messages go with those around them in the file, and between two runs
//   with the one whose time is nearer.
// - Within a run, sequence number and simulated time of a channel go together: where nine messages in ten lie on
//   time = offset + period * sequence exactly, those that do not are strays. Answers are measured by the line of ENCODER,
//   if more than half of them lie on it. Where there is no such line (OPERATOR never has one) those are strays that spoil
//   the order: what remains is the longest row, by time, in which no sequence number falls. If that took more than one
//   message in a hundred (and more than one), it would be no stray but a clock that was set, and everything stays.
// Strays are counted, told and left out.

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
