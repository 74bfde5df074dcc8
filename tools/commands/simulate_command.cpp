#include "tools/commands/simulate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "msgs/configuration_hash.h"
#include "msgs/log_writer.h"
#include "sim/drive/scenario_run.h"
#include "tools/commands/log_path.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/run_facts.h"
#include "tools/commands/whole_file.h"
#include "tools/replay/open_loop.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

// In the order of the wire: OPERATOR before the ENCODER that names it, the TORQUE that answers, SENSORS of that instant.
void write_log(const fs::path& path, const msgs::RunLog& run) {
  msgs::LogWriter writer(path);
  std::vector<std::uint8_t> bytes;
  const auto write = [&](const char* channel, const auto& message) {
    msgs::encode(message, bytes);
    writer.append(channel, message.simulated_time / 1000, bytes);
  };
  auto move = run.operator_moves.begin();
  auto torque = run.torque.begin();
  auto sensors = run.sensors.begin();
  for (const msgs::Encoder& encoder : run.encoder) {
    for (; move != run.operator_moves.end() && move->simulated_time <= encoder.simulated_time; ++move) write(msgs::kOperatorChannel, *move);
    write(msgs::kEncoderChannel, encoder);
    for (; torque != run.torque.end() && torque->answered_sequence <= encoder.sequence; ++torque) write(msgs::kTorqueChannel, *torque);
    for (; sensors != run.sensors.end() && sensors->simulated_time <= encoder.simulated_time; ++sensors) write(msgs::kSensorsChannel, *sensors);
  }
  writer.finish();
}

msgs::RunLogs runs_of(const fs::path& log) {
  try {
    return msgs::read_run_logs(log);
  } catch (const msgs::LogError& error) {
    throw no_log(log, error);
  }
}

}  // namespace

int simulate(const SimulateOptions& options, std::ostream& out) {
  const sim::MachineFile machine = sim::load_machine_file(options.machine, options.overrides);
  const fs::path log = log_in(options.log);
  const msgs::RunLogs logs = runs_of(log);
  const auto record = std::max_element(logs.runs.begin(), logs.runs.end(),
                                       [](const msgs::RunLog& a, const msgs::RunLog& b) { return a.encoder.size() < b.encoder.size(); });
  for (const std::string& remark : logs.remarks) out << log.string() << ": " << remark << '\n';
  if (logs.runs.size() > 1) out << fmt::format("{}: holds {} runs; used is the longest one\n", log.string(), logs.runs.size());

  const std::int64_t hash = msgs::configuration_hash("open loop\n" + machine.canonical_text + "\nrecord " + msgs::hash_text(record->configuration_hash));
  const OpenLoopRun simulated = simulate_open_loop(machine, sim::machine_settings(machine).effects, *record, options.longest_step, hash);
  for (const std::string& remark : simulated.remarks) out << "note: " << remark << '\n';

  make_output_folder(options.out);
  remove_earlier_run(options.out);
  write_log(options.out / "run.lcmlog", simulated.run);
  constexpr double kNanosecondsPerSecond = 1e9;
  const double duration = static_cast<double>(record->encoder.back().simulated_time - record->encoder.front().simulated_time) / kNanosecondsPerSecond;
  nlohmann::ordered_json facts;
  facts[std::string(sim::name_of(machine.kind))] = options.machine.lexically_normal().string();
  facts["configuration_hash"] = msgs::hash_text(hash);
  facts["open_loop"] = {{"record", log.lexically_normal().string()}, {"record_hash", msgs::hash_text(record->configuration_hash)}};
  facts["rated_torque"] = machine.parameters.drive.rated_torque;
  facts["total_ratio"] = machine_facts(machine)["ratio"];
  facts["machine"] = machine_facts(machine);
  facts["plant_step"] = simulated.step;
  facts["duration"] = duration;
  facts["end"] = "complete";
  write_whole_file(options.out / kRunFactsName, facts.dump(2) + "\n");
  out << fmt::format("{}: {:.6g} s open loop at a plant step of {:.6g} ms, {} ENCODER\n", (options.out / "run.lcmlog").string(), duration,
                     1e3 * simulated.step, simulated.run.encoder.size());
  out << fmt::format("against the record: slewlab report {} {}\n", options.out.string(), options.log.string());
  return 0;
}

}  // namespace slewlab::tools
