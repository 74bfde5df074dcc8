#pragma once

// `slewlab accept SCENARIO.yaml|RUN_DIR`: acceptance checks of a controller (acceptance/checks.h) against limits in
// YAML. A scenario is run first, as `slewlab run` would; of a run's folder only the log is read.
//
// Into the run's folder go acceptance.json and, where the Python side is set up, acceptance.html with the plot; where
// asked for, JUnit XML. No verdict is given on a run that did not come to its end (the check "run" says why) or whose log is
// cut off, damaged, or not the one that the run wrote (the check "log"): no other check is made then, and the exit code is
// that of a run that is not accepted. Exit codes: 0 accepted, 1 not accepted or no verdict, 2 the call or the
// configuration is wrong.

#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

//
// With `record` the subject is a test plan (acceptance/plan.h): every run of it is made and judged, and the folder gets
// record.json, record.xml (JUnit) and, where the Python side is set up, record.html; each run in a folder of its name. Exit
// code 0 where every requirement is met or deviates as was agreed, and nothing else was found.

struct AcceptOptions {
  std::filesystem::path subject;    // scenario or folder of a run
  std::filesystem::path limits;
  std::filesystem::path junit;      // empty: none
  std::filesystem::path out;        // of a scenario; empty: runs/accept_<name>
  std::string controller_command;   // of a scenario; empty: slewlab-controller
  std::filesystem::path controller_fmu;  // as these of run_command.h, of a scenario
  std::string plant_command;
  std::vector<common::Override> overrides;
  bool plot = true;
  bool record = false;              // subject is a test plan
};

int accept(const AcceptOptions& options, const std::vector<std::string>& command_line);

}  // namespace slewlab::tools
