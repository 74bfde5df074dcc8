#include "tools/soak/campaign.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <system_error>

#include "common/input_error.h"
#include "common/stop_signal.h"
#include "msgs/configuration_hash.h"
#include "msgs/log_writer.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using WallClock = std::chrono::steady_clock;

constexpr int kPollMilliseconds = 200;
constexpr std::int64_t kWarmTasks = 5;

std::string folder_name(std::int64_t number) { return fmt::format("task-{:06}", number); }

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) / 1e9; }

// All of it, or the reason.
void write_all(int fd, std::string_view text, const fs::path& file) {
  while (!text.empty()) {
    const ssize_t count = ::write(fd, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

// What is in the journal, and its end to write at. One process at a time.
class Journal {
 public:
  Journal(const fs::path& file, const Json& head) : file_(file) {
    fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (fd_ < 0) throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
    try {
      if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
        throw std::runtime_error("another soak is writing " + file.string() + "; give this one another --out");
      }
      read(head);
    } catch (...) {
      ::close(fd_);
      throw;
    }
  }
  ~Journal() { ::close(fd_); }
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  int fd() const { return fd_; }
  const std::vector<Json>& entries() const { return entries_; }

  void append(const Json& entry) {
    entries_.push_back(entry);
    write_all(fd_, entry.dump() + "\n", file_);
  }

 private:
  void read(const Json& head) {
    std::ifstream in(file_, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    // A line without an end was cut off by a kill or a power cut: its task is done again.
    const std::size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (whole != text.size() && ::ftruncate(fd_, static_cast<off_t>(whole)) != 0) {
      throw std::runtime_error("cannot cut " + file_.string() + ": " + std::strerror(errno));
    }
    if (whole == 0) {
      write_all(fd_, head.dump() + "\n", file_);
      return;
    }
    std::size_t begin = 0;
    for (int line = 1; begin < whole; ++line) {
      const std::size_t end = text.find('\n', begin);
      const Json entry = Json::parse(text.substr(begin, end - begin), nullptr, false);
      begin = end + 1;
      if (line == 1) {
        check_head(entry, head);
      } else if (!entry.is_object() || !entry.contains("task") || !entry["task"].is_number_integer()) {
        throw std::runtime_error(fmt::format("{}:{}: not a line of a soak's journal", file_.string(), line));
      } else {
        entries_.push_back(entry);
      }
    }
  }

  void check_head(const Json& found, const Json& head) const {
    const std::string file = file_.string();
    if (!found.is_object() || !found.contains("journal") || found["journal"] != head["journal"]) {
      throw std::runtime_error(file + " is no journal of a soak; give another --out");
    }
    for (const auto& [key, value] : head.items()) {
      if (found.contains(key) && found[key] == value) continue;
      throw std::runtime_error(fmt::format(
          "{} belongs to another campaign: {} is {} there and {} here; go on with the same settings, or give another --out",
          file, key, found.contains(key) ? found[key].dump() : "absent", value.dump()));
    }
  }

  fs::path file_;
  int fd_ = -1;
  std::vector<Json> entries_;
};

Json journal_head(const SoakPlan& plan) {
  return {{"journal", "slewlab soak"},
          {"version", 1},
          {"seed", plan.seed},
          {"faults", plan.faults},
          {"configuration", msgs::hash_text(msgs::configuration_hash(plan_text(plan)))},
          {"task_seconds", seconds(plan.settings.ranges.duration)}};
}

Json to_json(const TaskResult& result) {
  Json violations = Json::array();
  for (const Violation& one : result.violations) {
    violations.push_back({{"invariant", name_of(one.invariant)},
                          {"time", seconds(one.time)},
                          {"count", one.count},
                          {"what", one.what}});
  }
  return {{"task", result.number},
          {"outcome", result.violations.empty() ? "good" : "failed"},
          {"simulated_seconds", seconds(result.simulated_time)},
          {"log_digest", msgs::hash_text(static_cast<std::int64_t>(result.log_digest))},
          {"log_events", result.log_events},
          {"trips", result.trips},
          {"play_crossings", result.play_crossings},
          {"energy_error", result.energy_error},
          {"house_speed", result.house_speed},
          {"sidelead", result.sidelead},
          {"description", result.description},
          {"violations", violations}};
}

// A failed task's folder with all that a person needs.
void keep_failure(const CampaignSettings& settings, const TaskResult& result, const fs::path& running,
                  std::int64_t first_task) {
  const bool over_tasks = std::any_of(result.violations.begin(), result.violations.end(), [](const Violation& one) {
    return one.invariant == Invariant::memory;
  });
  std::string numbers = std::to_string(result.number);
  if (over_tasks && first_task != result.number) numbers = fmt::format("{}-{}", first_task, result.number);
  keep_configuration(settings.plan, result.number, running);
  write_whole_file(running / "failure.txt", failure_text(result, settings.plan, settings.command + " " + numbers));
  const fs::path kept = settings.out / "failures" / folder_name(result.number);
  fs::create_directories(kept.parent_path());
  fs::remove_all(kept);
  fs::rename(running, kept);
}

// The worker's process: one task per line that comes, one line of JSON back. {"error": ...} where it cannot go on.
// Answers with the exit code.
int work(const CampaignSettings& settings, const CampaignHooks& hooks, int socket) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  common::catch_stop_signals();
  WorkerMemory memory;
  std::FILE* orders = ::fdopen(socket, "r");
  char line[32];
  long long number = 0;
  int exit_code = 0;
  while (orders != nullptr && std::fgets(line, sizeof line, orders) != nullptr &&
         std::from_chars(line, line + std::strlen(line), number).ec == std::errc{}) {
    const fs::path running = settings.out / "running" / folder_name(number);
    Json answer;
    try {
      if (hooks.in_worker) hooks.in_worker(number);
      TaskResult result = run_task(settings.plan, number, running, common::stop_requested);
      if (!result.complete) {
        fs::remove_all(running);
        break;
      }
      memory.look(settings.plan.settings.limits, result);
      if (result.violations.empty()) {
        fs::remove_all(running);
      } else {
        keep_failure(settings, result, running, memory.first_task());
      }
      answer = to_json(result);
    } catch (const std::exception& error) {
      answer = {{"error", error.what()}};
      exit_code = 1;
    }
    write_all(socket, answer.dump() + "\n", "the campaign's socket");
    if (exit_code != 0) break;
  }
  return exit_code;
}

struct Worker {
  pid_t pid = -1;
  int socket = -1;
  std::int64_t task = -1;  // under way, -1: idle
  std::string heard;       // of a line that is not whole yet
};

class Campaign {
 public:
  Campaign(const CampaignSettings& settings, const CampaignHooks& hooks)
      : settings_(settings),
        hooks_(hooks),
        journal_(settings.out / "journal.jsonl", journal_head(settings.plan)),
        begin_(WallClock::now()) {
    std::set<std::int64_t> done;
    for (const Json& entry : journal_.entries()) {
      const auto number = entry["task"].get<std::int64_t>();
      if (number >= settings.task_count || !done.insert(number).second) continue;
      count(entry);
    }
    for (std::int64_t number = 0; number < settings.task_count; ++number) {
      if (!done.contains(number)) waiting_.push_back(number);
    }
    report_.progress.tasks = settings.task_count;
    report_.progress.task_seconds = seconds(settings.plan.settings.ranges.duration);
  }
  ~Campaign() { end_workers(); }

  CampaignReport run() {
    const auto jobs = std::min<std::size_t>(static_cast<std::size_t>(settings_.jobs), waiting_.size());
    workers_.resize(jobs);
    for (Worker& worker : workers_) start(worker);
    tell_progress();
    while (error_.empty() && !stop_asked() && report_.progress.done < settings_.task_count) listen();
    end_workers();
    if (!error_.empty()) throw std::runtime_error(error_);
    std::error_code ignored;
    fs::remove_all(settings_.out / "running", ignored);
    tell_progress();
    report_.complete = report_.progress.done == settings_.task_count;
    std::sort(report_.failed_tasks.begin(), report_.failed_tasks.end());
    return report_;
  }

 private:
  bool stop_asked() const { return hooks_.stop && hooks_.stop(); }

  void tell_progress() {
    report_.progress.wall_seconds = std::chrono::duration<double>(WallClock::now() - begin_).count();
    if (hooks_.progress) hooks_.progress(report_.progress);
  }

  void count(const Json& entry) {
    ++report_.progress.done;
    if (entry.value("outcome", "") != "good") {
      ++report_.progress.failed;
      report_.failed_tasks.push_back(entry["task"].get<std::int64_t>());
    }
    report_.largest_energy_error = std::max(report_.largest_energy_error, entry.value("energy_error", 0.0));
    report_.largest_house_speed = std::max(report_.largest_house_speed, entry.value("house_speed", 0.0));
    report_.largest_sidelead = std::max(report_.largest_sidelead, entry.value("sidelead", 0.0));
    report_.trips += entry.value("trips", std::int64_t{0});
    report_.play_crossings += entry.value("play_crossings", std::int64_t{0});
  }

  void take(const Json& entry) {
    journal_.append(entry);
    count(entry);
    ++report_.progress.done_here;
    if (entry.value("outcome", "") == "good" || !hooks_.failure) return;
    std::ifstream in(settings_.out / "failures" / folder_name(entry["task"].get<std::int64_t>()) / "failure.txt");
    hooks_.failure({std::istreambuf_iterator<char>(in), {}});
  }

  void start(Worker& worker) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
      throw std::runtime_error(std::string("cannot start a worker: ") + std::strerror(errno));
    }
    std::fflush(nullptr);  // or the child would write what is buffered a second time
    const pid_t pid = ::fork();
    if (pid < 0) {
      ::close(ends[0]);
      ::close(ends[1]);
      throw std::runtime_error(std::string("cannot start a worker: ") + std::strerror(errno));
    }
    if (pid == 0) {
      for (const Worker& other : workers_) {
        if (other.socket >= 0) ::close(other.socket);
      }
      ::close(ends[0]);
      ::close(journal_.fd());
      int exit_code = 1;
      try {
        exit_code = work(settings_, hooks_, ends[1]);
      } catch (const std::exception&) {
        // The campaign is gone: nobody is left to tell.
      }
      ::_exit(exit_code);
    }
    ::close(ends[1]);
    worker = {pid, ends[0], -1, {}};
    hand_out(worker);
  }

  void hand_out(Worker& worker) {
    worker.task = -1;
    if (waiting_.empty()) return;
    worker.task = waiting_.front();
    waiting_.pop_front();
    // A worker that died meanwhile is noticed where its socket ends.
    const std::string order = std::to_string(worker.task) + "\n";
    [[maybe_unused]] const ssize_t sent = ::send(worker.socket, order.data(), order.size(), MSG_NOSIGNAL);
  }

  void listen() {
    std::vector<pollfd> fds;
    for (const Worker& worker : workers_) fds.push_back({worker.socket, POLLIN, 0});
    ::poll(fds.data(), fds.size(), kPollMilliseconds);
    for (std::size_t i = 0; i < fds.size() && error_.empty(); ++i) {
      if (fds[i].revents != 0) hear(workers_[i]);
    }
    tell_progress();
  }

  void hear(Worker& worker) {
    char buffer[4096];
    const ssize_t count = ::read(worker.socket, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) return take_result_of_lost(worker);
    worker.heard.append(buffer, static_cast<std::size_t>(count));
    for (std::size_t end = worker.heard.find('\n'); end != std::string::npos; end = worker.heard.find('\n')) {
      const Json answer = Json::parse(worker.heard.substr(0, end));
      worker.heard.erase(0, end + 1);
      if (answer.contains("error")) {
        error_ = answer["error"].get<std::string>();
        return;
      }
      take(answer);
      hand_out(worker);
    }
  }

  // A worker that ended by itself: its task is the failure, unless it was asked to end.
  void take_result_of_lost(Worker& worker) {
    int status = 0;
    ::waitpid(worker.pid, &status, 0);
    ::close(worker.socket);
    const std::int64_t number = worker.task;
    worker = {};
    if (number < 0) return;
    const bool told_to_end = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (told_to_end) {
      waiting_.push_front(number);
      if (!stop_asked()) start(worker);
      return;
    }
    TaskResult result;
    result.number = number;
    Findings findings;
    findings.add(Invariant::finished, 0,
                 WIFSIGNALED(status)
                     ? fmt::format("the worker was ended by signal {}, {}", WTERMSIG(status), ::strsignal(WTERMSIG(status)))
                     : fmt::format("the worker ended with exit code {}", WEXITSTATUS(status)));
    result.violations = findings.violations();
    const fs::path running = settings_.out / "running" / folder_name(number);
    fs::create_directories(running);
    keep_failure(settings_, result, running, number);
    take(to_json(result));
    if (!waiting_.empty()) start(worker);
  }

  void end_workers() {
    for (Worker& worker : workers_) {
      if (worker.pid <= 0) continue;
      ::close(worker.socket);
      ::kill(worker.pid, SIGTERM);
      ::waitpid(worker.pid, nullptr, 0);
      worker = {};
    }
  }

  const CampaignSettings& settings_;
  const CampaignHooks& hooks_;
  Journal journal_;
  WallClock::time_point begin_;
  std::deque<std::int64_t> waiting_;
  std::vector<Worker> workers_;
  CampaignReport report_;
  std::string error_;
};

}  // namespace

void WorkerMemory::look(const SoakLimits& limits, TaskResult& result) {
  if (tasks_ == 0) first_task_ = result.number;
  ++tasks_;
  const MemoryUse now = memory_use();
  if (tasks_ <= kWarmTasks) {
    warm_ = now;
    return;
  }
  Findings findings;
  check_memory(limits, warm_, now, fmt::format("after the worker's task number {}", kWarmTasks), result.simulated_time,
               findings);
  result.violations.insert(result.violations.end(), findings.violations().begin(), findings.violations().end());
}

std::string journal_line(const TaskResult& result) { return to_json(result).dump(); }

std::string failure_text(const TaskResult& result, const SoakPlan& plan, const std::string& command) {
  std::string text = fmt::format("soak, seed {}, task {}: {}\n", plan.seed, result.number, result.description);
  for (const Violation& one : result.violations) {
    text += fmt::format("  {} at {:.3f} s: {}", name_of(one.invariant), seconds(one.time), one.what);
    text += one.count > 1 ? fmt::format(" ({} times)\n", one.count) : "\n";
  }
  return text + "again: " + command + "\n";
}

CampaignReport run_campaign(const CampaignSettings& settings, const CampaignHooks& hooks) {
  fs::create_directories(settings.out);
  return Campaign(settings, hooks).run();
}

}  // namespace slewlab::tools
