// slewlab-controller: the controller as a process on the bus. It answers until it is told to end (SIGTERM,
// SIGINT), which is its ordinary end: exit code 0. 1: the bus failed, 2: the call or the configuration is
// wrong.

#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>

#include "common/stop_signal.h"
#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "msgs/lcm_bus.h"

namespace slewlab::controller {
namespace {

struct Options {
  std::string config;
  std::string bus;
  double period_ms = 0.0;
  std::vector<std::string> overrides;
};

// How long a signal may go unnoticed where it does not interrupt the wait.
constexpr std::chrono::milliseconds kWait{200};

int run(const Options& options) {
  std::vector<common::Override> overrides;
  for (const std::string& text : options.overrides) overrides.push_back(common::parse_override(text));
  ControllerSettings settings = load_controller_file(options.config, overrides).settings;
  settings.period = options.period_ms * 1e-3;

  common::catch_stop_signals();
  const auto bus = msgs::open_lcm_bus(options.bus);
  const AnswerLoop loop(*bus, computed_answer(settings));
  while (!common::stop_requested()) bus->handle_one(kWait);
  return 0;
}

}  // namespace
}  // namespace slewlab::controller

int main(int argc, char** argv) {
  using namespace slewlab;
  CLI::App app{"The slewing controller as a process on the bus."};
  controller::Options options;
  app.add_option("--config", options.config, "controller file")->envname("SLEWLAB_CONTROLLER_CONFIG")->required();
  app.add_option("--bus", options.bus, "LCM address, e.g. " + msgs::bus_url(msgs::kDefaultPort))
      ->envname("SLEWLAB_BUS")
      ->required();
  app.add_option("--period-ms", options.period_ms, "time between two ENCODER messages [ms], as in the scenario")
      ->envname("SLEWLAB_CONTROLLER_PERIOD_MS")
      ->check(CLI::PositiveNumber)
      ->required();
  app.add_option("--set", options.overrides, "key=value over the file, e.g. ramp.curved_share=0.2");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return controller::run(options);
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-controller: %s\n", error.what());
    return 1;
  }
}
