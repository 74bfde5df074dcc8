#include "tools/commands/replay_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "common/input_error.h"
#include "common/yaml_node.h"
#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "msgs/configuration_hash.h"
#include "msgs/lcm_bus.h"
#include "msgs/memory_bus.h"
#include "msgs/run_stream.h"
#include "sim/drive/scenario_file.h"
#include "tools/acceptance/run_summary.h"
#include "tools/commands/child_process.h"
#include "tools/commands/home.h"
#include "tools/commands/log_path.h"
#include "tools/commands/plant_task.h"
#include "tools/commands/private_network.h"
#include "tools/replay/comparison.h"
#include "tools/replay/controller_replay.h"
#include "tools/replay/plant_replay.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using Comparison = std::vector<ChannelComparison>;

constexpr double kNanosecondsPerSecond = 1e9;
constexpr std::int64_t kUsualPlantStep = 1'000'000;  // [ns], of a log that came without a scenario
constexpr std::int64_t kShortestPlantStep = 10'000;  // [ns] chosen: a hundredth of the usual one
constexpr std::chrono::seconds kSilence{3};          // wall clock, until a controller that does not answer is told of

// What cannot be done as asked: exit code 2.
class BadCall : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

bool is_ours(const ReplayOptions& options) { return options.controller_command.empty() && options.controller_fmu.empty(); }

struct Configuration {
  std::optional<sim::Scenario> scenario;         // without one the periods are the log's
  std::optional<std::int64_t> hash;              // of the files as they are, without what the call changes
  std::optional<sim::MachineFile> crane;
  std::optional<controller::ControllerSettings> controller;
};

// Whether the key is `section` or stands in it.
bool is_in(std::string_view section, const std::string& key) {
  return key.starts_with(section) && (key.size() == section.size() || key[section.size()] == '.');
}

// What would be right in place of a setting of this key; empty where it has an effect.
std::string expected_of_setting(const std::string& key, const ReplayOptions& options, const Configuration& files) {
  if (!files.scenario) return files.crane && is_ours(options) ? "" : "none without a scenario and a machine: name a file with other values by --controller-config";
  const char* const of_machine = "a key of the scenario's periods or, with crane., axis. or controller. before it, of one of those files";
  for (const char* section : {"duration", "expect", "description"}) {
    if (is_in(section, key)) return std::string(of_machine) + ": a replay is as long as its log and judges nothing else";
  }
  if (is_in("operator", key) && files.scenario->motion_requests.empty()) return std::string(of_machine) + ": the operator's moves are the log's";
  if (is_ours(options)) return "";
  const bool is_of_a_side = is_in("crane", key) || is_in("axis", key) || key.starts_with("controller.");
  return is_of_a_side ? "none beside a controller of your own, which is asked alone and reads its own file" : "";
}

void check_settings(const ReplayOptions& options, const Configuration& files) {
  common::InputProblems problems;
  for (const common::Override& each : options.overrides) {
    const std::string expected = expected_of_setting(each.key, options, files);
    if (!expected.empty()) problems.push_back({{"--set " + each.key + "=" + each.value, 0, 0}, each.key, "a setting that changes nothing here", expected});
  }
  if (!problems.empty()) throw common::InputError(problems);
}

Configuration configuration(const ReplayOptions& options, const fs::path& log) {
  Configuration result;
  fs::path scenario = options.scenario;
  if (scenario.empty() && fs::exists(log.parent_path() / "scenario.yaml")) scenario = log.parent_path() / "scenario.yaml";
  std::vector<common::Override> changes = options.overrides;
  fs::path controller_file = options.controller_config;
  std::vector<common::Override> controller_changes;
  if (!scenario.empty()) {
    result.hash = msgs::configuration_hash(sim::load_scenario_file(scenario).configuration_text);
    if (!options.crane.empty()) {
      const sim::MachineKind kind = sim::load_machine_file(options.crane).kind;
      changes.push_back({std::string(sim::name_of(kind)), fs::absolute(options.crane).string()});
    }
    if (!options.controller_config.empty()) {
      changes.push_back({"controller", fs::absolute(options.controller_config).string()});
    }
    result.scenario = sim::load_scenario_file(scenario, changes);
    result.crane = result.scenario->crane;
    controller_file = result.scenario->controller_file;
    controller_changes = result.scenario->controller_overrides;
  } else if (!options.crane.empty()) {
    result.crane = sim::load_machine_file(options.crane, changes);
  }
  if (!controller_file.empty() && is_ours(options)) {
    result.controller = controller::load_controller_file(controller_file, controller_changes).settings;
  }
  if (!is_ours(options)) return result;
  if (!result.crane && !result.controller) {
    throw BadCall("there is no scenario.yaml beside " + log.string() +
                  "; give --crane CRANE.yaml for the plant's half, --controller-config CONTROLLER.yaml for the "
                  "controller's, or --scenario for both");
  }
  return result;
}

template <class Message>
std::int64_t period_of(const msgs::RunStream& record) {
  const msgs::ChannelExtent& extent = msgs::extent_of<Message>(record);
  const std::int64_t count = extent.last_key - extent.first_key;
  return count > 0 ? (extent.last_time - extent.first_time) / count : 0;
}

// A scenario made from what the log tells, for a log that came without one.
sim::Scenario scenario_of(const msgs::RunStream& record, const sim::MachineFile& crane) {
  sim::Scenario scenario;
  scenario.crane = crane;
  scenario.controller_period = period_of<msgs::Encoder>(record);
  if (scenario.controller_period == 0) throw BadCall("the log has fewer than two ENCODER: no controller period");
  const auto or_controller_period = [&](std::int64_t period) {
    return period > 0 ? period : scenario.controller_period;
  };
  scenario.sensors_period = or_controller_period(period_of<msgs::Sensors>(record));
  scenario.truth_period = or_controller_period(period_of<msgs::Truth>(record));
  scenario.status_period = or_controller_period(period_of<msgs::PlantStatus>(record));
  scenario.plant_step = std::gcd(std::gcd(kUsualPlantStep, scenario.controller_period),
                                 std::gcd(scenario.sensors_period, std::gcd(scenario.truth_period, scenario.status_period)));
  if (scenario.plant_step < kShortestPlantStep) {
    throw BadCall(fmt::format("the periods in the log (ENCODER {} ns, SENSORS {} ns, TRUTH {} ns, PLANT_STATUS {} ns) have no common step of "
                              "{} ns or more; give --scenario", scenario.controller_period, scenario.sensors_period, scenario.truth_period,
                              scenario.status_period, kShortestPlantStep));
  }
  return scenario;
}

Comparison compare_plant(const sim::Scenario& scenario, const fs::path& log, const msgs::RunStream& record,
                         std::ostream& out) {
  RunningComparison<msgs::Encoder> encoder(record);
  RunningComparison<msgs::Sensors> sensors(record);
  RunningComparison<msgs::Truth> truth(record);
  RunningComparison<msgs::PlantStatus> status(record);
  const PlantListener listener{[&](const msgs::Encoder& message) { encoder.add(message); },
                               [&](const msgs::Sensors& message) { sensors.add(message); },
                               [&](const msgs::Truth& message) { truth.add(message); },
                               [&](const msgs::PlantStatus& message) { status.add(message); }};
  for (const std::string& remark : replay_plant(scenario, record, recorded_arrivals(log, record), listener)) out << "    note: " << remark << '\n';
  return {encoder.finish(), sensors.finish(), truth.finish(), status.finish()};
}

// Our own controller, in this process.
void ask_ours(const controller::ControllerSettings& settings, const msgs::RunStream& record, const Question*& question,
              const Questions::Next& next, const ControllerListener& listener) {
  msgs::MemoryWire wire;
  const auto asking = wire.connect();
  const auto answering = wire.connect();
  const controller::AnswerLoop loop(*answering, controller::computed_answer(settings));
  asking->on_wait = [&] { answering->drain(); };
  ask_controller(*asking, record, question, next, {}, listener);
}

// A process of its own, over LCM.
void ask_process(const ReplayOptions& options, const fs::path& controller_file, const msgs::RunStream& record,
                 const Question*& question, const Questions::Next& next, std::int64_t period, const ControllerListener& listener,
                 std::ostream& err) {
  const msgs::ReservedPort port;
  const std::string url = msgs::bus_url(port.number());
  ChildOptions child;
  child.name = "controller";
  child.command = {"/bin/sh", "-c", options.controller_command};
  if (!options.controller_fmu.empty()) {
    child.command = {python_interpreter().string(), (home() / "tools" / "python" / "controller_fmu.py").string(), options.controller_fmu.string()};
  }
  child.environment = {{"SLEWLAB_BUS", url},
                       {"LCM_DEFAULT_URL", url},
                       {"SLEWLAB_PYTHON_MESSAGES", python_messages().string()},
                       {"SLEWLAB_CONTROLLER_PERIOD_MS", fmt::format("{:.9g}", static_cast<double>(period) / 1e6)}};
  if (!options.controller_fmu.empty()) {
    for (const auto& variable : python_environment()) child.environment.push_back(variable);
  }
  if (!controller_file.empty()) {
    child.environment.emplace_back("SLEWLAB_CONTROLLER_CONFIG", fs::absolute(controller_file).string());
  }
  const auto bus = msgs::open_lcm_bus(url);
  ChildProcess controller(child);
  const GroupGuard guard({controller.pid()});
  const auto ignore = [](const std::string&) {};
  AskSettings settings;
  auto last_answer = std::chrono::steady_clock::now();
  bool has_answered = false;
  bool told = false;
  const ControllerListener noting{[&](const msgs::Torque& message) {
                                    has_answered = true;
                                    listener.torque(message);
                                  },
                                  listener.controller_state};
  settings.stop = [&] {
    controller.read_output(ignore);
    const auto now = std::chrono::steady_clock::now();
    if (std::exchange(has_answered, false)) {
      last_answer = now;
    } else if (!told && now - last_answer > kSilence) {
      told = true;
      err << "slewlab replay: the controller has not answered for a while; still asking\n";
    }
    return controller.ended();
  };
  if (!ask_controller(*bus, record, question, next, settings, noting)) {
    std::string text = "the controller ended before its time: " + controller.how_it_ended();
    for (const std::string& line : controller.last_words()) text += "\n  " + line;
    throw std::runtime_error(text);
  }
  controller.send(SIGTERM);
}

Comparison compare_controller(const ReplayOptions& options, const Configuration& configuration,
                              const msgs::RunStream& record, std::ostream& out, std::ostream& err) {
  const Questions questions = recorded_questions(record);
  for (const std::string& remark : questions.remarks) out << "    note: " << remark << '\n';
  const std::int64_t period =
      configuration.scenario ? configuration.scenario->controller_period : period_of<msgs::Encoder>(record);
  if (period == 0) throw BadCall("the log has fewer than two ENCODER: no controller period");
  RunningComparison<msgs::Torque> torque(record);
  RunningComparison<msgs::ControllerState> state(record);
  bool sends_state = false;
  const ControllerListener listener{[&](const msgs::Torque& message) { torque.add(message); },
                                    [&](const msgs::ControllerState& message) {
                                      sends_state = true;
                                      state.add(message);
                                    }};
  const Questions::Next next = questions.open();
  for (const Question* question = next(); question != nullptr;) {
    if (is_ours(options)) {
      controller::ControllerSettings settings = *configuration.controller;
      settings.period = static_cast<double>(period) / 1e6 * 1e-3;  // as slewlab-controller works it out from [ms]
      ask_ours(settings, record, question, next, listener);
    } else {
      const fs::path file = !options.controller_config.empty() ? options.controller_config
                            : configuration.scenario           ? configuration.scenario->controller_file
                                                               : fs::path();
      ask_process(options, file, record, question, next, period, listener, err);
    }
  }
  Comparison comparison{torque.finish()};
  // A controller need not send its state.
  if (sends_state || is_ours(options)) comparison.push_back(state.finish());
  return comparison;
}

std::map<std::string, double> read_tolerances(const std::vector<std::string>& texts) {
  std::map<std::string, double> tolerances;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    double value = 0.0;
    if (equals == std::string::npos || !common::parse_number(text.substr(equals + 1), value) || !(value >= 0.0)) {
      throw BadCall("--tolerance " + text + ": CHANNEL.FIELD=SIZE is wanted, e.g. TORQUE.motor_torque=0.5");
    }
    tolerances[text.substr(0, equals)] = value;
  }
  return tolerances;
}

bool within(const std::map<std::string, double>& tolerances, const FieldDifference& difference) {
  const std::string name = difference.channel + "." + difference.field.substr(0, difference.field.find('['));
  const auto allowed = tolerances.find(name);
  return allowed != tolerances.end() && difference.largest <= allowed->second;
}

// Says how it ended; true where nothing differs that counts.
bool judge(const Comparison& comparison, const std::map<std::string, double>& tolerances, std::ostream& out) {
  print(out, comparison);
  if (compared_messages(comparison) == 0) {
    out << "    nothing could be compared\n";
    return false;
  }
  if (identical(comparison)) {
    out << "    identical to the bit " << compared_span(comparison) << '\n';
    return true;
  }
  bool all_within = true;
  for (const ChannelComparison& channel : comparison) {
    for (const FieldDifference& difference : channel.differences) all_within = all_within && within(tolerances, difference);
  }
  out << (all_within ? "    different, within the tolerances given\n" : "    different\n");
  return all_within;
}

// Why a record, whose configuration is that of the files at hand, is a part of its run alone; empty where it came to its end, be it before the
// scenario's where the run itself says so (a desk's does).
std::string why_ended_early(const fs::path& log, const msgs::RunStream& record, const sim::Scenario& scenario) {
  const msgs::ChannelExtent& encoder = msgs::extent_of<msgs::Encoder>(record);
  if (encoder.messages == 0 || encoder.last_time >= scenario.duration - scenario.controller_period) return {};
  const RunSummary summary = read_run_summary(log.parent_path());
  if (!summary.log_digest.empty() && summary.log_digest == msgs::hash_text(msgs::log_digest(log))) return {};
  return fmt::format("the log ends at {:.3f} s of the scenario's {:.3f} s", static_cast<double>(encoder.last_time) / kNanosecondsPerSecond,
                     static_cast<double>(scenario.duration) / kNanosecondsPerSecond);
}

// What is wrong with the file itself; empty where nothing is.
std::string why_damaged(const msgs::RunStreams& logs) {
  std::string text;
  if (logs.lost_bytes > 0) text = fmt::format("{} bytes of the log are no whole event", logs.lost_bytes);
  if (logs.lost_messages > 0) text += fmt::format("{}{} messages of the plant in it cannot be used", text.empty() ? "" : ", ", logs.lost_messages);
  return text;
}

int replay_log(const ReplayOptions& options, std::ostream& out, std::ostream& err) {
  const auto tolerances = read_tolerances(options.tolerances);
  const fs::path log = log_in(options.log);
  const msgs::RunStreams logs = msgs::run_streams(log);
  const Configuration files = configuration(options, log);
  check_settings(options, files);
  for (const std::string& remark : logs.remarks) out << "note: " << remark << '\n';
  const int run_count = static_cast<int>(logs.runs.size());
  if (options.run < 0 || options.run > run_count) {
    throw BadCall(fmt::format("--run {}: the log holds {} runs, counted from 1", options.run, run_count));
  }
  const bool any_of_this_configuration =
      files.hash && std::any_of(logs.runs.begin(), logs.runs.end(), [&](const msgs::RunStream& run) {
        return run.configuration_hash == *files.hash;
      });

  // What such a plant does under recorded torques is not slewlab's to say.
  const bool by_another_plant = options.crane.empty() && fs::exists(log.parent_path() / kPlantTaskName);
  bool good = true;
  const auto tell_part = [&](const std::string& why) {
    if (why.empty()) return;
    out << "  not the whole run: " << why << "; what is missing was not compared\n";
    good = false;
  };
  for (int i = 0; i < run_count; ++i) {
    const msgs::RunStream& record = logs.runs[static_cast<std::size_t>(i)];
    if (options.run > 0 && i + 1 != options.run) continue;
    const bool of_this_configuration = files.hash && record.configuration_hash == *files.hash;
    out << fmt::format("run {} of {}: configuration {}, {} ENCODER, {} TORQUE, {} SENSORS\n", i + 1, run_count,
                       msgs::hash_text(record.configuration_hash), msgs::extent_of<msgs::Encoder>(record).messages,
                       msgs::extent_of<msgs::Torque>(record).messages, msgs::extent_of<msgs::Sensors>(record).messages);
    if (options.run == 0 && any_of_this_configuration && !of_this_configuration) {
      out << "  not replayed: it was recorded with another configuration than that of the files at hand\n";
      continue;
    }
    if (files.hash && !of_this_configuration) {
      out << fmt::format("  note: the files at hand have the configuration {}: not those of this run\n",
                         msgs::hash_text(*files.hash));
    }
    if (is_ours(options)) {
      if (by_another_plant) {
        out << "  plant: not replayed, it was one of your own (--crane compares it with a machine of slewlab's)\n";
      } else if (files.crane) {
        out << "  plant, fed with the recorded TORQUE\n";
        if (!files.scenario) out << "    note: no scenario at hand: steps and periods are taken from the log\n";
        const sim::Scenario scenario = files.scenario ? *files.scenario : scenario_of(record, *files.crane);
        good = judge(compare_plant(scenario, log, record, out), tolerances, out) && good;
      } else {
        out << "  plant: not replayed, there is no crane at hand (--crane)\n";
      }
    }
    if (!is_ours(options) || files.controller) {
      out << "  controller, fed with the recorded ENCODER and OPERATOR\n";
      good = judge(compare_controller(options, files, record, out, err), tolerances, out) && good;
    } else {
      out << "  controller: not replayed, there is no configuration of a controller at hand (--controller-config)\n";
    }
    if (of_this_configuration) tell_part(why_ended_early(log, record, *files.scenario));
  }
  tell_part(why_damaged(logs));
  return good ? 0 : 1;
}

}  // namespace

int replay(const ReplayOptions& options, const std::vector<std::string>& command_line, std::ostream& out,
           std::ostream& err) {
  try {
    if (!is_ours(options)) need_multicast(command_line);
    return replay_log(options, out, err);
  } catch (const common::InputError& error) {
    err << error.what() << '\n';
    return 2;
  } catch (const msgs::LogError& error) {
    err << "slewlab replay: " << error.what() << '\n';
    return 2;
  } catch (const BadCall& error) {
    err << "slewlab replay: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    err << "slewlab replay: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace slewlab::tools
