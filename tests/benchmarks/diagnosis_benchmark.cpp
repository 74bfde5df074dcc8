// How long a diagnosis takes: two logs of 30 s, the whole catalogue and pairs, on two threads, beside the bare machine stepped over the
// same seconds.
//   build/release/bin/diagnosis_benchmark [OUT.json]
//
// Per case: wall and processor time, simulations, simulated seconds per second of wall; what a simulated second of the diagnosis takes of
// the processor against one of the nominal machine without effects, stepped alone in the same run; and the worst factor by which a
// forecast of the end was off.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/integrate/machine.h"
#include "tests/diagnosis/bench.h"

namespace {

using namespace slewlab;
using namespace slewlab::diagnosis;

constexpr double kRecordDuration = 30.0;  // [s]
constexpr int kMeasuredElements = 20;     // of the measured crane's boom: not the mesh that diagnoses

struct Case {
  std::string name;
  double period;  // [s] of controller and sensors
  bool has_noise;
  std::vector<common::EffectInstance> effects;
};

const std::vector<Case> kCases{
    {"nothing missing, 1 kHz", 1e-3, true, {}},
    {"torque_lag and load_mass, 1 kHz", 1e-3, true, {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}}},
    {"the same without noise, 1 kHz", 1e-3, false, {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}}},
    {"nothing missing, 100 Hz", 1e-2, true, {}},
    {"torque_lag and load_mass, 100 Hz", 1e-2, true, {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}}},
    {"the same without noise, 100 Hz", 1e-2, false, {{"torque_lag", {0.03, 0.2}}, {"load_mass", {1.3}}}},
};

double processor_seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

msgs::RunLog measured(const Case& one, const std::vector<Move>& moves, unsigned seed) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.crane.boom.element_count = kMeasuredElements;
  machine.effects = one.effects;
  if (one.has_noise) return simulated_log(machine, bench().controller, moves, kRecordDuration, seed, one.period);
  return quiet_log(machine, bench().controller, moves, kRecordDuration, one.period);
}

// [s] of the processor for a simulated second of the machine that fits begin with, stepped without a record.
double bare_cost(double step) {
  BenchProblem problem;
  sim::MachineSettings settings = with_boom_elements(problem.nominal, kBoomElements);
  settings.step = step;
  sim::Machine machine = sim::make_machine(settings);
  sim::DriveCommand command;
  const auto steps = static_cast<std::int64_t>(std::lround(20.0 * kRecordDuration / step));
  const double begun = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
  for (std::int64_t n = 0; n < steps; ++n) {
    const double torque = 60.0 * std::sin(step * static_cast<double>(n));  // [Nm] per motor
    command.motor_torque = {torque + 40.0, torque - 40.0};
    sim::step(machine, command);
  }
  return (processor_seconds(CLOCK_THREAD_CPUTIME_ID) - begun) / (step * static_cast<double>(steps));
}

nlohmann::json measure(const Case& one) {
  std::vector<Record> records;
  records.push_back(make_record(measured(one, kThereAndBack, 1), "a", bench().admission));
  records.push_back(make_record(measured(one, kInching, 2), "b", bench().admission));
  const double step = records.front().step;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  controller::ControllerSettings controller = bench().controller;
  controller.period = one.period;
  DiagnosisSettings settings;
  settings.threads = 2;
  Forecast forecast;
  std::vector<double> ends;  // [s] that were forecast

  const double bare = bare_cost(step);
  const double begun = wall_seconds(), begun_processor = processor_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const Diagnosis found = diagnose(nominal, controller, records, settings,
                                   [&](double share, const std::string&) {
                                     const double now = wall_seconds() - begun;
                                     forecast.tell(now, share);
                                     if (const std::optional<double> left = forecast.left()) ends.push_back(now + *left);
                                   });
  const double wall = wall_seconds() - begun, processor = processor_seconds(CLOCK_PROCESS_CPUTIME_ID) - begun_processor;

  double worst_forecast = 1.0;
  for (const double end : ends) worst_forecast = std::max({worst_forecast, end / wall, wall / end});
  const double simulated = kRecordDuration * static_cast<double>(found.simulations);
  return {{"case", one.name},
          {"verdict", found.verdict},
          {"wall_s", wall},
          {"processor_s", processor},
          {"simulations", found.simulations},
          {"simulated_s_per_s", simulated / wall},
          {"of_bare_machine", processor / simulated / bare},
          {"bare_step_ns", 1e9 * bare * step},
          {"worst_forecast", worst_forecast}};
}

}  // namespace

int main(int count, char** arguments) {
  nlohmann::json results = nlohmann::json::array();
  fmt::print("{:36} {:>7} {:>10} {:>12} {:>22} {:>18} {:>15}  {}\n", "two logs of 30 s, two threads", "wall", "processor", "simulations",
             "simulated s per s", "of a bare machine", "forecast within", "answer");
  for (const Case& one : kCases) {
    const nlohmann::json& row = results.emplace_back(measure(one));
    fmt::print("{:36} {:5.1f} s {:8.1f} s {:12} {:22.0f} {:18.2f} {:15.2f}  {}\n", one.name, row["wall_s"].get<double>(),
               row["processor_s"].get<double>(), row["simulations"].get<std::int64_t>(), row["simulated_s_per_s"].get<double>(),
               row["of_bare_machine"].get<double>(), row["worst_forecast"].get<double>(), row["verdict"].get<std::string>());
  }
  if (count > 1) std::ofstream(arguments[1]) << results.dump(2) << "\n";
}
