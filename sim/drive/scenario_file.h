// Reads a scenario from YAML (config/scenarios): which machine, which controller, what the operator does, and
// how finely time is cut. Both the plant process and `slewlab run` read it here.
//
// The machine stands under `crane:` or, of kind axis, under `axis:`. Overrides whose key begins with that word and a dot, or
// with "controller.", change those files, all others the scenario:
//   --set crane.load.mass="20 t"   --set controller.ramp.curved_share=0.2   --set duration=10
//   --set crane=other.yaml     names another file, relative to the working directory.
//
// Times are whole nanoseconds. The controller's period, the telemetry's periods and the operator's times are
// whole multiples of the plant step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "common/yaml_reader.h"
#include "sim/machine/machine_file.h"
#include "sim/drive/fault.h"
#include "sim/drive/fault_expectation.h"
#include "sim/drive/operator_move.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::sim {

struct Scenario {
  std::filesystem::path crane_file;
  std::filesystem::path controller_file;
  std::vector<common::Override> crane_overrides;
  std::vector<common::Override> controller_overrides;

  std::int64_t duration = 0;           // [ns]
  std::int64_t plant_step = 0;         // [ns]
  std::int64_t controller_period = 0;  // [ns]
  std::int64_t sensors_period = 0;     // [ns] of SENSORS
  std::int64_t truth_period = 0;       // [ns] of TRUTH
  std::int64_t status_period = 0;      // [ns] of PLANT_STATUS
  std::int64_t seed = 0;               // of everything that is drawn at random
  std::vector<OperatorMove> moves;     // rising times; in the file a move names what changes, the rest stays

  MotionRequests motion_requests;      // hoisting, luffing, travelling beside slewing

  std::vector<Fault> faults;
  std::vector<EffectSwitch> effect_switches;  // rising times, several at one time as they stand in the file
  FaultExpectation expectation;  // no part of the configuration: it changes no run
  MachineFile crane;

  // Crane, controller and scenario as one canonical text: what the configuration hash is taken of.
  std::string configuration_text;
};

// Loads the scenario and its crane, and reads the controller's YAML for the configuration text (the
// controller's own reader checks it). Throws common::InputError with every problem found.
Scenario load_scenario_file(const std::filesystem::path& file,
                            const std::vector<common::Override>& overrides = {});

// The scenario's own part of an opened file, without its faults and finish(); which kind of machine it has stands in `scenario`.
void read_scenario(common::YamlReader& reader, Scenario& scenario);

// The same for a check: adds the problems to `problems` and answers with what could be read.
Scenario read_scenario_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                            common::InputProblems& problems);

}  // namespace slewlab::sim
