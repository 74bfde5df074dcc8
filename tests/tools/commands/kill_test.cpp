// kill -9 of either side, of the launcher and of a logger beside them, at seeded moments: the log is readable to its
// last complete message, nothing hangs, no process, socket or file is left, and the folder takes another run.
//
// A moment is a count, never a time: so many ENCODER seen on the bus, so many bytes in the logger's file, as soon as the
// launcher has a child, or as soon as the log has its final name. SLEWLAB_KILL_MOMENTS (12) and SLEWLAB_KILL_SEED (1) are set by tools/kill-test; moment
// k of seed S is drawn from S and k alone, SLEWLAB_KILL_FIRST begins the count elsewhere.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <thread>

#include "msgs/lcm_bus.h"
#include "msgs/log_reader.h"
#include "msgs/messages.h"
#include "msgs/run_log.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using WallClock = std::chrono::steady_clock;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kScenarios = SLEWLAB_SOURCE_DIR "/config/scenarios/";

// Longer than this without an end is a hang, on any machine and under any sanitizer.
constexpr std::chrono::seconds kHang{60};

enum class Victim { plant, controller, launcher, logger };
constexpr std::array kVictimNames{"plant", "controller", "launcher", "logger"};

enum class Manner { lockstep, restarts, realtime };
constexpr std::array kMannerNames{"lockstep", "lockstep, controller restarted on purpose", "wall clock"};

enum class When { at_start, at_count, at_end };

struct Moment {
  Victim victim = Victim::plant;
  Manner manner = Manner::lockstep;
  When when = When::at_count;
  std::int64_t count = 0;  // ENCODER on the bus; for the logger bytes in its file
};

// Of the manner's scenario, in ENCODER. A run that is to be struck by a count is much longer than any count drawn.
std::int64_t cycles_of(const Moment& moment) {
  const bool to_its_end = moment.when == When::at_end || moment.victim == Victim::logger;
  switch (moment.manner) {
    case Manner::lockstep:
    case Manner::restarts: return to_its_end ? 5'000 : 1'000'000;
    case Manner::realtime: return to_its_end ? 400 : 100'000;
  }
  return 0;
}

Moment draw(std::uint64_t seed, std::uint64_t number) {
  std::seed_seq sequence{seed, number};
  std::mt19937_64 random(sequence);
  const auto below = [&](std::int64_t limit) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(limit));
  };
  Moment moment;
  moment.victim = static_cast<Victim>(number % kVictimNames.size());  // each in its turn
  const std::int64_t manner = below(5);
  moment.manner = manner == 0 ? Manner::realtime : manner == 1 ? Manner::restarts : Manner::lockstep;
  const std::int64_t when = below(8);
  moment.when = when == 0 ? When::at_start : when == 1 ? When::at_end : When::at_count;
  const std::int64_t limit = moment.victim == Victim::logger        ? 60'000
                             : moment.manner == Manner::lockstep ? 8'000
                             : moment.manner == Manner::restarts ? 3'000
                                                                 : 300;
  moment.count = below(limit);
  return moment;
}

std::string to_text(const Moment& moment) {
  const auto victim = static_cast<std::size_t>(moment.victim);
  const std::string text =
      std::string(kVictimNames[victim]) + ", " + kMannerNames[static_cast<std::size_t>(moment.manner)];
  switch (moment.when) {
    case When::at_start: return text + ", at its start";
    case When::at_end: return text + ", at the run's end";
    case When::at_count: break;
  }
  return text + ", at " + std::to_string(moment.count) +
         (moment.victim == Victim::logger ? " bytes of its log" : " ENCODER");
}

std::vector<std::string> command_of(const Moment& moment, const fs::path& out) {
  constexpr std::int64_t kCyclesPerSecond = 100;  // of both scenarios
  const std::string scenario = moment.manner == Manner::restarts ? "faults/controller_restarted.yaml" : "thesis_slew.yaml";
  std::vector<std::string> command{kSlewlab, "run", kScenarios + scenario, "--out", out.string(), "--progress", "lines",
                                   "--set", "duration=" + std::to_string(cycles_of(moment) / kCyclesPerSecond)};
  if (moment.manner == Manner::realtime) command.insert(command.end(), {"--realtime", "--speed", "10"});
  return command;
}

// Waits for a condition that must come; false after kHang.
bool wait_for(const std::function<bool()>& holds) {
  const auto deadline = WallClock::now() + kHang;
  while (!holds()) {
    if (WallClock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::microseconds{200});
  }
  return true;
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

// Sockets of this network namespace, which is the test's own.
std::vector<std::string> open_sockets() {
  std::vector<std::string> lines;
  for (const char* table : {"/proc/self/net/udp", "/proc/self/net/tcp", "/proc/self/net/udp6", "/proc/self/net/tcp6"}) {
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);  // the head
    while (std::getline(file, line)) lines.push_back(line);
  }
  return lines;
}

struct LogFindings {
  std::int64_t events = 0;
  std::int64_t last_encoder = -1;
};

// Readable to its last complete message: whole events, numbered without a gap, and behind them less than one event.
LogFindings read_log(const fs::path& path) {
  LogFindings findings;
  msgs::LogReader reader(path);
  msgs::LogEvent event;
  msgs::Encoder encoder;
  std::size_t largest = 4096;  // [bytes] an event that was only just begun may be larger than those before
  while (reader.next(event)) {
    EXPECT_EQ(event.number, findings.events);
    ++findings.events;
    largest = std::max(largest, msgs::kLogEventHeadBytes + event.channel.size() + event.data.size());
    if (event.channel == msgs::kEncoderChannel) {
      // A fault of the scenario may have corrupted it on purpose.
      if (msgs::decode(event.data, encoder) == msgs::DecodeStatus::ok) findings.last_encoder = encoder.sequence;
    }
  }
  EXPECT_EQ(reader.damage().skipped_bytes, 0) << path;
  EXPECT_LT(reader.damage().cut_off_bytes, static_cast<std::int64_t>(largest)) << path;
  if (findings.last_encoder >= 0) {
    const msgs::RunLogs logs = msgs::read_run_logs(path);  // what replay, accept and diagnose read by
    EXPECT_FALSE(logs.runs.empty());
  }
  return findings;
}

struct Tally {
  int moments = 0;
  int struck = 0;   // the victim still ran
  int whole = 0;    // complete log
  int partial = 0;  // log so far
  int none = 0;     // killed before there was a log
  std::int64_t most_lost = 0;  // [ENCODER] that the bus had seen and the log has not
};

class KillTest : public testing::Test {
 protected:
  KillTest() {
    // Whatever any of the programs leaves among temporary files is seen.
    ::setenv("TMPDIR", temporary_.path().c_str(), 1);
    ::setenv("SLEWLAB_QUIET_NETWORK", "1", 1);
  }
  ~KillTest() override { ::unsetenv("TMPDIR"); }

  struct Struck {
    bool was_running = false;  // the victim
    std::int64_t seen = -1;    // newest ENCODER on the bus
  };

  void strike(const Moment& moment, Tally& tally);
  void strike_at_its_moment(const Moment& moment, RunningProgram& run, Struck& struck);
  bool expect_readable_log(const Moment& moment, const Struck& struck, Tally& tally);
  void expect_result(const Moment& moment, const Struck& struck, bool whole, int result, const std::string& complaints);
  fs::path out_folder() const { return folder_.path() / "out"; }
  fs::path logger_file() const { return folder_.path() / "logger.lcmlog"; }

  static std::vector<pid_t> children_of(pid_t parent) {
    std::ifstream list("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
    return {std::istream_iterator<pid_t>(list), {}};
  }

  // The launcher's present controller, which a scenario may have started anew; 0 where there is none just now.
  static pid_t controller_of(pid_t launcher) {
    for (const pid_t child : children_of(launcher)) {
      if (contents("/proc/" + std::to_string(child) + "/comm").rfind("slewlab-control", 0) == 0) return child;
    }
    return 0;
  }

  // Every child and adopted orphan of this process ends by itself.
  void expect_nothing_left() {
    EXPECT_TRUE(wait_for([] {
      while (::waitpid(-1, nullptr, WNOHANG) > 0) {
      }
      return ::waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD;
    })) << "a process is left";
    EXPECT_EQ(open_sockets(), std::vector<std::string>{});
    EXPECT_EQ(files_in(temporary_.path()), std::vector<std::string>{});
  }

  TemporaryFolder folder_;
  TemporaryFolder temporary_;
};

// Waits until the bus has carried so many ENCODER, or the run has ended; `seen` is the newest.
void wait_for_encoder(const std::string& url, std::int64_t count, const fs::path& out, std::int64_t& seen) {
  const auto bus = msgs::open_lcm_bus(url);
  bus->subscribe(msgs::kEncoderChannel, [&](msgs::Bytes bytes) {
    msgs::Encoder encoder;
    if (msgs::decode(bytes, encoder) == msgs::DecodeStatus::ok) seen = std::max(seen, encoder.sequence);
  });
  ASSERT_TRUE(wait_for([&] {
    while (seen < count && bus->handle_one(std::chrono::milliseconds{1})) {
    }
    return seen >= count || fs::exists(out / "summary.json");
  }));
}

void KillTest::strike_at_its_moment(const Moment& moment, RunningProgram& run, Struck& struck) {
  const fs::path out = out_folder();
  const auto has_ended = [&] { return fs::exists(out / "summary.json"); };
  if (moment.victim == Victim::launcher && moment.when == When::at_start) {
    ASSERT_TRUE(wait_for([&] { return !children_of(run.pid()).empty(); }));
    struck.was_running = ::kill(run.pid(), SIGKILL) == 0;
    return;
  }
  const std::string started = run.wait_for_line("plant is process ");
  ASSERT_NE(started, "");
  const std::string url = started.substr(started.find("udpm://"));
  std::optional<RunningProgram> logger;
  pid_t target = 0;
  switch (moment.victim) {
    case Victim::plant: target = number_after(started, "plant is process "); break;
    case Victim::controller: break;  // found when its time has come
    case Victim::launcher: target = run.pid(); break;
    case Victim::logger:
      logger.emplace(std::vector<std::string>{"lcm-logger", "--quiet", "--flush-interval=1", "--lcm-url=" + url, logger_file().string()});
      target = logger->pid();
      break;
  }
  if (moment.when == When::at_end) {
    ASSERT_TRUE(wait_for([&] { return fs::exists(out / "run.lcmlog"); }));
  } else if (moment.when == When::at_count && moment.victim == Victim::logger) {
    ASSERT_TRUE(wait_for([&] {
      std::error_code none_yet;
      const auto size = fs::file_size(logger_file(), none_yet);
      return (!none_yet && size >= static_cast<std::uintmax_t>(moment.count)) || has_ended();
    }));
  } else if (moment.when == When::at_count) {
    ASSERT_NO_FATAL_FAILURE(wait_for_encoder(url, moment.count, out, struck.seen));
  }
  if (moment.victim == Victim::controller) {
    ASSERT_TRUE(wait_for([&] {
      target = controller_of(run.pid());
      return target != 0 || has_ended();
    }));
  }
  struck.was_running = target != 0 && !has_ended() && ::kill(target, SIGKILL) == 0;
  if (logger) {
    if (!struck.was_running) ::kill(target, SIGKILL);
    EXPECT_EQ(logger->wait_for_end(), -SIGKILL);
  }
}

// Whether the log is whole.
bool KillTest::expect_readable_log(const Moment& moment, const Struck& struck, Tally& tally) {
  const fs::path out = out_folder();
  const bool whole = fs::exists(out / "run.lcmlog");
  const bool partial = fs::exists(out / "run.lcmlog.partial");
  if (whole) {
    ++tally.whole;
    EXPECT_EQ(read_log(out / "run.lcmlog").last_encoder, cycles_of(moment) - 1);
  } else if (partial) {
    ++tally.partial;
    const LogFindings log = read_log(out / "run.lcmlog.partial");
    const std::int64_t lost = struck.seen - log.last_encoder;
    tally.most_lost = std::max(tally.most_lost, lost);
    // Only a plant that is killed itself takes along what it has not yet handed to the system.
    if (moment.victim != Victim::plant) {
      EXPECT_LE(lost, 0);
    }
  } else {
    ++tally.none;
    EXPECT_EQ(moment.when, When::at_start) << "no log at all";
  }
  EXPECT_FALSE(whole && partial);
  return whole;
}

void KillTest::expect_result(const Moment& moment, const Struck& struck, bool whole, int result, const std::string& complaints) {
  switch (moment.victim) {
    case Victim::launcher:
      EXPECT_EQ(result, struck.was_running ? -SIGKILL : 0);
      break;
    case Victim::plant:
    case Victim::controller:
      // One that has done its part already is missed by nobody; a controller may also be dead on purpose just then.
      if (!whole) {
        EXPECT_EQ(result, 1) << complaints;
        EXPECT_NE(complaints.find(std::string("the ") + kVictimNames[static_cast<std::size_t>(moment.victim)] +
                                  " ended before its time: killed by signal 9"),
                  std::string::npos)
            << complaints;
      } else {
        EXPECT_TRUE(result == 0 || result == 1) << result << complaints;
      }
      break;
    case Victim::logger:
      EXPECT_EQ(result, 0) << "a logger beside the run is no part of it: " << complaints;
      EXPECT_TRUE(whole);
      if (fs::exists(logger_file())) read_log(logger_file());
      break;
  }
}

void KillTest::strike(const Moment& moment, Tally& tally) {
  fs::remove_all(out_folder());
  fs::remove(logger_file());
  ++tally.moments;
  Struck struck;
  int result = 0;
  std::string complaints;
  {
    RunningProgram run(command_of(moment, out_folder()));
    ASSERT_NO_FATAL_FAILURE(strike_at_its_moment(moment, run, struck));
    result = run.wait_for_end();
    complaints = run.complaints();
  }
  expect_nothing_left();
  tally.struck += struck.was_running;
  const bool whole = expect_readable_log(moment, struck, tally);
  expect_result(moment, struck, whole, result, complaints);

  RunningProgram again({kSlewlab, "run", kScenarios + "thesis_slew.yaml", "--set", "duration=0.1", "--out", out_folder().string()});
  EXPECT_EQ(again.wait_for_end(), 0) << "the folder takes no other run: " << again.complaints();
  EXPECT_FALSE(fs::exists(out_folder() / "run.lcmlog.partial"));
}

std::uint64_t from_environment(const char* name, std::uint64_t usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : std::stoull(text);
}

TEST_F(KillTest, AtSeededMomentsNothingIsLostAndNothingIsLeft) {
  const std::uint64_t count = from_environment("SLEWLAB_KILL_MOMENTS", 12);
  const std::uint64_t seed = from_environment("SLEWLAB_KILL_SEED", 1);
  const std::uint64_t first = from_environment("SLEWLAB_KILL_FIRST", 0);
  std::map<std::pair<Victim, Manner>, Tally> tallies;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const Moment moment = draw(seed, number);
    SCOPED_TRACE("moment " + std::to_string(number) + " of seed " + std::to_string(seed) + ": " + to_text(moment));
    ASSERT_NO_FATAL_FAILURE(strike(moment, tallies[{moment.victim, moment.manner}]));
    if (HasFailure()) break;
  }
  int struck = 0;
  std::printf("%-52s %7s %7s %6s %8s %5s %13s\n", "victim", "moments", "struck", "whole", "partial", "none",
              "most lost [ENCODER]");
  for (const auto& [key, tally] : tallies) {
    const std::string name = std::string(kVictimNames[static_cast<std::size_t>(key.first)]) + ", " +
                             kMannerNames[static_cast<std::size_t>(key.second)];
    std::printf("%-52s %7d %7d %6d %8d %5d %13lld\n", name.c_str(), tally.moments, tally.struck, tally.whole,
                tally.partial, tally.none, static_cast<long long>(tally.most_lost));
    struck += tally.struck;
  }
  std::printf("%d moments struck a running process\n", struck);
  EXPECT_GT(struck, static_cast<int>(count) / 2) << "most moments came too late to prove anything";
}

}  // namespace
}  // namespace slewlab::tools
