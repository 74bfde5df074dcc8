// slewlab-plant: the crane as a process on the bus, in lockstep with whatever controller answers, and the writer of
// the run's log.
//
// On standard output, one line each, for the launcher and for people:
//   progress SIMULATED_SECONDS OF_SECONDS RESENDS
//   summary {...}        JSON, once, at the end of a run whether complete or stopped
//   controller kill      a fault on purpose: kill the controller now and say so by a line on standard input
//   controller start     the same for starting it anew
// Exit codes: 0 complete, 1 the run failed, 2 the call or the configuration is wrong, 128 + signal when stopped.

#include <CLI/CLI.hpp>

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/stop_signal.h"
#include "msgs/configuration_hash.h"
#include "msgs/lcm_bus.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_run.h"
#include "sim/scenario_file.h"

namespace slewlab::sim {
namespace {

using WallClock = std::chrono::steady_clock;

constexpr double kNanosecondsPerSecond = 1e9;
constexpr std::chrono::milliseconds kProgressInterval{100};

struct Options {
  std::string scenario;
  std::string bus;
  std::string log;
  std::vector<std::string> overrides;
};

nlohmann::ordered_json drive_summary(const DriveProtectionState& drive) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::object();
  for (int i = 1; i < kDriveFaultCount; ++i) faults[name_of(static_cast<DriveFault>(i))] = drive.faults[i];
  return {{"state", name_of(drive.state)},
          {"trip_cause", name_of(drive.trip_cause)},
          {"trips", drive.trips},
          {"stale_commands", drive.stale_commands},
          {"faults", faults}};
}

void print_progress(const LockstepCounts& counts, const LockstepSettings& settings) {
  std::printf("progress %.3f %.3f %lld\n", static_cast<double>(counts.simulated_time) / kNanosecondsPerSecond,
              static_cast<double>(settings.duration) / kNanosecondsPerSecond, static_cast<long long>(counts.resends));
  std::fflush(stdout);
}

// Returns when the launcher has done it, or where there is none.
void ask_launcher(ControllerAction action) {
  std::printf("controller %s\n", action == ControllerAction::kill ? "kill" : "start");
  std::fflush(stdout);
  char letter = 0;
  while (letter != '\n' && common::stop_signal() == 0) {
    const ssize_t count = ::read(STDIN_FILENO, &letter, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count == 1) continue;
    std::fprintf(stderr, "slewlab-plant: nobody here to kill or start the controller; it is not asked instead\n");
    return;
  }
}

int run(const Options& options) {
  std::vector<common::Override> overrides;
  for (const std::string& text : options.overrides) overrides.push_back(common::parse_override(text));
  const Scenario scenario = load_scenario_file(options.scenario, overrides);
  const LockstepSettings settings = lockstep_settings(scenario);
  CranePlant plant(machine_settings(scenario), scenario.crane.drive_protection, drive_run(scenario));
  const auto bus = msgs::open_lcm_bus(options.bus);
  msgs::LogWriter log(options.log);

  common::catch_stop_signals();
  const WallClock::time_point begin = WallClock::now();
  WallClock::time_point next_progress = begin;
  const auto show_progress = [&](const LockstepCounts& counts) {
    if (WallClock::now() < next_progress) return;
    next_progress = WallClock::now() + kProgressInterval;
    log.flush();  // what is shown as done survives the death of this process
    print_progress(counts, settings);
  };
  LockstepHooks hooks;
  hooks.stop = [] { return common::stop_signal() != 0; };
  // Looking at the clock in every cycle would cost as much as the plant's step does.
  hooks.after_cycle = [&](const LockstepCounts& counts) {
    if (counts.cycles % 64 == 0) show_progress(counts);
  };
  hooks.while_waiting = show_progress;
  hooks.controller_action = ask_launcher;

  print_progress({}, settings);
  const LockstepCounts counts = run_lockstep(settings, plant, *bus, log, hooks);
  const double wall_seconds = std::chrono::duration<double>(WallClock::now() - begin).count();
  print_progress(counts, settings);
  const bool complete = counts.simulated_time >= settings.duration;
  if (complete) {
    log.finish();
  } else {
    log.flush();
  }

  const double simulated_seconds = static_cast<double>(counts.simulated_time) / kNanosecondsPerSecond;
  const nlohmann::ordered_json summary{
      {"complete", complete},
      {"configuration_hash", msgs::hash_text(settings.configuration_hash)},
      {"simulated_seconds", simulated_seconds},
      {"wall_seconds", wall_seconds},
      {"rate_against_real_time", simulated_seconds / wall_seconds},
      {"lockstep_cycles", counts.cycles},
      {"lockstep_cycles_per_second", static_cast<double>(counts.cycles) / wall_seconds},
      {"resends", counts.resends},
      {"stale_answers", counts.stale_answers},
      {"wrong_answers", counts.wrong_answers},
      {"drive", drive_summary(plant.drive())},
      {"log_events", log.event_count()},
      {"log_bytes", log.byte_count()}};
  std::printf("summary %s\n", summary.dump().c_str());
  std::fflush(stdout);
  if (complete) return 0;
  std::fprintf(stderr, "slewlab-plant: stopped by signal %d at %.3f s of simulated time\n", common::stop_signal(),
               simulated_seconds);
  return 128 + common::stop_signal();
}

}  // namespace
}  // namespace slewlab::sim

int main(int argc, char** argv) {
  using namespace slewlab;
  CLI::App app{"The simulated crane as a process on the bus, in lockstep with a controller."};
  sim::Options options;
  app.add_option("--scenario", options.scenario, "scenario file")->required();
  app.add_option("--bus", options.bus, "LCM address, e.g. " + msgs::bus_url(msgs::kDefaultPort))
      ->envname("SLEWLAB_BUS")
      ->required();
  app.add_option("--log", options.log, "log to write; NAME.partial until it is complete")->required();
  app.add_option("--set", options.overrides, "key=value over the files, e.g. crane.load.mass=20");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return sim::run(options);
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-plant: %s\n", error.what());
    return 1;
  }
}
