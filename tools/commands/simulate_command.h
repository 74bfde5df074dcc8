// `slewlab simulate MACHINE LOG --out DIR`: the machine driven by the torque of a log, open loop, from the motion in which
// the log begins (tools/replay/open_loop.h). DIR gets run.lcmlog of the same channels and run.json, for
// `slewlab report DIR LOG`. What an earlier run left there is taken away first (run_facts.h).
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

struct SimulateOptions {
  std::filesystem::path machine = {};
  std::filesystem::path log = {};
  std::filesystem::path out = {};        // folder
  double longest_step = 1e-3;            // [s] of the plant
  std::vector<common::Override> overrides = {};
};

// Answers with the exit code 0. Throws common::InputError where the machine's file is wrong, msgs::LogError where the log
// cannot be read or written, std::invalid_argument where the two do not fit.
int simulate(const SimulateOptions& options, std::ostream& out);

}  // namespace slewlab::tools
