#include "tools/commands/soak_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "common/input_error.h"
#include "common/stop_signal.h"
#include "tools/soak/campaign.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/status_line.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
constexpr double kHour = 3600.0;                      // [s]
constexpr double kLineInterval = 10.0;  // [s] between progress lines where there is no terminal

std::string quoted(const std::string& text) {
  if (text.find_first_of(" '\"$&;*?(){}[]<>|\\#") == std::string::npos && !text.empty()) return text;
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      result += c;
    }
  }
  return result + "'";
}

SoakPlan plan_of(const SoakOptions& options) {
  SoakPlan plan;
  plan.crane = options.crane;
  plan.controller = options.controller;
  plan.faults = options.faults;
  plan.seed = options.seed;
  std::vector<common::Override> own;
  for (const common::Override& change : options.overrides) {
    const bool for_machine = change.key.starts_with("crane.") || change.key.starts_with("controller.");
    (for_machine ? plan.overrides : own).push_back(change);
  }
  plan.settings = load_soak_settings(options.config, own);
  return plan;
}

// Everything that decides what a task is, up to the number.
std::string repeating_command(const SoakOptions& options) {
  std::string command = fmt::format("slewlab soak --seed {}", options.seed);
  if (options.faults) command += " --faults";
  command += " --crane " + quoted(fs::absolute(options.crane).string());
  command += " --controller " + quoted(fs::absolute(options.controller).string());
  command += " --config " + quoted(fs::absolute(options.config).string());
  for (const common::Override& change : options.overrides) command += " --set " + quoted(change.key + "=" + change.value);
  return command + " --task";
}

std::string clock_text(double seconds) {
  const long long whole = std::llround(seconds);
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string progress_text(const CampaignProgress& now) {
  const double hours = static_cast<double>(now.done) * now.task_seconds / kHour;
  std::string text = fmt::format("{:.2f} of {:.2f} simulated hours, {} of {} tasks", hours,
                                 static_cast<double>(now.tasks) * now.task_seconds / kHour, now.done, now.tasks);
  if (now.done_here > 0 && now.wall_seconds > 0.0) {
    const double per_task = now.wall_seconds / static_cast<double>(now.done_here);
    text += fmt::format(", {:.0f} x real time, {} left", now.task_seconds / per_task,
                        clock_text(per_task * static_cast<double>(now.tasks - now.done)));
  }
  return text + fmt::format(", {} failed", now.failed);
}

void write_summary(const SoakOptions& options, const CampaignReport& report) {
  const CampaignProgress& done = report.progress;
  const double here = static_cast<double>(done.done_here) * done.task_seconds;
  const nlohmann::ordered_json summary{
      {"complete", report.complete},
      {"seed", options.seed},
      {"faults", options.faults},
      {"tasks", done.tasks},
      {"tasks_done", done.done},
      {"tasks_failed", done.failed},
      {"failed_tasks", report.failed_tasks},
      {"simulated_hours", static_cast<double>(done.done) * done.task_seconds / kHour},
      {"this_session",
       {{"jobs", options.jobs},
        {"tasks_done", done.done_here},
        {"wall_seconds", done.wall_seconds},
        {"rate_against_real_time", done.wall_seconds > 0.0 ? here / done.wall_seconds : 0.0}}},
      {"largest",
       {{"energy_error", report.largest_energy_error},
        {"house_speed", report.largest_house_speed},
        {"sidelead", report.largest_sidelead}}},
      {"trips", report.trips},
      {"play_crossings", report.play_crossings}};
  write_whole_file(options.out / "summary.json", summary.dump(2) + "\n");
}

int run_all(SoakOptions options, const SoakPlan& plan) {
  if (options.out.empty()) options.out = fmt::format("soak-{}{}", options.seed, options.faults ? "-faults" : "");
  CampaignSettings settings;
  settings.plan = plan;
  const double task_seconds = static_cast<double>(plan.settings.ranges.duration) / 1e9;
  settings.task_count = static_cast<std::int64_t>(std::ceil(options.hours * kHour / task_seconds - 1e-9));
  settings.jobs = options.jobs;
  settings.out = options.out;
  settings.command = repeating_command(options);

  StatusLine line(std::cout, ::isatty(STDOUT_FILENO) == 1, kLineInterval);
  CampaignHooks hooks;
  hooks.stop = common::stop_requested;
  hooks.progress = [&](const CampaignProgress& now) { line.show(now.wall_seconds, progress_text(now), now.done == now.tasks); };
  hooks.failure = [&](const std::string& text) {
    line.clear();
    std::printf("FAILED %s", text.c_str());
    std::fflush(stdout);
  };
  const CampaignReport report = run_campaign(settings, hooks);
  line.clear();
  write_summary(options, report);
  const CampaignProgress& done = report.progress;
  std::printf("%s: %.2f simulated hours in %lld tasks, %lld failed\n", report.complete ? "complete" : "interrupted",
              static_cast<double>(done.done) * done.task_seconds / kHour, static_cast<long long>(done.done),
              static_cast<long long>(done.failed));
  std::printf("this session: %lld tasks in %s, %.0f x real time with %d job%s\n",
              static_cast<long long>(done.done_here), clock_text(done.wall_seconds).c_str(),
              done.wall_seconds > 0.0 ? static_cast<double>(done.done_here) * done.task_seconds / done.wall_seconds : 0.0,
              options.jobs, options.jobs == 1 ? "" : "s");
  std::printf("largest: energy error %.2g %% of what was turned over, house %.4f rad/s, sidelead %.1f deg; %lld trips, %lld "
              "crossings of the play\n",
              100.0 * report.largest_energy_error, report.largest_house_speed, report.largest_sidelead / kDegree,
              static_cast<long long>(report.trips), static_cast<long long>(report.play_crossings));
  if (done.failed > 0) std::printf("failures: %s\n", (options.out / "failures").c_str());
  if (!report.complete) {
    std::printf("the same command goes on from here\n");
    if (common::stop_requested()) return common::stop_exit_code();
  }
  return done.failed > 0 ? 1 : 0;
}

struct TaskRange {
  std::int64_t first = 0, last = 0;
};

TaskRange task_range(const std::string& text) {
  TaskRange range;
  const char* const end = text.data() + text.size();
  auto [rest, error] = std::from_chars(text.data(), end, range.first);
  range.last = range.first;
  if (error == std::errc{} && rest != end && *rest == '-') {
    const auto second = std::from_chars(rest + 1, end, range.last);
    rest = second.ptr;
    error = second.ec;
  }
  if (error != std::errc{} || rest != end || range.first < 0 || range.last < range.first) {
    common::InputProblems problems;
    problems.push_back({{"--task " + text, 0, 0}, "", "'" + text + "'", "a task's number, or FIRST-LAST"});
    throw common::InputError(problems);
  }
  return range;
}

// One after the other in this process, logs kept.
int run_tasks(SoakOptions options, const SoakPlan& plan) {
  const TaskRange range = task_range(options.task);
  if (options.out.empty()) options.out = fmt::format("soak-{}-task-{}", options.seed, options.task);
  const std::string command = repeating_command(options) + " " + options.task;
  WorkerMemory memory;
  bool broken = false;
  for (std::int64_t number = range.first; number <= range.last; ++number) {
    const fs::path folder = range.first == range.last ? options.out : options.out / fmt::format("task-{:06}", number);
    TaskResult result = run_task(plan, number, folder, common::stop_requested);
    if (!result.complete) return common::stop_exit_code();
    memory.look(plan.settings.limits, result);
    keep_configuration(plan, number, folder);
    if (result.violations.empty()) {
      std::printf("good: task %lld: %s\n", static_cast<long long>(number), result.description.c_str());
    } else {
      broken = true;
      const std::string text = failure_text(result, plan, command);
      write_whole_file(folder / "failure.txt", text);
      std::printf("FAILED %s", text.c_str());
    }
    std::printf("  digest %016llx, log %s\n", static_cast<unsigned long long>(result.log_digest),
                (folder / "run.lcmlog").c_str());
    std::fflush(stdout);
  }
  return broken ? 1 : 0;
}

}  // namespace

int soak(const SoakOptions& options) {
  try {
    const SoakPlan plan = plan_of(options);
    if (!options.out.empty()) make_output_folder(options.out);
    common::catch_stop_signals();
    return options.task.empty() ? run_all(options, plan) : run_tasks(options, plan);
  } catch (const common::InputError&) {
    throw;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab soak: %s\n", error.what());
    return 1;
  }
}

}  // namespace slewlab::tools
