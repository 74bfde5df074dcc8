// slewlab-effect-signatures CRANE.yaml CONTROLLER.yaml: what every effect of the catalogues, at its typical
// size, changes on a slew to one side and back, as one line of JSON per effect. The pages of docs/effects
// quote it.
//
// Per signal: "gap", the root mean square of the change over that of the signal itself (mean removed), and
// "bands", the shares of the change's power below 0.3 Hz, to 2, to 8 and above 8 Hz.
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/loop/loop.h"
#include "sim/analysis/spectrum.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_file.h"
#include "sim/effects/catalogue.h"

namespace {

using namespace slewlab;

constexpr double kStep = 0.001;                             // [s]
constexpr int kStepsPerCycle = 10;                          // a controller of 100 Hz
constexpr double kDuration = 60.0;                          // [s]
constexpr std::array<double, 3> kBandEdges{0.3, 2.0, 8.0};  // [Hz]
constexpr double kHighest = 200.0;                          // [Hz]

constexpr std::array<const char*, 8> kSignals{"torque sum",         "torque difference",   "shaft speed",
                                              "house acceleration", "middle acceleration", "tip acceleration",
                                              "shaft difference",   "slew angle"};
using Series = std::array<std::vector<double>, kSignals.size()>;

std::vector<sim::OperatorMove> slew_there_and_back() {
  constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
  return {{.time = 1 * kSecond, .speed_request = 0.8},
          {.time = 16 * kSecond, .speed_request = 0.0},
          {.time = 28 * kSecond, .speed_request = -0.8},
          {.time = 43 * kSecond, .speed_request = 0.0}};
}

Series simulate(const sim::MachineSettings& nominal, const controller::ControllerSettings& controller,
                const std::vector<common::EffectInstance>& effects) {
  diagnosis::LoopSettings settings;
  settings.machine = nominal;
  settings.machine.effects.insert(settings.machine.effects.end(), effects.begin(), effects.end());
  settings.controller = controller;
  settings.operator_moves = slew_there_and_back();
  settings.duration = kDuration - kStep;  // kDuration / kStep instants
  diagnosis::MachineLoop loop(settings);
  Series series;
  diagnosis::LoopHooks hooks;
  hooks.instant = [&](const diagnosis::LoopMoment&) {
    const sim::MachineReadings readings = sim::read(loop.plant.machine());
    const std::vector<double>& torque = loop.controller.torque().motor_torque;
    const auto last = torque.size() - 1;
    series[0].push_back(torque[0] + torque[last]);
    series[1].push_back(torque[0] - torque[last]);
    series[2].push_back(readings.shaft_speed[0]);
    series[3].push_back(readings.house_acceleration);
    series[4].push_back(readings.middle_acceleration);
    series[5].push_back(readings.tip_acceleration);
    series[6].push_back(readings.shaft_position[0] - readings.shaft_position[last]);
    series[7].push_back(readings.slew_angle);
  };
  loop.run(hooks);
  return series;
}

double deviation(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double square = 0.0;
  for (const double value : values) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(values.size()));
}

double root_mean_square(const std::vector<double>& values) {
  double square = 0.0;
  for (const double value : values) square += value * value;
  return std::sqrt(square / static_cast<double>(values.size()));
}

nlohmann::json compare(const Series& with, const Series& without) {
  nlohmann::json signals;
  for (std::size_t s = 0; s < kSignals.size(); ++s) {
    std::vector<double> change = with[s];
    for (std::size_t k = 0; k < change.size(); ++k) change[k] -= without[s][k];
    std::array<double, kBandEdges.size() + 1> power{};
    double whole = 0.0;
    for (std::size_t b = 0; b < power.size(); ++b) {
      const double from = b == 0 ? 0.0 : kBandEdges[b - 1];
      const double to = b < kBandEdges.size() ? kBandEdges[b] : kHighest;
      const double rms = sim::band_rms(change, kStep, from, to);
      whole += power[b] = rms * rms;
    }
    for (double& share : power) share = whole > 0.0 ? share / whole : 0.0;
    signals[kSignals[s]] = {{"gap", root_mean_square(change) / deviation(without[s])}, {"bands", power}};
  }
  return signals;
}

nlohmann::json describe(const common::EffectAbout& about) {
  nlohmann::json rows = nlohmann::json::array();
  for (const common::EffectParameter& parameter : about.parameters) {
    rows.push_back(common::parameter_row(parameter));
  }
  return {{"name", about.name},
          {"subsystem", common::name_of(about.subsystem)},
          {"physics", about.physics},
          {"rows", rows}};
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App app("What every effect changes on a slew to one side and back, one line of JSON per effect.");
  std::string crane_file, controller_file;
  app.add_option("crane", crane_file, "crane file")->required();
  app.add_option("controller", controller_file, "controller file")->required();
  CLI11_PARSE(app, count, arguments);
  try {
    sim::MachineSettings machine = sim::machine_settings(sim::load_machine_file(crane_file));
    machine.step = kStep;
    machine.seed = 1;
    controller::ControllerSettings settings = controller::load_controller_file(controller_file).settings;
    settings.period = kStep * kStepsPerCycle;
    const Series nominal = simulate(machine, settings, {});
    const common::EffectCatalogue of_machine = sim::effects_for(machine);
    for (const sim::EffectDescription* effect : sim::effect_catalogue()) {
      nlohmann::json line = describe(effect->about);
      const common::EffectAbout* about = of_machine.find(effect->about.name);
      if (about == nullptr) continue;  // does not suit the machine
      line["signals"] = compare(simulate(machine, settings, {common::typical_instance(*about)}), nominal);
      std::printf("%s\n", line.dump().c_str());
    }
    const common::EffectCatalogue of_controller = controller::effects_for(settings);
    for (const controller::ControllerEffect* effect : controller::effect_catalogue()) {
      nlohmann::json line = describe(effect->about);
      const auto changed = controller::with_effects(settings, {common::typical_instance(of_controller.at(effect->about.name))});
      line["signals"] = compare(simulate(machine, changed, {}), nominal);
      std::printf("%s\n", line.dump().c_str());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
