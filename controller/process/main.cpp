// slewlab-controller: the controller as a process on the bus. It answers until it is told to end (SIGTERM,
// SIGINT), which is its ordinary end: exit code 0. 1: the bus failed, 2: the call or the configuration is
// wrong.
//
// With --steered standard input says what an operator switches while it runs, a line each:
//   play_compensation on|off NANOSECONDS   from that simulated time on
// It is said again on standard output when it is known.

#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <sstream>

#include "common/launcher_lines.h"
#include "common/stop_signal.h"
#include "common/unknown_option.h"
#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "msgs/lcm_bus.h"

namespace slewlab::controller {
namespace {

struct Options {
  std::string config;
  std::string bus;
  double period_ms = 0.0;
  bool steered = false;
  std::vector<std::string> overrides;
};

// How long a signal may go unnoticed where it does not interrupt the wait.
constexpr std::chrono::milliseconds kWait{200};
// How long a line on standard input may go unnoticed.
constexpr std::chrono::milliseconds kSteeredWait{10};

void hear(common::LauncherLines& launcher, std::vector<PlaySwitch>& switched) {
  while (const auto line = launcher.next(std::chrono::milliseconds{0})) {
    std::istringstream words(*line);
    std::string what, state;
    PlaySwitch change;
    if (!(words >> what >> state >> change.time) || what != "play_compensation" || (state != "on" && state != "off")) {
      std::fprintf(stderr, "slewlab-controller: '%s': play_compensation on|off NANOSECONDS is wanted\n", line->c_str());
      continue;
    }
    change.enabled = state == "on";
    switched.push_back(change);
    std::printf("%s\n", line->c_str());
    std::fflush(stdout);
  }
}

int run(const Options& options) {
  std::vector<common::Override> overrides;
  for (const std::string& text : options.overrides) overrides.push_back(common::parse_override(text));
  ControllerSettings settings = load_controller_file(options.config, overrides).settings;
  settings.period = options.period_ms * 1e-3;

  common::catch_stop_signals();
  const auto bus = msgs::open_lcm_bus(options.bus);
  std::vector<PlaySwitch> switched;
  const AnswerLoop loop(*bus, computed_answer(settings, &switched));
  common::LauncherLines launcher;
  while (!common::stop_requested()) {
    bus->handle_one(options.steered ? kSteeredWait : kWait);
    if (options.steered) hear(launcher, switched);
  }
  return 0;
}

}  // namespace
}  // namespace slewlab::controller

int main(int argc, char** argv) {
  using namespace slewlab;
  CLI::App app{"The slewing controller as a process on the bus.", "slewlab-controller"};
  app.set_version_flag("--version", "slewlab-controller " SLEWLAB_VERSION, "version of slewlab");
  controller::Options options;
  app.add_option("--config", options.config, "controller file")->envname("SLEWLAB_CONTROLLER_CONFIG")->required();
  app.add_option("--bus", options.bus, "LCM address, e.g. " + msgs::bus_url(msgs::kDefaultPort))
      ->envname("SLEWLAB_BUS")
      ->required();
  app.add_option("--period-ms", options.period_ms, "time between two ENCODER messages [ms], as in the scenario")
      ->envname("SLEWLAB_CONTROLLER_PERIOD_MS")
      ->check(CLI::PositiveNumber)
      ->required();
  app.add_flag("--steered", options.steered, "with what an operator switches as lines on standard input");
  app.add_option("--set", options.overrides, "key=value over the file, e.g. ramp.curved_share=0.2");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return common::exit_code_of_refused("slewlab-controller", app, error, argc, argv);
  }
  try {
    return controller::run(options);
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const msgs::BusUrlError& error) {
    std::fprintf(stderr, "slewlab-controller: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-controller: %s\n", error.what());
    return 1;
  }
}
