#include "tools/commands/accept_command.h"

#include <fmt/format.h>
#include <poll.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <fstream>
#include <stdexcept>

#include "common/input_error.h"
#include "sim/drive/scenario_file.h"
#include "tools/acceptance/judgement.h"
#include "tools/acceptance/limits.h"
#include "tools/commands/child_process.h"
#include "tools/commands/home.h"
#include "tools/commands/run_command.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kPollMilliseconds = 200;

// Why the run did not come to its end; empty where it did, or where nothing tells.
std::string why_incomplete(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (!summary.is_object() || summary.value("outcome", "complete") == "complete") return {};
  const std::string reason = summary.value("reason", "");
  return reason.empty() ? summary.value("outcome", "") : reason;
}

// What the run told of the log that it wrote; empty where nothing tells.
std::string written_digest(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (!summary.is_object() || !summary.contains("run") || !summary["run"].is_object()) return {};
  return summary["run"].value("log_digest", "");
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
  Judgement judgement;
  judgement.machine = accepted_machine(scenario);
  judgement.no_verdict = why_incomplete(folder);
  fs::remove(folder / "acceptance.json");  // of an earlier time
  const fs::path log = fs::exists(folder / "run.lcmlog") ? folder / "run.lcmlog" : folder / "run.lcmlog.partial";
  const bool any_log = fs::exists(log) && fs::file_size(log) > 0;
  if (judgement.no_verdict.empty()) {
    judgement = judge_log(scenario, log, limits, written_digest(folder));
    for (const std::string& remark : judgement.remarks) std::printf("note: %s\n", remark.c_str());
  } else {
    judgement.checks.push_back(failed_check("run", judgement.no_verdict));
  }
  const std::vector<CheckResult>& results = judgement.checks;
  const std::string& no_verdict = judgement.no_verdict;

  const std::string name = options.subject.stem().string();
  std::printf("%s", check_table(results).c_str());
  write_whole_file(folder / "acceptance.json", checks_json(results, limits, judgement.machine));
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
      if (!options.controller_command.empty() || !options.overrides.empty() || !options.out.empty()) {
        std::fprintf(stderr, "slewlab accept: --controller, --set and --out are for a scenario; %s is a run that was made "
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
