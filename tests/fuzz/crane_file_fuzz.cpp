// Any text as a crane's file, beside those of config/: a crane whose plant can be built and moved, or problems that say where. The plant may
// refuse to be built.

#include <cmath>
#include <stdexcept>

#include "sim/drive/crane_plant.h"
#include "sim/drive/scenario_run.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  static const fuzz::ConfigurationCopy configuration;
  static const std::filesystem::path path = configuration.path() / "cranes/fuzz.yaml";
  fuzz::write_file(path, data, size);
  constexpr std::int64_t kMillisecond = 1'000'000;  // [ns]
  constexpr int kSteps = 20;
  try {
    sim::Scenario scenario;
    scenario.crane = sim::load_machine_file(path);
    scenario.plant_step = kMillisecond;
    sim::CranePlant plant(sim::machine_settings(scenario),
                          {scenario.crane.parameters.drive.group_count, 0, 10 * kMillisecond});
    msgs::Torque torque{};
    torque.enable = 1;
    torque.group_count = scenario.crane.parameters.drive.group_count;
    torque.motor_torque.assign(static_cast<std::size_t>(torque.group_count), 50.0);  // [Nm]
    for (int i = 0; i < kSteps; ++i) {
      plant.begin_cycle(i);
      torque.answered_sequence = torque.alive_counter = i;
      plant.receive(msgs::DecodeStatus::ok, torque);
      plant.step({});
    }
    msgs::Truth truth{};
    plant.read_truth(truth);
    fuzz::require(truth.element_count >= 0 && truth.group_count == torque.group_count, "TRUTH is of this crane");
  } catch (const common::InputError&) {
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
