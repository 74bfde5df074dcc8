// What the functions of FMI add to a step of the plant: setting the inputs, a communication step of one plant step, getting shaft speeds
// and positions, against the same plant behind its drive called directly. Prints both and the difference [ns per step].
//   build/release/bin/fmu_benchmark
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/drive/crane_plant.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_tree.h"
#include "tools/fmu/fmi/fmi2Functions.h"
#include "tools/fmu/plant_unit.h"

namespace {

using namespace slewlab;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr int kSteps = 1'000'000, kRounds = 5;
constexpr double kStep = 0.001;  // [s]

double torque_at(int k) { return (k / 2000) % 2 == 0 ? 60.0 : -60.0; }  // [Nm] to and fro over the backlash

double nanoseconds_since(Clock::time_point begin) { return std::chrono::duration<double, std::nano>(Clock::now() - begin).count() / kSteps; }

double direct(const tools::fmu::UnitFile& file) {
  sim::MachineSettings settings = sim::machine_settings(sim::machine_of(file.root));
  settings.step = kStep;
  const int groups = settings.crane.drive.group_count;
  sim::CranePlant plant(settings, {groups, 0, 1'000'000, 0});
  msgs::Torque torque{};
  torque.group_count = groups;
  torque.enable = true;
  torque.motor_torque.resize(static_cast<std::size_t>(groups));
  msgs::Encoder encoder{};
  const auto begin = Clock::now();
  for (int k = 0; k < kSteps; ++k) {
    torque.sequence = torque.answered_sequence = torque.alive_counter = k;
    for (double& value : torque.motor_torque) value = torque_at(k);
    plant.begin_cycle(k);
    plant.receive(msgs::DecodeStatus::ok, torque);
    plant.step({});
    plant.read_encoder(encoder);
  }
  return nanoseconds_since(begin);
}

double through_fmi(const tools::fmu::UnitFile& file, const fs::path& folder) {
  const fmi2CallbackFunctions callbacks{};
  const fmi2Component plant = fmi2Instantiate("plant", fmi2CoSimulation, tools::fmu::token_of(file).c_str(), ("file://" + folder.string()).c_str(),
                                              &callbacks, fmi2False, fmi2False);
  if (plant == nullptr) return 0.0;
  fmi2EnterInitializationMode(plant);
  fmi2ExitInitializationMode(plant);
  const auto unit = tools::fmu::make_plant_unit(file);
  std::vector<fmi2ValueReference> torques, switches, asked;
  for (std::size_t i = 0; i < unit->variables().size(); ++i) {
    const tools::fmu::Variable& variable = unit->variables()[i];
    const auto reference = static_cast<fmi2ValueReference>(i + 1);
    if (variable.name.starts_with("motor_torque")) torques.push_back(reference);
    if (variable.type == FMU_BOOLEAN) switches.push_back(reference);
    if (variable.name.starts_with("shaft_")) asked.push_back(reference);
  }
  std::vector<double> said(torques.size()), answer(asked.size());
  const fmi2Boolean on[] = {fmi2True, fmi2False, fmi2False};
  const auto begin = Clock::now();
  for (int k = 0; k < kSteps; ++k) {
    for (double& value : said) value = torque_at(k);
    fmi2SetReal(plant, torques.data(), torques.size(), said.data());
    fmi2SetBoolean(plant, switches.data(), switches.size(), on);
    if (fmi2DoStep(plant, kStep * k, kStep, fmi2True) != fmi2OK) return 0.0;
    fmi2GetReal(plant, asked.data(), asked.size(), answer.data());
  }
  const double each = nanoseconds_since(begin);
  fmi2FreeInstance(plant);
  return each;
}

}  // namespace

int main() {
  common::InputProblems problems;
  tools::fmu::UnitFile file;
  file.root = common::load_yaml_file(fs::path(SLEWLAB_SOURCE_DIR) / "config/cranes/thesis.yaml", {}, problems);
  file.period = 1'000'000;
  file.text = tools::fmu::unit_text(file);
  const fs::path folder = fs::temp_directory_path() / ("slewlab_fmu_benchmark_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / tools::fmu::kUnitFileName) << file.text;
  double least_direct = 1e18, least_fmi = 1e18;
  for (int round = 0; round < kRounds; ++round) {
    least_direct = std::min(least_direct, direct(file));
    least_fmi = std::min(least_fmi, through_fmi(file, folder));
  }
  fs::remove_all(folder);
  std::printf("plant step called directly: %.0f ns, through FMI 2: %.0f ns, overhead %.0f ns per step (least of %d rounds)\n", least_direct,
              least_fmi, least_fmi - least_direct, kRounds);
  return 0;
}
