#include "tools/python/core/recorded_run.h"

#include <optional>
#include <string>

#include "common/input_error.h"
#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "msgs/log_writer.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/scenario_run.h"

namespace slewlab::tools {
namespace {

void keep(RecordedChannel& channel, std::size_t index, msgs::Bytes message) {
  const msgs::WireMessage& wire = msgs::wire_messages()[index];
  msgs::ArrayCounts counts{};
  if (msgs::check(message, wire.fingerprint, wire.pieces, counts) != msgs::DecodeStatus::ok) {
    ++channel.left_out;
    return;
  }
  if (channel.row_count == 0) {
    channel.layout = msgs::row_layout(index, counts);
    channel.counts = counts;
  } else if (counts != channel.counts) {
    ++channel.left_out;
    return;
  }
  msgs::append_row(channel.layout, message, channel.rows);
  ++channel.row_count;
}

}  // namespace

controller::Compute scenario_controller(const sim::Scenario& scenario) {
  controller::ControllerSettings settings =
      controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
  const int groups = scenario.crane.parameters.drive.group_count;
  if (settings.group_count != groups) {
    throw common::InputError({{{scenario.controller_file.string(), 0, 0}, "groups", std::to_string(settings.group_count),
                               "the machine's " + std::to_string(groups)}});
  }
  settings.period = static_cast<double>(scenario.controller_period) * 1e-9;
  return controller::computed_answer(settings);
}

RecordedRun record_run(const sim::Scenario& scenario, const diagnosis::NewController& controller, const RecordedRunOptions& options) {
  RecordedRun run;
  const sim::LockstepSettings settings = sim::lockstep_settings(scenario);
  sim::CranePlant plant(sim::machine_settings(scenario), sim::drive_run(scenario));
  std::optional<msgs::LogWriter> log;
  if (!options.log.empty()) log.emplace(options.log);
  const sim::LogSink sink = [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) {
    if (log) log->append(channel, timestamp_us, bytes);
    const std::optional<std::size_t> index = msgs::channel_index(channel);
    if (index && options.keep[*index]) keep(run.channels[*index], *index, bytes);
  };
  bool stopped = false;
  sim::LockstepHooks hooks;
  hooks.stop = [&] { return stopped = stopped || (options.stop && options.stop()); };
  const diagnosis::WireLoopResult result = diagnosis::run_wire_loop(settings, controller, plant, sink, hooks);
  if (log && !stopped && !result.controller_is_dead) log->finish();
  run.counts = result.counts;
  run.controller_is_dead = result.controller_is_dead;
  return run;
}

}  // namespace slewlab::tools
