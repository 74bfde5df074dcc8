// Any text as a scenario's file, with its faults and expectations, beside those of config/: a scenario that can run, or
// problems that say where.

#include "common/input_error.h"
#include "sim/drive/scenario_run.h"
#include "sim/drive/scenario_file.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  static const fuzz::ConfigurationCopy configuration;
  static const std::filesystem::path path = configuration.path() / "scenarios/faults/fuzz.yaml";
  fuzz::write_file(path, data, size);
  try {
    const sim::Scenario scenario = sim::load_scenario_file(path);
    const sim::LockstepSettings settings = sim::lockstep_settings(scenario);
    fuzz::require(settings.plant_step > 0 && settings.controller_period % settings.plant_step == 0,
                  "a period is a whole number of steps");
    for (std::size_t i = 1; i < settings.operator_moves.size(); ++i) {
      fuzz::require(settings.operator_moves[i - 1].time < settings.operator_moves[i].time, "moves rise in time");
    }
  } catch (const common::InputError&) {
  }
  return 0;
}
