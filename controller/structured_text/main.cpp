// slewlab-st-host: a program compiled from Structured Text as a process on the bus (docs/structured_text.md). It answers until it is
// told to end (SIGTERM, SIGINT): exit code 0. 1: the bus failed, 2: the call or the library is wrong.

#include <CLI/CLI.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "common/stop_signal.h"
#include "common/unknown_option.h"
#include "controller/structured_text/st_answer.h"
#include "msgs/lcm_bus.h"

int main(int argc, char** argv) {
  using namespace slewlab;
  constexpr std::chrono::milliseconds kWait{200};  // for which a signal may go unnoticed where it does not interrupt the wait
  CLI::App app{"A program compiled from Structured Text as the controller on the bus.", "slewlab-st-host"};
  app.set_version_flag("--version", "slewlab-st-host " SLEWLAB_VERSION, "version of slewlab");
  std::string library, address;
  double period_ms = 0.0;
  app.add_option("LIBRARY", library, "shared library with the functions of controller/structured_text/st_program.h")->required();
  app.add_option("--bus", address, "LCM address")->envname("SLEWLAB_BUS")->required();
  app.add_option("--period-ms", period_ms, "time between two ENCODER messages [ms], as in the scenario")
      ->envname("SLEWLAB_CONTROLLER_PERIOD_MS")
      ->check(CLI::PositiveNumber)
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return common::exit_code_of_refused("slewlab-st-host", app, error, argc, argv);
  }
  constexpr double kNanosecondsPerMillisecond = 1e6;
  const std::int64_t period = std::llround(period_ms * kNanosecondsPerMillisecond);
  std::shared_ptr<const controller::StProgram> program;
  try {
    program = std::make_shared<const controller::StProgram>(library);
    program->start(period);  // what is wrong is said before anything runs
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-st-host: %s\n", error.what());
    return 2;
  }
  try {
    common::catch_stop_signals();
    const auto bus = msgs::open_lcm_bus(address);
    const controller::AnswerLoop loop(*bus, controller::st_answer(program, period));
    while (!common::stop_requested()) bus->handle_one(kWait);
    return 0;
  } catch (const msgs::BusUrlError& error) {
    std::fprintf(stderr, "slewlab-st-host: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-st-host: %s\n", error.what());
    return 1;
  }
}
