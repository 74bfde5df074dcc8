// Reads `faults:` and `expect:` of a scenario (docs/faults.md).
#pragma once

#include <cstdint>
#include <vector>

#include "common/yaml_reader.h"
#include "sim/drive/fault.h"
#include "sim/drive/fault_expectation.h"

namespace slewlab::sim {

// Faults without a seed of their own get one from the scenario's and their place in the list.
std::vector<Fault> read_faults(common::YamlReader& scenario, std::int64_t controller_period, int group_count,
                               std::uint64_t scenario_seed);

FaultExpectation read_expectation(common::YamlReader reader);

}  // namespace slewlab::sim
