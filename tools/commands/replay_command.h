#pragma once

// `slewlab replay LOG`: a recorded run cut in two at the wire, each half fed with what the other half said in the
// record, and what it says compared with the record to the bit.
//
//   plant       recorded TORQUE in; ENCODER, SENSORS, TRUTH and the drive's state out
//   controller  recorded ENCODER and OPERATOR in; TORQUE and CONTROLLER_STATE out
//
// With a controller command only the second half runs, against that process, over LCM in lockstep: what the new
// code would have answered to the recorded motion.
//
// The configuration is scenario.yaml, crane.yaml and controller.yaml beside the log, as `slewlab run` leaves them,
// unless told otherwise. A log without them (lcm-logger's) needs a crane, a controller's configuration, or both; steps
// and periods are then taken from the log.
//
// Exit codes: 0 all that was compared is the same (to the bit, or within the tolerances given), 1 something differs or
// nothing could be compared, 2 the call, the configuration or the log is no good.

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

struct ReplayOptions {
  std::filesystem::path log;                // or the folder of a run
  std::filesystem::path scenario;           // empty: scenario.yaml beside the log, if there is one
  std::filesystem::path crane;              // empty: the scenario's
  std::filesystem::path controller_config;  // empty: the scenario's
  std::string controller_command;           // empty: ours, in this process
  std::filesystem::path controller_fmu;     // empty, or the controller in place of both
  std::vector<common::Override> overrides;  // as of `slewlab run`
  // "TORQUE.motor_torque=0.5": differences up to this size [SI] are shown, but do not count.
  std::vector<std::string> tolerances;
  int run = 0;                              // of several in one file, from 1; 0: all of the configuration at hand
};

// `command_line` is this program's own, to start it again inside a private network where there is no multicast.
int replay(const ReplayOptions& options, const std::vector<std::string>& command_line, std::ostream& out,
           std::ostream& err);

}  // namespace slewlab::tools
