#include "tools/commands/accept_command.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <fstream>
#include <stdexcept>

#include "common/input_error.h"
#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "sim/drive/fault_expectation.h"
#include "sim/model/drive_line.h"
#include "sim/drive/scenario_file.h"
#include "tools/acceptance/checks.h"
#include "tools/acceptance/limits.h"
#include "tools/commands/child_process.h"
#include "tools/commands/home.h"
#include "tools/commands/run_command.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kPollMilliseconds = 200;
constexpr double kNanosecondsPerSecond = 1e9;

// Why the run did not come to its end; empty where it did, or where nothing tells.
std::string why_incomplete(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (!summary.is_object() || summary.value("outcome", "complete") == "complete") return {};
  const std::string reason = summary.value("reason", "");
  return reason.empty() ? summary.value("outcome", "") : reason;
}

CheckResult failed_check(const char* name, const std::string& reason) {
  CheckResult result;
  result.name = name;
  result.verdict = Verdict::fail;
  result.reason = reason;
  return result;
}

// Why the log is not the one that the run wrote; empty where it is, or where nothing tells.
std::string why_another_log(const fs::path& folder, const fs::path& log) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (!summary.is_object() || !summary.contains("run") || !summary["run"].is_object()) return {};
  const std::string written = summary["run"].value("log_digest", "");
  if (written.empty()) return {};
  const std::string found = msgs::hash_text(msgs::log_digest(log));
  if (found == written) return {};
  return fmt::format("{} is not as the run wrote it: {} bytes with digest {}, summary.json says {} bytes with digest {}",
                     log.filename().string(), fs::file_size(log), found, summary["run"].value("log_bytes", 0LL), written);
}

// What the scenario itself says must happen.
CheckResult expected_reaction(const sim::FaultExpectation& expectation, const msgs::RunLog& run) {
  CheckResult result;
  result.name = "expectation";
  const std::vector<std::string> broken = sim::broken_expectations(expectation, run);
  result.verdict = broken.empty() ? Verdict::pass : Verdict::fail;
  result.reason = broken.empty() ? "everything under expect: of the scenario came about" : "";
  for (const std::string& line : broken) result.reason += (result.reason.empty() ? "" : "; ") + line;
  return result;
}

void draw(const fs::path& folder) {
  const fs::path python = python_interpreter();
  if (!fs::exists(python)) {
    std::printf("no plot: there is no %s (tools/setup makes it)\n", python.c_str());
    return;
  }
  ChildOptions options;
  options.name = "plot";
  options.command = {python.string(), (home() / "tools" / "python" / "acceptance_plot.py").string(), folder.string()};
  options.environment = {{"SLEWLAB_PYTHON_MESSAGES", python_messages().string()}};
  ChildProcess plot(options);
  const auto show = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
  while (!plot.ended()) {
    pollfd fds[] = {{plot.output_fd(), POLLIN, 0}, {plot.complaint_fd(), POLLIN, 0}};
    ::poll(fds, 2, kPollMilliseconds);
    plot.read_output(show);
  }
  plot.read_output(show);
  if (!plot.succeeded()) std::fprintf(stderr, "no plot: %s\n%s", plot.how_it_ended().c_str(), plot.complaints().c_str());
}

int judge(const fs::path& folder, const AcceptOptions& options, const AcceptanceLimits& limits) {
  const sim::Scenario scenario = sim::load_scenario_file(folder / "scenario.yaml");
  AcceptedMachine machine;
  machine.total_ratio = sim::total_ratio(scenario.crane.parameters.drive);
  for (const sim::Fault& fault : scenario.faults) {
    const double from = static_cast<double>(fault.from) / kNanosecondsPerSecond;
    machine.first_fault = std::min(machine.first_fault.value_or(from), from);
  }
  std::vector<CheckResult> results;
  std::string no_verdict = why_incomplete(folder);
  if (!no_verdict.empty()) results.push_back(failed_check("run", no_verdict));
  fs::remove(folder / "acceptance.json");  // of an earlier time
  const fs::path log = fs::exists(folder / "run.lcmlog") ? folder / "run.lcmlog" : folder / "run.lcmlog.partial";
  const bool any_log = fs::exists(log) && fs::file_size(log) > 0;
  if (results.empty()) {
    const msgs::RunLogs logs = msgs::read_run_logs(log);
    for (const std::string& remark : logs.remarks) std::printf("note: %s\n", remark.c_str());
    no_verdict = why_no_verdict(logs, {scenario.duration, scenario.controller_period, scenario.sensors_period});
    if (no_verdict.empty()) no_verdict = why_another_log(folder, log);
    if (!no_verdict.empty()) {
      results.push_back(failed_check("log", no_verdict));
    } else {
      results = acceptance_checks(logs.runs.front(), limits, machine);
      if (machine.first_fault) results.push_back(expected_reaction(scenario.expectation, logs.runs.front()));
      const bool any_judged = std::any_of(results.begin(), results.end(),
                                          [](const CheckResult& result) { return result.verdict != Verdict::not_applicable; });
      if (!any_judged) no_verdict = "no check applies to this run";
    }
  }

  const std::string name = options.subject.stem().string();
  std::printf("%s", check_table(results).c_str());
  write_whole_file(folder / "acceptance.json", checks_json(results, limits, machine));
  if (!options.junit.empty()) write_whole_file(options.junit, junit_xml(name, results));
  if (any_log && options.plot) draw(folder);
  const bool good = accepted(results);
  if (no_verdict.empty()) {
    std::printf("%s: %s\n", name.c_str(), good ? "accepted" : "NOT accepted");
  } else {
    std::printf("%s: no verdict, and NOT accepted: %s\n", name.c_str(), no_verdict.c_str());
  }
  return good ? 0 : 1;
}

}  // namespace

int accept(const AcceptOptions& options, const std::vector<std::string>& command_line) {
  try {
    const AcceptanceLimits limits = load_acceptance_limits(options.limits);
    if (fs::is_directory(options.subject)) {
      if (!options.controller_command.empty() || !options.controller_fmu.empty() || !options.plant_command.empty() ||
          !options.overrides.empty() || !options.out.empty()) {
        std::fprintf(stderr, "slewlab accept: --controller, --controller-fmu, --plant, --set and --out are for a scenario; %s is a run that was made "
                             "already\n", options.subject.c_str());
        return 2;
      }
      return judge(options.subject, options, limits);
    }
    if (options.subject.extension() == ".lcmlog") {
      std::fprintf(stderr, "slewlab accept: %s is a log; name the folder of its run, with the scenario that the log is judged by\n",
                   options.subject.c_str());
      return 2;
    }
    RunOptions run;
    run.scenario = options.subject;
    run.out = options.out.empty() ? fs::path("runs") / ("accept_" + options.subject.stem().string()) : options.out;
    run.controller_command = options.controller_command;
    run.controller_fmu = options.controller_fmu;
    run.plant_command = options.plant_command;
    run.overrides = options.overrides;
    run.progress = Progress::none;
    const int result = run_scenario(run, command_line);
    if (result > 1) return result;  // a wrong call, or a signal
    return judge(run.out, options, limits);
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab accept: %s\n", error.what());
    return 1;
  }
}

}  // namespace slewlab::tools
