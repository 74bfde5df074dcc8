#pragma once

// A soak's task: one slewing job on one crane, drawn from the campaign's seed and the task's number alone, so that any
// task can be made again by itself. As files it is a scenario like any other: `slewlab run` and `slewlab replay` take it.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "controller/ramp.h"
#include "sim/drive/fault.h"
#include "sim/model/crane_parameters.h"
#include "sim/drive/operator_move.h"
#include "tools/soak/settings.h"

namespace slewlab::tools {

struct SoakTask {
  std::uint64_t seed = 0;  // of the campaign
  std::int64_t number = 0;
  double boom_angle = 0.0;   // [rad]; as the crane has it where it has no boom
  double load_mass = 0.0;    // [kg]; 0 where nothing hangs
  double rope_length = 0.0;  // [m]
  std::int64_t scenario_seed = 0;
  std::vector<sim::OperatorMove> moves;
  std::vector<sim::Fault> faults;
};

// The load stays within the largest mass and the largest moment at the boom's radius. The operator watches it: a move
// that would swing it beyond `watched_sidelead` is not made. He foresees a point mass on the rope behind the ramp; an
// emergency stop comes when it comes. With `with_faults` every task has at least one fault, and the operator
// acknowledges now and then.
SoakTask draw_task(const TaskRanges& ranges, const sim::CraneParameters& crane, const controller::RampSettings& ramp,
                   bool with_faults, std::uint64_t seed, std::int64_t number);

// The task as a scenario on these two files, and what it changes on the crane's.
std::string task_scenario(const SoakTask& task, const TaskRanges& ranges, const std::filesystem::path& crane,
                          const std::filesystem::path& controller);
std::vector<common::Override> task_overrides(const SoakTask& task, const sim::CraneParameters& crane);

// One line for people: "boom 53.5 deg, 30.0 t on 60.0 m, 14 moves, 1 emergency stop, faults: message_lost".
std::string describe(const SoakTask& task);

}  // namespace slewlab::tools
