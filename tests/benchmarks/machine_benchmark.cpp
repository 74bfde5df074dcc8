// The machine's step without effects against the bare plant's, and what each running effect adds.
//   build/release/bin/machine_benchmark --benchmark_repetitions=5
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "tests/sim/thesis_crane.h"

namespace {

using namespace slewlab::sim;

// A swing that crosses the play; [Nm] per motor.
double torque_at(std::int64_t k) { return 100.0 * std::sin(1e-3 * static_cast<double>(k)); }

void bare_plant(benchmark::State& state) {
  const PlantModel model = make_plant_model(thesis_crane(), 0.001);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState plant = make_plant_state(model);
  std::int64_t k = 0;
  for (auto _ : state) {
    PlantInput input;
    const double torque = torque_at(k++);
    input.motor_torque = {torque + 40.0, torque - 40.0};
    step(model, workspace, input, plant);
    benchmark::ClobberMemory();  // DoNotOptimize of 1.7.1 spoils doubles it is given
  }
}

void machine(benchmark::State& state, const std::vector<slewlab::common::EffectInstance>& effects) {
  Machine machine = make_machine({.crane = thesis_crane(), .effects = effects});
  std::int64_t k = 0;
  for (auto _ : state) {
    DriveCommand command;
    const double torque = torque_at(k);
    command.sequence = k++ / 10;
    command.motor_torque = {torque + 40.0, torque - 40.0};
    step(machine, command);
    benchmark::ClobberMemory();
  }
}

}  // namespace

int main(int count, char** arguments) {
  benchmark::RegisterBenchmark("bare_plant", bare_plant);
  benchmark::RegisterBenchmark("machine_without_effects", [](benchmark::State& state) { machine(state, {}); });
  const slewlab::common::EffectCatalogue catalogue = effects_for(thesis_crane());
  for (const EffectDescription* effect : effect_catalogue()) {
    if (effect->start == nullptr) continue;
    const auto instance = slewlab::common::typical_instance(catalogue.at(effect->about.name));
    benchmark::RegisterBenchmark(("machine_with/" + instance.name).c_str(),
                                 [instance](benchmark::State& state) { machine(state, {instance}); });
  }
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
