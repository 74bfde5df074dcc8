// slewlab-controller: the controller as a process on the bus. It answers until it is told to end (SIGTERM,
// SIGINT), which is its ordinary end: exit code 0. 1: the bus failed, 2: the call or the configuration is
// wrong.

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "common/stop_signal.h"
#include "controller/controller_file.h"
#include "controller/process/answer_loop.h"
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

void copy_per_group(const PerGroup& from, int count, std::vector<double>& to) {
  to.assign(from.begin(), from.begin() + count);
}

int run(const Options& options) {
  std::vector<common::Override> overrides;
  for (const std::string& text : options.overrides) overrides.push_back(common::parse_override(text));
  ControllerSettings settings = load_controller_file(options.config, overrides).settings;
  settings.period = options.period_ms * 1e-3;
  ControllerState state;
  ControllerInput input;
  ControllerOutput output;
  const auto compute = [&](const msgs::Encoder& encoder, const msgs::Operator& operator_move, msgs::Torque& torque,
                           msgs::ControllerState& report) {
    input.simulated_time = encoder.simulated_time;
    // The pure controller knows what to do about a number of groups that is not its own.
    input.group_count = encoder.group_count;
    const int groups = std::min(encoder.group_count, kMaximumGroups);
    std::copy_n(encoder.shaft_speed.begin(), groups, input.shaft_speed.begin());
    input.speed_request = operator_move.speed_request;
    input.emergency_stop = operator_move.emergency_stop;
    input.acknowledge = operator_move.acknowledge;
    step(settings, state, input, output);
    torque.enable = output.enable;
    torque.brake = output.brake;
    torque.acknowledge = operator_move.acknowledge;
    torque.group_count = output.group_count;
    copy_per_group(output.motor_torque, output.group_count, torque.motor_torque);
    report.mode = static_cast<std::int8_t>(output.mode);
    report.ramped_speed = output.ramped_speed;
    report.average_torque = output.average_torque;
    report.offset_torque = output.offset_torque;
    report.group_count = output.group_count;
    copy_per_group(output.proportional_torque, output.group_count, report.proportional_torque);
    copy_per_group(output.integral_torque, output.group_count, report.integral_torque);
  };

  common::catch_stop_signals();
  const auto bus = msgs::open_lcm_bus(options.bus);
  const AnswerLoop loop(*bus, compute);
  while (common::stop_signal() == 0) bus->handle_one(kWait);
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
