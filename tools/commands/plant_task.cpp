#include "tools/commands/plant_task.h"

#include <fmt/format.h>

#include <stdexcept>

#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "msgs/run_identity.h"
#include "msgs/run_log.h"
#include "sim/drive/scenario_run.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kNanosecondsPerSecond = 1e9;

double seconds(std::int64_t time) { return static_cast<double>(time) / kNanosecondsPerSecond; }

}  // namespace

std::string why_not_by_another_plant(const sim::Scenario& scenario) {
  if (!scenario.faults.empty()) return "it has faults on purpose (faults:), which slewlab's own plant alone makes";
  if (!scenario.effect_switches.empty()) return "it switches effects while it runs, which slewlab's own plant alone has";
  if (!scenario.motion_requests.empty()) {
    return "it hoists, luffs or travels (hoisting_request, luffing_request, travelling_request), which OPERATOR does not carry and slewlab's own plant alone does";
  }
  return {};
}

fs::path write_plant_task(const fs::path& folder, const sim::Scenario& scenario, const std::string& bus, const fs::path& log) {
  const sim::LockstepSettings settings = sim::lockstep_settings(scenario);
  Json moves = Json::array();
  for (const sim::OperatorMove& move : scenario.moves) {
    moves.push_back({{"time_ns", move.time},
                     {"speed_request", move.speed_request},
                     {"emergency_stop", move.emergency_stop},
                     {"acknowledge", move.acknowledge}});
  }
  const Json task{{"bus", bus},
                  {"log", fs::absolute(log).string()},
                  {"machine", fs::absolute(folder / (std::string(sim::name_of(scenario.crane.kind)) + ".yaml")).string()},
                  {"group_count", scenario.crane.parameters.drive.group_count},
                  {"configuration_hash", settings.configuration_hash},
                  {"run_identity", settings.run_identity},
                  {"duration_ns", scenario.duration},
                  {"controller_period_ns", scenario.controller_period},
                  {"plant_step_ns", scenario.plant_step},
                  {"sensors_period_ns", scenario.sensors_period},
                  {"truth_period_ns", scenario.truth_period},
                  {"status_period_ns", scenario.status_period},
                  {"operator", moves}};
  const fs::path path = folder / kPlantTaskName;
  write_whole_file(path, task.dump(2) + "\n");
  return path;
}

Json own_plant_summary(const fs::path& log, const sim::Scenario& scenario) {
  const auto refuse = [&](const std::string& why) -> std::runtime_error {
    return std::runtime_error(fmt::format("the plant's log {} is not that of this run: {}", log.string(), why));
  };
  if (!fs::exists(log)) throw refuse("it was not written");
  const std::int64_t hash = msgs::configuration_hash(scenario.configuration_text);
  msgs::RunLogs logs;
  try {
    logs = msgs::read_run_logs(log);
  } catch (const msgs::LogError& error) {
    throw refuse(error.what());
  }
  if (logs.lost_bytes > 0 || logs.lost_messages > 0) {
    throw refuse(logs.remarks.empty() ? "a part of it cannot be used" : logs.remarks.front());
  }
  if (logs.runs.size() != 1) throw refuse(fmt::format("it holds {} runs, expected one", logs.runs.size()));
  const msgs::RunLog& run = logs.runs.front();
  if (run.configuration_hash != hash || run.run_identity != msgs::run_identity(hash)) {
    throw refuse("its messages carry another configuration_hash or run_identity than plant_task.json says");
  }
  const std::int64_t cycles = (scenario.duration + scenario.controller_period - 1) / scenario.controller_period;
  if (static_cast<std::int64_t>(run.encoder.size()) != cycles) {
    throw refuse(fmt::format("it holds {} ENCODER, expected one for each of the {} controller periods", run.encoder.size(), cycles));
  }
  for (std::size_t k = 0; k < run.encoder.size(); ++k) {
    const msgs::Encoder& encoder = run.encoder[k];
    if (encoder.sequence != static_cast<std::int64_t>(k) || encoder.simulated_time != encoder.sequence * scenario.controller_period) {
      throw refuse(fmt::format("ENCODER {} speaks of {} s, expected {} s", encoder.sequence, seconds(encoder.simulated_time),
                               seconds(static_cast<std::int64_t>(k) * scenario.controller_period)));
    }
    if (k >= run.torque.size() || run.torque[k].answered_sequence != encoder.sequence) {
      throw refuse(fmt::format("there is no TORQUE that answers the ENCODER of {} s", seconds(encoder.simulated_time)));
    }
  }
  if (run.operator_moves.empty()) throw refuse("it holds no OPERATOR, expected one before the first ENCODER");
  return {{"complete", true},
          {"configuration_hash", msgs::hash_text(hash)},
          {"run_identity", msgs::hash_text(run.run_identity)},
          {"simulated_seconds", seconds(scenario.duration)},
          {"lockstep_cycles", cycles},
          {"log_bytes", fs::file_size(log)},
          {"log_digest", msgs::hash_text(msgs::log_digest(log))}};
}

}  // namespace slewlab::tools
