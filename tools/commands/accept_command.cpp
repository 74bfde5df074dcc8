#include "tools/commands/accept_command.h"

#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/input_error.h"
#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "sim/drive/scenario_file.h"
#include "tools/acceptance/judgement.h"
#include "tools/acceptance/limits.h"
#include "tools/acceptance/plan.h"
#include "tools/acceptance/record.h"
#include "tools/acceptance/run_summary.h"
#include "tools/commands/child_process.h"
#include "tools/commands/home.h"
#include "tools/commands/named_files.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/plant_task.h"
#include "tools/commands/run_command.h"
#include "tools/commands/version.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kPollMilliseconds = 200;

void draw(const char* script, const fs::path& folder) {
  const fs::path python = python_interpreter();
  if (!fs::exists(python)) {
    std::printf("no page: there is no %s (tools/setup makes it)\n", python.c_str());
    return;
  }
  ChildOptions options;
  options.name = "page";
  options.command = {python.string(), (home() / "tools" / "python" / script).string(), folder.string()};
  options.environment = python_environment();
  ChildProcess page(options);
  const auto show = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
  while (!page.ended()) {
    pollfd fds[] = {{page.output_fd(), POLLIN, 0}, {page.complaint_fd(), POLLIN, 0}};
    ::poll(fds, 2, kPollMilliseconds);
    page.read_output(show);
  }
  page.read_output(show);
  if (!page.succeeded()) std::fprintf(stderr, "no page: %s\n%s", page.how_it_ended().c_str(), page.complaints().c_str());
}

// The log of a run's folder; empty where there is none.
fs::path log_of(const fs::path& folder) {
  const fs::path log = fs::exists(folder / "run.lcmlog") ? folder / "run.lcmlog" : folder / "run.lcmlog.partial";
  return fs::exists(log) && fs::file_size(log) > 0 ? log : fs::path();
}

std::string digest_of_log(const fs::path& folder) {
  const fs::path log = log_of(folder);
  return log.empty() ? "" : msgs::hash_text(msgs::log_digest(log));
}

Judgement judge_folder(const fs::path& folder, const sim::Scenario& scenario, const AcceptanceLimits& limits) {
  Judgement judgement;
  judgement.machine = accepted_machine(scenario);
  const RunSummary summary = read_run_summary(folder);
  judgement.no_verdict = summary.problem.empty() ? summary.why_incomplete : summary.problem;
  for (const char* earlier : {"acceptance.json", "acceptance.html"}) fs::remove(folder / earlier);
  if (judgement.no_verdict.empty()) {
    const fs::path log = log_of(folder);
    judgement = judge_log(scenario, log.empty() ? folder / "run.lcmlog" : log, limits, {summary.log_digest, fs::exists(folder / kPlantTaskName)});
  } else {
    judgement.checks.push_back(failed_check("run", judgement.no_verdict));
  }
  return judgement;
}

int judge(const fs::path& folder, const AcceptOptions& options, const AcceptanceLimits& limits) {
  const sim::Scenario scenario = sim::load_scenario_file(folder / "scenario.yaml");
  const Judgement judgement = judge_folder(folder, scenario, limits);
  for (const std::string& remark : judgement.remarks) std::printf("note: %s\n", remark.c_str());
  if (const std::string other = why_of_another_machine(scenario, limits); !other.empty()) std::fprintf(stderr, "warning: %s\n", other.c_str());
  const std::vector<CheckResult>& results = judgement.checks;
  const std::string& no_verdict = judgement.no_verdict;

  const std::string name = options.subject.stem().string();
  std::printf("%s", check_table(results).c_str());
  write_whole_file(folder / "acceptance.json", checks_json(results, limits, judgement.machine, digest_of_log(folder)));
  if (!options.junit.empty()) write_whole_file(options.junit, junit_xml(name, results));
  if (!log_of(folder).empty() && options.plot) draw("acceptance_plot.py", folder);
  const bool good = accepted(results);
  if (no_verdict.empty()) {
    const std::string silent = not_judged(results);
    std::printf("%s: %s%s\n", name.c_str(), good ? "accepted" : "NOT accepted", silent.empty() ? "" : ("; nothing in this run to judge by: " + silent).c_str());
  } else {
    std::printf("%s: no verdict, and NOT accepted: %s\n", name.c_str(), no_verdict.c_str());
  }
  return good ? 0 : 1;
}

std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,%+@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

// Commands name files as they are seen from this folder.
std::string from_here() { return "cd " + shell_word(fs::current_path().string()) + " && "; }

// Controller and plant as options of the command line.
std::string sides_words(const AcceptOptions& options) {
  std::string words;
  if (!options.controller_command.empty()) words += " --controller " + shell_word(options.controller_command);
  if (!options.controller_fmu.empty()) words += " --controller-fmu " + shell_word(options.controller_fmu.string());
  if (!options.plant_command.empty()) words += " --plant " + shell_word(options.plant_command);
  return words;
}

std::string record_command(const AcceptOptions& options) {
  std::string command = from_here() + "slewlab accept --record " + shell_word(options.subject.string()) + sides_words(options) + " --out " +
                        shell_word(options.out.string());
  if (!options.junit.empty()) command += " --junit " + shell_word(options.junit.string());
  return command + (options.plot ? "" : " --no-plot");
}

// The files of one side: those that its command names, or the program of slewlab's that it is without one.
std::vector<fs::path> files_of_side(const std::string& command, const char* own_program) {
  if (command.empty()) return {fs::read_symlink("/proc/self/exe").parent_path() / own_program};
  return files_named_by(command);
}

// What took part in the test, as files.
std::vector<TestedFile> tested_files(const AcceptOptions& options) {
  const std::vector<fs::path> controller = options.controller_fmu.empty()
                                               ? files_of_side(options.controller_command, "slewlab-controller")
                                               : std::vector<fs::path>{fs::absolute(options.controller_fmu).lexically_normal()};
  std::vector<TestedFile> files;
  for (const fs::path& file : controller) files.push_back({"controller", file.string(), sha256_of_file(file)});
  for (const fs::path& file : files_of_side(options.plant_command, "slewlab-plant")) {
    files.push_back({"plant", file.string(), sha256_of_file(file)});
  }
  return files;
}

// What of the files that took part has to be known beside their digests.
std::vector<std::string> file_warnings(const AcceptOptions& options, const std::vector<TestedFile>& before) {
  std::vector<std::string> warnings;
  const auto has = [&](const char* of) { return std::any_of(before.begin(), before.end(), [&](const TestedFile& file) { return file.of == of; }); };
  for (const auto& [of, command] : {std::pair{"controller", options.controller_command}, std::pair{"plant", options.plant_command}}) {
    if (!command.empty() && !has(of)) warnings.push_back(std::string("the ") + of + "'s command names no file that is here: it is known by the command alone");
  }
  for (const TestedFile& file : before) {
    if (!fs::exists(file.file) || sha256_of_file(file.file) != file.sha256) {
      warnings.push_back(file.file + " changed while the runs were made: not all of them were of one " + file.of);
    }
  }
  return warnings;
}

// Whether controller and plant can take every run of the plan; says why not. An FMU is asked once for each machine and period.
bool can_make_runs(const AcceptancePlan& plan, const AcceptOptions& options) {
  bool can = true;
  std::set<std::pair<int, std::int64_t>> asked;
  for (const PlannedTest& test : plan.tests) {
    const sim::Scenario scenario = sim::load_scenario_file(test.scenario);
    RunOptions run;
    run.scenario = test.scenario.lexically_normal();
    run.plant_command = options.plant_command;
    if (asked.emplace(scenario.crane.parameters.drive.group_count, scenario.controller_period).second) run.controller_fmu = options.controller_fmu;
    can = can_be_run_by_others(run) && can;
  }
  return can;
}

// The run of one test of the plan, made and judged. Throws what run and judgement throw; answers with the exit code of a run
// that was called wrongly or stopped by a signal, 0 otherwise.
int make_recorded_run(const PlannedTest& test, const AcceptOptions& options, const AcceptanceLimits& limits, const fs::path& limits_file,
                      const std::vector<std::string>& command_line, RecordedTest& recorded) {
  RunOptions run;
  run.scenario = test.scenario;
  run.out = options.out / test.name;
  run.controller_command = options.controller_command;
  run.controller_fmu = options.controller_fmu;
  run.plant_command = options.plant_command;
  run.progress = Progress::none;
  const int result = run_scenario(run, command_line);
  if (result > 1) return result;
  const sim::Scenario scenario = sim::load_scenario_file(run.out / "scenario.yaml");
  const Judgement judgement = judge_folder(run.out, scenario, limits);
  write_whole_file(run.out / "acceptance.json", checks_json(judgement.checks, limits, judgement.machine, digest_of_log(run.out)));
  if (const std::string other = why_of_another_machine(scenario, limits); !other.empty()) recorded.warning = test.name + ": " + other;
  recorded.test = test;
  recorded.test.scenario = test.scenario.lexically_normal();
  recorded.is_failure_case = !scenario.faults.empty();
  recorded.checks = judgement.checks;
  recorded.no_verdict = judgement.no_verdict;
  const RunSummary summary = read_run_summary(run.out);
  recorded.configuration_hash = summary.configuration_hash;
  recorded.log_digest = summary.log_digest;
  recorded.seed = scenario.seed;
  recorded.folder = test.name;
  recorded.command = from_here() + "slewlab accept " + shell_word(recorded.test.scenario.string()) + " --limits " + shell_word(limits_file.string()) +
                     sides_words(options);
  return 0;
}

int record(const AcceptOptions& options, const std::vector<std::string>& command_line) {
  const AcceptancePlan plan = load_acceptance_plan(options.subject);
  AcceptOptions own = options;
  if (own.out.empty()) own.out = fs::path("runs") / ("record_" + options.subject.stem().string());
  if (!can_make_runs(plan, own)) return 2;
  make_output_folder(own.out);
  const std::vector<TestedFile> files = tested_files(own);
  for (const char* old : {"record.json", "record.html", "record.xml"}) fs::remove(own.out / old);
  const fs::path limits_file = plan.limits.lexically_normal();
  const AcceptanceLimits limits = load_acceptance_limits(limits_file);
  std::vector<RecordedTest> tests;
  for (const PlannedTest& test : plan.tests) {
    if (const int code = make_recorded_run(test, own, limits, limits_file, command_line, tests.emplace_back()); code != 0) return code;
  }
  AcceptanceRecord result = trace(plan, tests);
  for (const RecordedTest& test : tests) {
    if (!test.warning.empty()) result.warnings.push_back(test.warning);
  }
  for (const std::string& warning : file_warnings(own, files)) result.warnings.push_back(warning);
  RecordFacts facts;
  facts.plan_file = options.subject.string();
  facts.plan_digest = msgs::hash_text(msgs::log_digest(options.subject));
  facts.limits_file = limits_file.string();
  facts.limits_digest = msgs::hash_text(msgs::log_digest(limits_file));
  facts.controller = options.controller_fmu.empty() ? options.controller_command : "FMU " + options.controller_fmu.string();
  if (facts.controller.empty()) facts.controller = "slewlab-controller";
  facts.plant = options.plant_command.empty() ? "slewlab-plant" : options.plant_command;
  facts.files = files;
  facts.versions = version_text();
  facts.time = utc_now();
  facts.command = record_command(own);
  write_whole_file(own.out / "record.json", record_json(plan, result, tests, facts).dump(2) + "\n");
  const std::string junit = record_junit(plan, result, tests);
  write_whole_file(own.out / "record.xml", junit);
  if (!options.junit.empty()) write_whole_file(options.junit, junit);
  std::printf("%s", record_table(result).c_str());
  if (options.plot) draw("acceptance_record.py", own.out);
  std::printf("%s: %s\n", options.subject.stem().c_str(), result.accepted ? "accepted" : "NOT accepted");
  return result.accepted ? 0 : 1;
}

}  // namespace

int accept(const AcceptOptions& options, const std::vector<std::string>& command_line) {
  try {
    make_folder_of(options.junit, "--junit");
    if (options.record) return record(options, command_line);
    const AcceptanceLimits limits = load_acceptance_limits(options.limits);
    if (fs::is_directory(options.subject)) {
      if (!options.controller_command.empty() || !options.controller_fmu.empty() || !options.plant_command.empty() ||
          !options.overrides.empty() || !options.out.empty()) {
        std::fprintf(stderr, "slewlab accept: --controller, --controller-fmu, --plant, --set and --out are for a scenario; %s is a run that was made "
                             "already\n", options.subject.c_str());
        return 2;
      }
      if (!fs::exists(options.subject / "scenario.yaml")) {
        throw common::InputError({{{options.subject.string(), 0, 0}, "", "a folder without scenario.yaml", "a scenario, or the folder of a run"}});
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
