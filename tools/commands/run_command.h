#pragma once

// `slewlab run SCENARIO.yaml`: the plant and the controller as two processes on a bus of their own, watched
// from here.
//
// Into the folder go run.lcmlog (run.lcmlog.partial until it is complete), scenario.yaml, crane.yaml and
// controller.yaml as they ran, summary.json, run.json (run_facts.h), and plant.txt and
// controller.txt with what the two had to complain about. What an earlier run left there, and what was drawn or exported of it, is taken
// away first.
//
// Whatever happens - success, an error, Ctrl-C, a killed child, this process killed - no process is left
// behind. Exit codes: 0 complete, 1 a side failed (which, how and its last words stand on standard error)
// or what the scenario says under `expect:` did not come about (in lockstep; with realtime it is told and does not count),
// 2 the call or the configuration is wrong, 128 + signal where a signal ended the run.

#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

enum class Progress { automatic, lines, none };

struct RunOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;       // empty: runs/<name of the scenario's file>
  std::string controller_command;  // empty: slewlab-controller; else a shell command
  std::filesystem::path controller_fmu;  // empty, or the controller in place of both
  std::string plant_command;       // empty: slewlab-plant; else a shell command
  std::vector<common::Override> overrides;
  bool realtime = false;                    // against the wall clock
  double speed = 1.0;                       // simulated seconds per second, with realtime
  bool steered = false;                     // by lines on standard input (sim/drive/steering.h), in place of the scenario's operator
  Progress progress = Progress::automatic;  // on a terminal one line that changes, else a line now and then
};

// Whether the controller of the options, where it is an FMU, and the plant, where it is one of one's own, can take the scenario; says why
// not.
bool can_be_run_by_others(const RunOptions& options);

// `command_line` is this program's own, to start it again inside a private network where there is no
// multicast.
int run_scenario(const RunOptions& options, const std::vector<std::string>& command_line);

}  // namespace slewlab::tools
