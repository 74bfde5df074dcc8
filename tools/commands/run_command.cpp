#include "tools/commands/run_command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/input_error.h"
#include "controller/controller_file.h"
#include "msgs/configuration_hash.h"
#include "msgs/lcm_bus.h"
#include "msgs/run_identity.h"
#include "msgs/run_log.h"
#include "sim/drive/fault_expectation.h"
#include "sim/drive/scenario_file.h"
#include "tools/commands/check_command.h"
#include "tools/commands/child_process.h"
#include "tools/commands/home.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/plant_task.h"
#include "tools/commands/private_network.h"
#include "tools/commands/python_command.h"
#include "tools/commands/resolved_configuration.h"
#include "tools/commands/run_facts.h"
#include "tools/commands/status_line.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using WallClock = std::chrono::steady_clock;

constexpr int kNotAsExpected = 1;  // exit code

// Wall clock that a side gets to end after it was asked to, before it is killed.
constexpr std::chrono::seconds kEndPatience{5};
constexpr const char* kFmuController = "controller_fmu.py";
constexpr const char* kUnpackedFmu = "controller_fmu.partial";  // in the run's folder, while the run goes on
constexpr double kStalled = 2.0;            // [s] without progress, until that is said
constexpr std::string_view kPlayCompensation = "play_compensation ";  // what is switched, as desk, plant and controller say it
constexpr std::string_view kToController = "controller ";
constexpr std::size_t kMostOfALine = 120;  // characters of what the controller said
constexpr std::size_t kMostLines = 3;      // of it, behind a run
constexpr double kStalledSilently = 10.0;    // [s] of it where no progress is wanted and the controller said nothing
constexpr double kLineInterval = 2.0;       // [s] between progress lines where there is no terminal

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

// One run at a time writes into a folder; the lock goes with the process.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (fd_ < 0) throw std::runtime_error("cannot open " + folder.string() + ": " + std::strerror(errno));
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd_);
      throw std::runtime_error("another run is writing into " + folder.string() + "; give this one another --out");
    }
  }
  ~FolderLock() { ::close(fd_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_;
};

// The signals that concern a run, as something to poll.
class Signals {
 public:
  Signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&set, number);
    sigprocmask(SIG_BLOCK, &set, &before_);
    fd_ = ::signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    if (fd_ < 0) throw std::runtime_error(std::string("no signalfd: ") + std::strerror(errno));
  }
  ~Signals() {
    ::close(fd_);
    sigprocmask(SIG_SETMASK, &before_, nullptr);
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  int fd() const { return fd_; }
  std::optional<int> next() const {
    signalfd_siginfo info{};
    if (::read(fd_, &info, sizeof info) != sizeof info) return std::nullopt;
    return static_cast<int>(info.ssi_signo);
  }

 private:
  sigset_t before_;
  int fd_ = -1;
};

class ProgressDisplay {
 public:
  ProgressDisplay(Progress mode, std::string name)
      : mode_(mode),
        name_(std::move(name)),
        line_(std::cout, mode == Progress::automatic && ::isatty(STDOUT_FILENO) == 1, mode == Progress::lines ? 0.0 : kLineInterval) {}

  // A line of the plant: "progress SIMULATED OF RESENDS". `controller`: whom it waits for.
  void update(const std::string& line, const ChildProcess& controller) {
    double simulated = 0.0;
    double whole = 0.0;
    long long resends = 0;
    std::string progress;
    if (!(std::istringstream(line) >> progress >> simulated >> whole >> resends) || progress != "progress") return;
    const double now = std::chrono::duration<double>(WallClock::now() - begin_).count();
    if (simulated > simulated_) last_advance_ = now;
    simulated_ = simulated;
    if (mode_ == Progress::none) {
      tell_stall(now - last_advance_, resends, controller);
      return;
    }
    std::string text = fmt::format("{}: {:.1f} of {:.1f} s simulated, {:.0f} times real time", name_, simulated, whole,
                                   now > 0.0 ? simulated / now : 0.0);
    if (now - last_advance_ > kStalled) text += waiting_text(now - last_advance_, resends, controller);
    line_.show(now, text, simulated >= whole);
  }
  static std::string waiting_text(double seconds, long long resends, const ChildProcess& controller) {
    std::string text = fmt::format(", waiting for the controller for {:.0f} s", seconds);
    if (resends > 0) text += fmt::format(", asked again {} times", resends);
    if (!controller.last_words().empty()) text += "; it said last: " + controller.last_words().back().substr(0, kMostOfALine);
    return text;
  }
  void keep() { line_.keep(); }

 private:
  // A run that waits for somebody is no progress: it is said once, on standard error, even where none is wanted.
  void tell_stall(double seconds, long long resends, const ChildProcess& controller) {
    if (is_stall_told_ || seconds < (controller.last_words().empty() ? kStalledSilently : kStalled)) return;
    is_stall_told_ = true;
    std::fprintf(stderr, "%s: %.1f s simulated%s\n", name_.c_str(), simulated_, waiting_text(seconds, resends, controller).c_str());
  }

  Progress mode_;
  std::string name_;
  StatusLine line_;
  WallClock::time_point begin_ = WallClock::now();
  double last_advance_ = 0.0;  // [s] since then
  double simulated_ = 0.0;
  bool is_stall_told_ = false;
};

struct Outcome {
  enum class Kind { complete, failed, interrupted } kind = Kind::complete;
  std::string reason;  // of a failure, one line
  const ChildProcess* failed_side = nullptr;
  int signal_number = 0;
};

// Both sides from their start to their end.
class Run {
 public:
  Run(ChildProcess& plant, ChildProcess& controller, ProgressDisplay& display, const Signals& signals, bool steered, bool is_switchable)
      : plant_(plant), controller_(controller), display_(display), signals_(signals), listens_(steered), is_switchable_(is_switchable) {}

  Outcome watch() {
    while (true) {
      wait(std::chrono::milliseconds{1000});
      read_output();
      pass_steering_on();
      while (const auto number = signals_.next()) {
        if (*number != SIGCHLD) {
          outcome_.kind = Outcome::Kind::interrupted;
          outcome_.signal_number = *number;
          pass_on(*number);
          end_both();
          return outcome_;
        }
      }
      if (plant_.ended()) {
        if (!plant_.succeeded()) fail(plant_);
        // The plant's end is the run's end; the controller is told, and how it takes it is its own affair.
        end_both();
        tell_when();
        return outcome_;
      }
      if (controller_.ended() && !killed_on_purpose_) {
        fail(controller_);
        end_both();
        tell_when();
        return outcome_;
      }
    }
  }

  const Json& plant_summary() const { return plant_summary_; }

 private:
  void fail(const ChildProcess& side) {
    outcome_.kind = Outcome::Kind::failed;
    outcome_.failed_side = &side;
    outcome_.reason = "the " + side.name() + " ended before its time: " + side.how_it_ended();
  }

  // The plant says at its end how far it came; of one that died nobody knows.
  void tell_when() {
    if (outcome_.kind != Outcome::Kind::failed || !plant_summary_.is_object()) return;
    outcome_.reason += fmt::format(" at {:.1f} s of simulated time", plant_summary_.value("simulated_seconds", 0.0));
  }

  void pass_on(int number) {
    if (!plant_.ended()) plant_.send(number);
    if (!controller_.ended()) controller_.send(number);
  }

  void end_both() {
    if (!plant_.ended()) plant_.send(SIGTERM);
    if (!controller_.ended()) controller_.send(SIGTERM);
    const auto deadline = WallClock::now() + kEndPatience;
    while (!(plant_.ended() && controller_.ended())) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - WallClock::now());
      bool hurry = left.count() <= 0;
      if (!hurry) wait(left);
      while (const auto number = signals_.next()) hurry = hurry || *number != SIGCHLD;  // a second Ctrl-C
      read_output();
      if (hurry) {
        if (!plant_.ended()) plant_.send(SIGKILL);
        if (!controller_.ended()) controller_.send(SIGKILL);
      }
    }
    read_output();
  }

  // What the desk says, to the plant; the desk's end is told, and the plant brings the crane to rest.
  void pass_steering_on() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (!listens_ || ::poll(&input, 1, 0) <= 0) return;
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count < 0) return;
    if (count == 0) {
      listens_ = false;
      plant_.tell("lost");
      return;
    }
    unfinished_.append(bytes, static_cast<std::size_t>(count));
    for (std::size_t end; (end = unfinished_.find('\n')) != std::string::npos;) {
      pass_line_on(unfinished_.substr(0, end));
      unfinished_.erase(0, end + 1);
    }
  }

  void pass_line_on(const std::string& line) {
    if (!line.starts_with(kPlayCompensation) || is_switchable_) {
      plant_.tell(line);
      return;
    }
    std::printf("steering refused play compensation: only slewlab's own controller can be told to switch it\n");
    std::fflush(stdout);
  }

  // What is switched is told to the controller, to one that was started anew all of it; the plant hears that it is known.
  void tell_switches(std::size_t from) {
    for (std::size_t i = from; i < switches_.size(); ++i) controller_.tell(switches_[i]);
    awaited_ = from < switches_.size() ? switches_.back() : "";
    if (awaited_.empty()) plant_.tell("done");
  }
  void switch_controller(const std::string& line) {
    switches_.push_back(line);
    tell_switches(killed_on_purpose_ ? switches_.size() : switches_.size() - 1);
  }

  void wait(std::chrono::milliseconds patience) {
    pollfd fds[] = {{signals_.fd(), POLLIN, 0},
                    {listens_ ? STDIN_FILENO : -1, POLLIN, 0},
                    {plant_.output_fd(), POLLIN, 0},
                    {plant_.complaint_fd(), POLLIN, 0},
                    {controller_.output_fd(), POLLIN, 0},
                    {controller_.complaint_fd(), POLLIN, 0}};
    ::poll(fds, std::size(fds), static_cast<int>(patience.count()));
  }

  void read_output() {
    plant_.read_output([this](const std::string& line) {
      if (line.rfind("summary ", 0) == 0) {
        plant_summary_ = Json::parse(line.substr(8), nullptr, false);
      } else if (line.rfind("steering ", 0) == 0) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
      } else if (line == "controller kill") {
        controller_.kill();
        killed_on_purpose_ = true;
        plant_.tell("done");
      } else if (line == "controller start") {
        controller_.start_again();
        restarted_guards_.emplace_back(std::vector<pid_t>{controller_.pid()});
        killed_on_purpose_ = false;
        tell_switches(0);
      } else if (line == "controller stop") {
        controller_.halt();
      } else if (line == "controller continue") {
        controller_.go_on();
      } else if (line.starts_with(kToController) && line.substr(kToController.size()).starts_with(kPlayCompensation)) {
        switch_controller(line.substr(kToController.size()));
      } else {
        display_.update(line, controller_);
      }
    });
    controller_.read_output([this](const std::string& line) {
      if (awaited_.empty() || line != awaited_) return;
      awaited_.clear();
      plant_.tell("done");
    });
  }

  ChildProcess& plant_;
  ChildProcess& controller_;
  ProgressDisplay& display_;
  const Signals& signals_;
  bool listens_;            // to what a desk says on standard input
  bool is_switchable_;      // the controller, while it runs
  std::vector<std::string> switches_;  // so far, as the controller is told them
  std::string awaited_;                // what it has to say before the plant goes on
  std::string unfinished_;  // line of it
  Outcome outcome_;
  Json plant_summary_ = nullptr;
  bool killed_on_purpose_ = false;  // the controller, by the scenario
  std::deque<GroupGuard> restarted_guards_;
};

const char* to_string(Outcome::Kind kind) {
  switch (kind) {
    case Outcome::Kind::complete: return "complete";
    case Outcome::Kind::failed: return "failed";
    case Outcome::Kind::interrupted: return "interrupted";
  }
  return "unknown";
}

RunOutcome run_outcome(const Outcome& outcome, const Json& plant_summary) {
  RunOutcome result;
  result.end = outcome.reason.empty() ? to_string(outcome.kind) : outcome.reason;
  if (!plant_summary.is_object()) return result;
  result.simulated_time = plant_summary.value("simulated_seconds", 0.0);
  result.wall_time = plant_summary.value("wall_seconds", 0.0);
  result.cycles = plant_summary.value("lockstep_cycles", plant_summary.value("controller_cycles", std::int64_t{0}));
  result.resends = plant_summary.value("resends", std::int64_t{0});
  return result;
}

// How well the wall clock was kept, for people; summary.json has it all.
void print_timing(const Json& summary) {
  if (!summary.is_object() || !summary.contains("realtime")) return;
  const Json& timing = summary["realtime"];
  std::printf("  %s\n", timing.value("permissions", "").c_str());
  for (const char* what : {"wakeup_latency", "step_time"}) {
    const Json& histogram = timing[what];
    std::printf("  %s: median %.1f us, 99.9 %% %.1f us, largest %.1f us\n", what, histogram.value("p50", 0.0),
                histogram.value("p99_9", 0.0), histogram.value("largest", 0.0));
  }
  std::printf("  missed deadlines: %lld, by the plant's own computation: %lld; stale commands: %lld\n",
              timing.value("missed_deadlines", 0LL), timing.value("missed_by_own_computation", 0LL),
              summary["drive"].value("stale_commands", 0LL));
}

// What of the motion is not as its laws have it, for people.
void tell_unsolved(const Json& plant_summary, const std::string& name) {
  if (!plant_summary.is_object() || !plant_summary.contains("unsolved_frictions")) return;
  std::fprintf(stderr, "%s: warning: in %lld plant steps, or parts of them, the frictions do not hold to their law: their equations were not solved. Try a shorter plant_step\n", name.c_str(),
               plant_summary.value("unsolved_frictions", 0LL));
}

// What did not come about of what the scenario says under `expect:`; nothing where it says nothing.
std::optional<std::vector<std::string>> judge(const sim::Scenario& scenario, const fs::path& log) {
  if (scenario.expectation == sim::FaultExpectation{}) return std::nullopt;
  return sim::broken_expectations(scenario.expectation, msgs::read_run_logs(log).runs.front());
}

// How the run ended, for people; the exit code.
int tell_outcome(const Outcome& outcome, const std::string& name, const fs::path& log, const fs::path& kept) {
  switch (outcome.kind) {
    case Outcome::Kind::complete:
      std::printf("%s: complete, log %s\n", name.c_str(), log.c_str());
      return 0;
    case Outcome::Kind::interrupted:
      std::fprintf(stderr, "%s: ended by signal %d (%s); %s\n", name.c_str(), outcome.signal_number, strsignal(outcome.signal_number),
                   fs::exists(kept) ? ("the log so far is " + kept.string()).c_str() : "before anything was logged");
      return 128 + outcome.signal_number;
    case Outcome::Kind::failed: break;
  }
  std::fprintf(stderr, "%s: %s\n", name.c_str(), outcome.reason.c_str());
  const auto& words = outcome.failed_side->last_words();
  std::fprintf(stderr, words.empty() ? "it said nothing on its standard error\n" : "its last words:\n");
  for (const std::string& line : words) std::fprintf(stderr, "  %s\n", line.c_str());
  if (fs::exists(kept)) std::fprintf(stderr, "the log so far is %s\n", kept.c_str());
  return 1;
}

// A scenario that was steered at the desk includes the one beside it, which another run would write over.
void keep_what_was_steered(const fs::path& folder) {
  if (!fs::exists(folder / "steered.yaml")) return;
  throw common::InputError({{{"--out", 0, 0}, "", "'" + folder.string() + "', whose steered.yaml repeats what was steered there and builds on the run's files",
                             "another folder, or steered.yaml taken away"}});
}

// What an FMU's process unpacked of it goes with the run, however that process ended; of a run that was killed with the next one.
struct UnpackedFmu {
  fs::path folder;
  explicit UnpackedFmu(const fs::path& of_run) : folder(of_run / kUnpackedFmu) { fs::remove_all(folder); }
  ~UnpackedFmu() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  UnpackedFmu(const UnpackedFmu&) = delete;
  UnpackedFmu& operator=(const UnpackedFmu&) = delete;
};

// The controller in people's words, as summary.json and run.json have it; empty where it is slewlab's own.
std::string controller_words(const RunOptions& options) {
  return options.controller_fmu.empty() ? options.controller_command : "FMU " + options.controller_fmu.string();
}

std::string milliseconds_text(std::int64_t time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", static_cast<double>(time) / 1e6);
  return text;
}

// What controller_fmu.py is called with.
std::vector<std::string> fmu_arguments(const RunOptions& options, const sim::Scenario& scenario) {
  return {options.controller_fmu.string(), "--groups", std::to_string(scenario.crane.parameters.drive.group_count), "--period-ms",
          milliseconds_text(scenario.controller_period)};
}

std::vector<std::string> controller_program(const RunOptions& options, const sim::Scenario& scenario, const fs::path& programs, const fs::path& folder) {
  if (!options.controller_fmu.empty()) {
    std::vector<std::string> command{python_interpreter().string(), (home() / "tools" / "python" / kFmuController).string()};
    const std::vector<std::string> arguments = fmu_arguments(options, scenario);
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--unpack-in", (folder / kUnpackedFmu).string()});
    return command;
  }
  if (!options.controller_command.empty()) return {"/bin/sh", "-c", options.controller_command};
  std::vector<std::string> command{(programs / "slewlab-controller").string()};
  if (options.steered) command.emplace_back("--steered");
  return command;
}

// The log of a plant of one's own becomes the run's, or the run has failed. Answers with the summary.
Json take_over_log(const fs::path& log, const sim::Scenario& scenario, double wall_seconds, const ChildProcess& plant, Outcome& outcome) {
  const fs::path unfinished = log.string() + ".partial";
  try {
    Json summary = own_plant_summary(unfinished, scenario);
    summary["wall_seconds"] = wall_seconds;
    fs::rename(unfinished, log);
    return summary;
  } catch (const std::runtime_error& error) {
    outcome.kind = Outcome::Kind::failed;
    outcome.failed_side = &plant;
    outcome.reason = error.what();
    return nullptr;
  }
}

// A scenario as it is run: resolved and written into the run's folder.
struct Prepared {
  fs::path folder, log;
  fs::path scenario_file;
  sim::Scenario scenario;
  std::optional<controller::ControllerSettings> controller;  // nothing where a controller of one's own has a file of its own kind
  std::string bus;
};

Prepared prepare(const fs::path& folder, const RunOptions& options, const std::string& bus) {
  Prepared run{.folder = folder, .log = folder / "run.lcmlog", .scenario_file = {}, .scenario = {}, .controller = {}, .bus = bus};
  run.scenario_file = write_resolved_configuration(options.scenario, options.overrides, folder);
  run.scenario = sim::load_scenario_file(run.scenario_file);
  try {
    run.controller = controller::load_controller_file(folder / "controller.yaml").settings;
    run.controller->period = static_cast<double>(run.scenario.controller_period) / 1e9;
  } catch (const common::InputError&) {
    if (controller_words(options).empty()) throw;
  }
  return run;
}

std::string speed_text(const RunOptions& options) {
  char speed[32];
  std::snprintf(speed, sizeof speed, "%.9g", options.speed);
  return speed;
}

// Whether play compensation can be switched while the run goes on.
bool is_switchable(const RunOptions& options) { return options.steered && controller_words(options).empty(); }

ChildOptions controller_child(const RunOptions& options, const Prepared& run, const fs::path& programs) {
  ChildOptions child;
  child.name = "controller";
  child.command = controller_program(options, run.scenario, programs, run.folder);
  child.listens = is_switchable(options);
  child.environment = {{"SLEWLAB_BUS", run.bus},
                       {"LCM_DEFAULT_URL", run.bus},
                       {"SLEWLAB_CONTROLLER_CONFIG", fs::absolute(run.folder / "controller.yaml").string()},
                       {"SLEWLAB_CONTROLLER_PERIOD_MS", milliseconds_text(run.scenario.controller_period)},
                       {"SLEWLAB_PYTHON_MESSAGES", python_messages().string()}};
  if (options.realtime) child.environment.emplace_back("SLEWLAB_REALTIME_SPEED", speed_text(options));
  if (!options.controller_fmu.empty()) {
    for (const auto& variable : python_environment()) child.environment.push_back(variable);
  }
  return child;
}

ChildOptions plant_child(const RunOptions& options, const Prepared& run, const fs::path& programs) {
  ChildOptions child;
  child.name = "plant";
  if (!options.plant_command.empty()) {
    child.command = {"/bin/sh", "-c", options.plant_command};
    child.environment = {{"SLEWLAB_BUS", run.bus},
                         {"LCM_DEFAULT_URL", run.bus},
                         {"SLEWLAB_PLANT_TASK", fs::absolute(write_plant_task(run.folder, run.scenario, run.bus, run.log.string() + ".partial")).string()},
                         {"SLEWLAB_PYTHON_MESSAGES", python_messages().string()}};
    return child;
  }
  child.listens = true;
  child.command = {(programs / "slewlab-plant").string(), "--scenario", run.scenario_file.string(), "--bus", run.bus, "--log", run.log.string(),
                   "--run-identity", msgs::hash_text(msgs::run_identity(msgs::configuration_hash(run.scenario.configuration_text)))};
  if (options.realtime) child.command.insert(child.command.end(), {"--realtime", "--speed", speed_text(options)});
  if (options.steered) child.command.push_back("--steered");
  return child;
}

// How a run went, as summary.json has it.
Json summary_of(const RunOptions& options, const Outcome& outcome, const fs::path& kept, const Json& plant_summary, const ChildProcess& plant,
                const ChildProcess& controller, const std::optional<std::vector<std::string>>& broken) {
  Json summary{
      {"scenario", fs::absolute(options.scenario).lexically_normal().string()},
      {"outcome", to_string(outcome.kind)},
      {"reason", outcome.reason},
      {"controller_command",
       controller_words(options).empty() ? "slewlab-controller" : controller_words(options)},
      {"network", in_private_network() ? "private" : "as found"},
      {"log", fs::exists(kept) ? kept.filename().string() : ""},
      {"run", plant_summary},
      {"plant_end", plant.how_it_ended()},
      {"controller_end", controller.how_it_ended()}};
  if (!options.plant_command.empty()) summary["plant_command"] = options.plant_command;
  if (broken) summary["broken_expectations"] = *broken;
  return summary;
}

// Answers with what went wrong, or nothing: a disk that is full for the log is full for these, too, and the run's own end is told first.
std::string write_outcome(const Prepared& run, const RunOptions& options, const Outcome& outcome, const Json& plant_summary, const Json& summary,
                          const ChildProcess& plant, const ChildProcess& controller) {
  try {
    write_whole_file(run.folder / "plant.txt", plant.complaints());
    write_whole_file(run.folder / "controller.txt", controller.complaints());
    write_whole_file(run.folder / "summary.json", summary.dump(2) + "\n");
    RunOutcome facts = run_outcome(outcome, plant_summary);
    if (!controller_words(options).empty()) facts.controller_command = controller_words(options);
    write_run_facts(run.folder, run.scenario, run.controller, facts);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

// What the controller had to complain about, a link that it lost among it: the last of it, for people.
void tell_complaints(const ChildProcess& controller, const std::string& name, const fs::path& folder) {
  const std::deque<std::string>& words = controller.last_words();
  if (words.empty()) return;
  std::printf("%s: the controller said (%s):\n", name.c_str(), (folder / "controller.txt").c_str());
  for (std::size_t i = words.size() - std::min(kMostLines, words.size()); i < words.size(); ++i) std::printf("  %s\n", words[i].c_str());
}

// Whether what the scenario expects came about, for people; the exit code.
int tell_expected(const std::vector<std::string>& broken, const std::string& name, bool realtime) {
  if (broken.empty()) std::printf("%s: everything under expect: of the scenario came about\n", name.c_str());
  for (const std::string& line : broken) std::fprintf(stderr, "%s: not as expected: %s\n", name.c_str(), line.c_str());
  // Counts to the message are lockstep's; against the wall clock they depend on the machine.
  return broken.empty() || realtime ? 0 : kNotAsExpected;
}

int run_in(const fs::path& folder, const RunOptions& options, const std::string& name) {
  const FolderLock lock(folder);
  keep_what_was_steered(folder);
  remove_earlier_run(folder);
  const UnpackedFmu unpacked(folder);
  const msgs::ReservedPort port;
  const fs::path programs = own_folder();
  const Prepared prepared = prepare(folder, options, msgs::bus_url(port.number()));
  const ChildOptions controller_options = controller_child(options, prepared, programs);
  const ChildOptions plant_options = plant_child(options, prepared, programs);
  RunOutcome under_way;  // for whoever looks on
  under_way.end = "under way";
  if (!controller_words(options).empty()) under_way.controller_command = controller_words(options);
  write_run_facts(folder, prepared.scenario, prepared.controller, under_way);

  const Signals signals;
  ChildProcess controller(controller_options);
  ChildProcess plant(plant_options);
  const GroupGuard guard({plant.pid(), controller.pid()});
  std::printf("%s: plant is process %d, controller is process %d, bus %s\n", name.c_str(), plant.pid(), controller.pid(), prepared.bus.c_str());
  std::fflush(stdout);
  ProgressDisplay display(options.progress, name);
  Run run(plant, controller, display, signals, options.steered, is_switchable(options));
  const WallClock::time_point begin = WallClock::now();
  Outcome outcome = run.watch();
  display.keep();
  Json plant_summary = run.plant_summary();
  if (!options.plant_command.empty() && outcome.kind == Outcome::Kind::complete) {
    const double wall_seconds = std::chrono::duration<double>(WallClock::now() - begin).count();
    plant_summary = take_over_log(prepared.log, prepared.scenario, wall_seconds, plant, outcome);
  }

  const fs::path kept = fs::exists(prepared.log) ? prepared.log : fs::path(prepared.log.string() + ".partial");
  std::optional<std::vector<std::string>> broken;
  if (outcome.kind == Outcome::Kind::complete) broken = judge(prepared.scenario, prepared.log);
  const Json summary = summary_of(options, outcome, kept, plant_summary, plant, controller, broken);
  const std::string unwritten = write_outcome(prepared, options, outcome, plant_summary, summary, plant, controller);

  int code = tell_outcome(outcome, name, prepared.log, kept);
  if (outcome.kind == Outcome::Kind::complete) tell_complaints(controller, name, folder);
  if (outcome.kind == Outcome::Kind::complete && options.realtime) print_timing(plant_summary);
  tell_unsolved(plant_summary, name);
  if (broken) code = tell_expected(*broken, name, options.realtime);
  if (unwritten.empty()) return code;
  std::fprintf(stderr, "%s: %s\n", name.c_str(), unwritten.c_str());
  return code == 0 ? 1 : code;
}

}  // namespace

bool can_be_run_by_others(const RunOptions& options) {
  if (options.controller_fmu.empty() && options.plant_command.empty()) return true;
  const sim::Scenario scenario = sim::load_scenario_file(options.scenario, options.overrides);
  if (!options.plant_command.empty()) {
    std::string why = why_not_by_another_plant(scenario);
    if (options.realtime) why = "it keeps lockstep's time alone: --realtime is for slewlab's own plant";
    if (options.steered) why = "--steered is for slewlab's own plant";
    if (!why.empty()) {
      std::fprintf(stderr, "%s: not by a plant of one's own (--plant): %s\n", options.scenario.c_str(), why.c_str());
      return false;
    }
  }
  if (options.controller_fmu.empty()) return true;
  std::vector<std::string> arguments = fmu_arguments(options, scenario);
  arguments.push_back("--check");
  return call_python(kFmuController, arguments) == 0;
}

int run_scenario(const RunOptions& options, const std::vector<std::string>& command_line) {
  const std::string name = options.scenario.stem().string();
  const fs::path folder = options.out.empty() ? fs::path("runs") / name : options.out;
  try {
    const ControllerBy by = controller_words(options).empty() ? ControllerBy::slewlab : ControllerBy::user;
    if (const common::InputProblems other = problems_of_another_kind(options.scenario, "scenario"); !other.empty()) throw common::InputError(other);
    const FileFindings found = examine(options.scenario, options.overrides, by);
    if (!found.problems.empty()) {
      complain(found.problems, std::cerr);
      return 2;
    }
    if (!can_be_run_by_others(options)) return 2;
    need_multicast(command_line);
    warn(found.warnings, std::cerr);
    make_output_folder(folder);
    return run_in(folder, options, name);
  } catch (const common::InputError& error) {
    complain(error.problems(), std::cerr);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab: %s\n", error.what());
    return 1;
  }
}

}  // namespace slewlab::tools
