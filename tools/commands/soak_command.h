#pragma once

// `slewlab soak --hours H --seed S [--jobs N]`: randomly drawn slewing tasks, with invariants checked all along
// (soak/campaign.h, docs/soak.md). `--task K` runs one of them again by itself.
//
// Exit codes: 0 all done and nothing broke, 1 something broke (or the soak could not go on: one line says why), 2 the
// call or the configuration is wrong, 128 + signal when interrupted: the same command goes on.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

struct SoakOptions {
  double hours = 0.0;   // simulated; 0 with `task`
  std::uint64_t seed = 0;
  int jobs = 1;
  bool faults = false;
  std::string task;     // "12" or "3-12"; empty: a campaign
  std::filesystem::path out;  // empty: soak-SEED, with --task soak-SEED-task-K
  std::filesystem::path crane;
  std::filesystem::path controller;
  std::filesystem::path config;
  std::vector<common::Override> overrides;
};

int soak(const SoakOptions& options);

}  // namespace slewlab::tools
