// Reads `faults:` and `expect:` of a scenario (docs/faults.md).
#pragma once

#include <cstdint>
#include <vector>

#include "common/yaml_reader.h"
#include "sim/drive/fault.h"
#include "sim/drive/fault_expectation.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// Groups and torques are those of `drive`. Faults without a seed of their own get one from the scenario's and their place in the list, in which `faults_before` stand before
// these.
std::vector<Fault> read_faults(common::YamlReader& scenario, std::int64_t controller_period, const DriveParameters& drive,
                               std::uint64_t scenario_seed, std::size_t faults_before = 0);

FaultExpectation read_expectation(common::YamlReader reader);

// [rad] that a machine may still move while it counts as standing: a tenth of what it covers at top speed in the time that it takes
// to get there. Throws as scales_of().
double standing_angle_of(const CraneParameters& machine);

}  // namespace slewlab::sim
