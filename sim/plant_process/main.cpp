// slewlab-plant: the crane as a process on the bus, in lockstep with whatever controller answers or against the
// wall clock, and the writer of
// the run's log.
//
// On standard output, one line each, for the launcher and for people:
//   progress SIMULATED_SECONDS OF_SECONDS RESENDS
//   summary {...}        JSON, once, at the end of a run whether complete or stopped
//   controller kill      a fault on purpose: kill the controller now and say so by a line on standard input
//   controller start     the same for starting it anew
//   controller stop, controller continue      the same with SIGSTOP and SIGCONT, against the wall clock only
//   controller play_compensation on|off NANOSECONDS   from that time on; in lockstep the run waits until the controller knows
//   steering NEWS        of a steered run: what was refused, which fault began or ended when (sim/drive/steering.h)
// Exit codes: 0 complete, 1 the run failed, 2 the call or the configuration is wrong, 128 + signal when stopped.

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/launcher_lines.h"
#include "common/stop_signal.h"
#include "common/unknown_option.h"
#include "msgs/configuration_hash.h"
#include "msgs/lcm_bus.h"
#include "msgs/log_queue.h"
#include "msgs/run_identity.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_run.h"
#include "sim/drive/steering.h"
#include "sim/drive/system_clock.h"
#include "sim/drive/wall_clock_loop.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::sim {
namespace {

using WallClock = std::chrono::steady_clock;

constexpr double kNanosecondsPerSecond = 1e9;
constexpr std::chrono::milliseconds kProgressInterval{100};

struct Options {
  std::string scenario;
  std::string bus;
  std::string log;
  std::vector<std::string> overrides;
  std::string run_identity;  // 16 hexadecimal digits; empty: a fresh one
  bool realtime = false;
  bool steered = false;
  double speed = 1.0;
};

// What is to be said of the other side, once each: that nobody answers, and then for how long nobody did; that another run
// is on the bus.
class WireNotices {
 public:
  void waiting(std::int64_t simulated_time, std::int64_t resends) {
    const WallClock::time_point now = WallClock::now();
    if (!waiting_) {
      waiting_ = true;
      since_ = now;
      resends_before_ = resends;
      return;
    }
    if (told_ || now - since_ < kSilence) return;
    told_ = true;
    std::fprintf(stderr, "slewlab-plant: no answer to the ENCODER of %.3f s since %lld s; still asking\n",
                 static_cast<double>(simulated_time) / kNanosecondsPerSecond,
                 static_cast<long long>(std::chrono::duration_cast<std::chrono::seconds>(now - since_).count()));
  }
  void answered(std::int64_t resends) { end_wait("was answered", resends); }
  void ended(std::int64_t resends) { end_wait("was not answered until the run was stopped", resends); }
  void foreign(std::int64_t count) {
    if (count == 0 || foreign_told_) return;
    foreign_told_ = true;
    std::fprintf(stderr, "slewlab-plant: TORQUE of another run on this bus; it is left alone and counted (one port is one bus)\n");
  }

 private:
  void end_wait(const char* how, std::int64_t resends) {
    if (!waiting_) return;
    if (told_) {
      std::fprintf(stderr, "slewlab-plant: that ENCODER %s, after %.1f s and %lld repetitions\n", how,
                   std::chrono::duration<double>(WallClock::now() - since_).count(),
                   static_cast<long long>(resends - resends_before_) + 1);
    }
    waiting_ = told_ = false;
  }

  static constexpr std::chrono::seconds kSilence{3};
  bool waiting_ = false;
  bool told_ = false;
  bool foreign_told_ = false;
  WallClock::time_point since_;
  std::int64_t resends_before_ = 0;
};

nlohmann::ordered_json drive_summary(const DriveProtectionState& drive) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::object();
  for (int i = 1; i < kDriveFaultCount; ++i) faults[name_of(static_cast<DriveFault>(i))] = drive.faults[i];
  return {{"state", name_of(drive.state)},
          {"trip_cause", name_of(drive.trip_cause)},
          {"trips", drive.trips},
          {"stale_commands", drive.stale_commands},
          {"faults", faults}};
}

void print_progress(const LockstepCounts& counts, const LockstepSettings& settings) {
  std::printf("progress %.3f %.3f %lld\n", static_cast<double>(counts.simulated_time) / kNanosecondsPerSecond,
              static_cast<double>(settings.duration) / kNanosecondsPerSecond, static_cast<long long>(counts.resends));
  std::fflush(stdout);
}

void tell_launcher(ControllerAction action) {
  constexpr std::array kNames{"kill", "start", "stop", "continue"};
  std::printf("controller %s\n", kNames[static_cast<std::size_t>(action)]);
  std::fflush(stdout);
}

// Returns when the launcher has done it, or where there is none.
void ask_launcher(common::LauncherLines& launcher, ControllerAction action) {
  tell_launcher(action);
  if (launcher.wait_for_done() || common::stop_requested()) return;
  std::fprintf(stderr, "slewlab-plant: nobody here to kill or start the controller; it is not asked instead\n");
}

// The desk's side of a steered run: lines in, periods out, at the pace that is asked for.
class SteeredRun {
 public:
  SteeredRun(const SteeringSettings& settings, common::LauncherLines& launcher, CranePlant& plant, msgs::LogWriter* log)
      : steering_(settings), launcher_(launcher), plant_(plant), log_(log) {}

  // In lockstep: waits until the period at `time` is due, then begins it.
  SteeredPeriod when_due(std::int64_t time) {
    hear(std::chrono::milliseconds{0});
    while (!common::stop_requested()) {
      const std::chrono::milliseconds wait = time_left(time);
      if (wait.count() <= 0) break;
      show();
      hear(std::min(wait, kLongestWait));
    }
    show();
    const SteeredPeriod period = begin(time);
    // The controller knows it before it is asked of this period.
    if (period.play_compensation) launcher_.wait_for_done();
    return period;
  }

  // Against the wall clock.
  SteeredPeriod at_once(std::int64_t time) {
    hear(std::chrono::milliseconds{0});
    return begin(time);
  }

 private:
  SteeredPeriod begin(std::int64_t time) {
    const SteeredPeriod period = steering_.begin_period(time);
    for (const std::string& news : steering_.take_news()) std::printf("steering %s\n", news.c_str());
    std::fflush(stdout);
    for (const EffectSwitch& change : period.effects) plant_.switch_effect(change.effect, change.on);
    if (period.play_compensation) {
      std::printf("controller play_compensation %s %lld\n", *period.play_compensation ? "on" : "off", static_cast<long long>(time));
      std::fflush(stdout);
    }
    return period;
  }

  void hear(std::chrono::milliseconds patience) {
    while (auto line = launcher_.next(patience)) {
      steering_.take(*line);
      patience = std::chrono::milliseconds{0};
      heard_ = WallClock::now();
      is_silent_ = false;
    }
    if (!is_silent_ && steering_.patience() && WallClock::now() - heard_ > std::chrono::duration<double>(*steering_.patience())) {
      is_silent_ = true;
      steering_.take("silence");
    }
    if (launcher_.ended() && !lost_) {
      lost_ = true;
      steering_.take("lost");
    }
  }

  // Wall clock until the period at `time` is due. A run that was held, or that the machine could not keep up with, goes on from
  // where it stands.
  std::chrono::milliseconds time_left(std::int64_t time) {
    const WallClock::time_point now = WallClock::now();
    if (steering_.holds()) {
      anchor_time_ = time;
      anchor_ = now;
      return kLongestWait;
    }
    if (steering_.speed() != speed_) {
      speed_ = steering_.speed();
      anchor_time_ = time;
      anchor_ = now;
    }
    if (speed_ == 0.0) return std::chrono::milliseconds{0};
    const auto due = anchor_ + std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(time - anchor_time_) / speed_));
    if (now - due > kLongestWait) {
      anchor_time_ = time;
      anchor_ = now;
    }
    return std::chrono::duration_cast<std::chrono::milliseconds>(due - now);
  }

  // What was simulated is in the log for whoever looks on.
  void show() {
    if (log_ == nullptr || WallClock::now() < next_show_) return;
    next_show_ = WallClock::now() + kShowInterval;
    log_->flush();
  }

  static constexpr std::chrono::milliseconds kLongestWait{100};
  static constexpr std::chrono::milliseconds kShowInterval{15};  // of a picture of 60 Hz
  Steering steering_;
  common::LauncherLines& launcher_;
  CranePlant& plant_;
  msgs::LogWriter* log_;
  bool lost_ = false;
  double speed_ = -1.0;
  std::int64_t anchor_time_ = 0;  // [ns]
  WallClock::time_point anchor_, next_show_;
  WallClock::time_point heard_ = WallClock::now();  // the desk's last line
  bool is_silent_ = false;
};

// Puts the log in order and says how the run went, `own` being what only this way of running has to say. The exit code.
int end_run(const LockstepSettings& settings, const CranePlant& plant, msgs::LogWriter& log, std::int64_t simulated_time,
            double wall_seconds, bool ended_by_operator, const nlohmann::ordered_json& own) {
  const bool complete = simulated_time >= settings.duration || ended_by_operator;
  if (complete) {
    log.finish();
  } else {
    log.flush();
  }
  const double simulated_seconds = static_cast<double>(simulated_time) / kNanosecondsPerSecond;
  nlohmann::ordered_json summary{{"complete", complete},
                                 {"configuration_hash", msgs::hash_text(settings.configuration_hash)},
                                 {"run_identity", msgs::hash_text(settings.run_identity)},
                                 {"simulated_seconds", simulated_seconds},
                                 {"wall_seconds", wall_seconds}};
  summary.update(own);
  summary["drive"] = drive_summary(plant.drive());
  if (const std::int64_t unsolved = plant.machine().state.unsolved_frictions; unsolved > 0) summary["unsolved_frictions"] = unsolved;
  summary["log_events"] = log.event_count();
  summary["log_bytes"] = log.byte_count();
  summary["log_digest"] = msgs::hash_text(log.digest());
  std::printf("summary %s\n", summary.dump().c_str());
  std::fflush(stdout);
  if (complete) return 0;
  std::fprintf(stderr, "slewlab-plant: stopped by signal %d at %.3f s of simulated time\n", common::stop_signal(), simulated_seconds);
  return common::stop_exit_code();
}

int run_in_lockstep(const LockstepSettings& settings, CranePlant& plant, msgs::Bus& bus, msgs::LogWriter& log,
                    const std::optional<SteeringSettings>& steered) {
  const WallClock::time_point begin = WallClock::now();
  WallClock::time_point next_progress = begin;
  const auto show_progress = [&](const LockstepCounts& counts) {
    if (WallClock::now() < next_progress) return;
    next_progress = WallClock::now() + kProgressInterval;
    log.flush();  // what is shown as done survives the death of this process
    print_progress(counts, settings);
  };
  LockstepHooks hooks;
  hooks.stop = common::stop_requested;
  // Looking at the clock in every cycle would cost as much as the plant's step does.
  WireNotices notices;
  hooks.after_cycle = [&](const LockstepCounts& counts) {
    notices.answered(counts.resends);
    notices.foreign(counts.foreign_answers);
    if (counts.cycles % 64 == 0) show_progress(counts);
  };
  hooks.while_waiting = [&](const LockstepCounts& counts) {
    notices.waiting(counts.simulated_time, counts.resends);
    notices.foreign(counts.foreign_answers);
    show_progress(counts);
  };
  common::LauncherLines launcher;
  hooks.controller_action = [&](ControllerAction action) { ask_launcher(launcher, action); };
  std::optional<SteeredRun> steering;
  if (steered) {
    steering.emplace(*steered, launcher, plant, &log);
    hooks.steer = [&](std::int64_t time) { return steering->when_due(time); };
  }

  print_progress({}, settings);
  const LockstepCounts counts = run_lockstep(settings, plant, bus, log, hooks);
  notices.ended(counts.resends);
  const double wall_seconds = std::chrono::duration<double>(WallClock::now() - begin).count();
  print_progress(counts, settings);
  const double simulated_seconds = static_cast<double>(counts.simulated_time) / kNanosecondsPerSecond;
  return end_run(settings, plant, log, counts.simulated_time, wall_seconds, counts.ended_by_operator, {
      {"rate_against_real_time", simulated_seconds / wall_seconds},
      {"lockstep_cycles", counts.cycles},
      {"lockstep_cycles_per_second", static_cast<double>(counts.cycles) / wall_seconds},
      {"resends", counts.resends},
      {"stale_answers", counts.stale_answers},
      {"wrong_answers", counts.wrong_answers},
      {"foreign_answers", counts.foreign_answers},
      {"cut_answers", counts.cut_answers}});
}

nlohmann::ordered_json latency_summary(const LatencyHistogram& histogram) {
  constexpr double kMicrosecond = 1e3;  // [ns]
  return {{"unit", "us"},
          {"p50", histogram.percentile(0.5) / kMicrosecond},
          {"p99", histogram.percentile(0.99) / kMicrosecond},
          {"p99_9", histogram.percentile(0.999) / kMicrosecond},
          {"largest", static_cast<double>(histogram.largest()) / kMicrosecond}};
}

int run_in_real_time(const Options& options, const LockstepSettings& settings, CranePlant& plant, msgs::Bus& bus,
                 msgs::LogWriter& log, const std::optional<SteeringSettings>& steered) {
  std::string permissions;
  msgs::LogQueue queue(log);  // its thread is an ordinary one: started before real time is asked for
  for (const std::string& line : ask_for_real_time()) {
    std::fprintf(stderr, "slewlab-plant: %s\n", line.c_str());
    permissions += (permissions.empty() ? "" : "; ") + line;
  }
  SystemClock clock;
  const std::int64_t begin = clock.now();
  std::int64_t next_progress = begin;
  const auto show_progress = [&](const WallClockReport& report) {
    constexpr std::int64_t kInterval = 500'000'000;  // [ns]
    if (clock.now() < next_progress) return;
    next_progress = clock.now() + kInterval;
    print_progress({.simulated_time = report.simulated_time}, settings);
  };
  WallClockHooks hooks;
  hooks.stop = [&] { return common::stop_requested() || queue.failed(); };
  WireNotices notices;
  std::int64_t questions = 0;  // for the first answer
  hooks.while_waiting = [&](const WallClockReport& report) {
    notices.waiting(report.simulated_time, ++questions);
    notices.foreign(report.foreign_answers);
    show_progress(report);
  };
  bool flood_told = false;
  hooks.after_cycle = [&](const WallClockReport& report) {
    notices.answered(questions);
    notices.foreign(report.foreign_answers);
    if (report.flooding_answers > 0 && !flood_told) {
      flood_told = true;
      std::fprintf(stderr, "slewlab-plant: TORQUE is flooded; what a period cannot take is left out and counted\n");
    }
    show_progress(report);
  };
  hooks.controller_action = tell_launcher;
  common::LauncherLines launcher;
  std::optional<SteeredRun> steering;
  if (steered) {
    steering.emplace(*steered, launcher, plant, nullptr);
    hooks.steer = [&](std::int64_t time) { return steering->at_once(time); };
  }

  print_progress({}, settings);
  const LogSink sink = [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) {
    queue.put(channel, timestamp_us, bytes);
  };
  const WallClockReport report = run_wall_clock(settings, options.speed, plant, bus, sink, clock, hooks);
  notices.ended(questions);
  const double wall_seconds = static_cast<double>(clock.now() - begin) / kNanosecondsPerSecond;
  print_progress({.simulated_time = report.simulated_time}, settings);
  queue.finish();
  return end_run(settings, plant, log, report.simulated_time, wall_seconds, report.ended_by_operator, {
      {"realtime",
       {{"speed", options.speed},
        {"permissions", permissions},
        {"foreign_answers", report.foreign_answers},
        {"cut_answers", report.cut_answers},
        {"flooding_answers", report.flooding_answers},
        {"missed_deadlines", report.missed_deadlines},
        {"missed_by_own_computation", report.missed_by_own_computation},
        {"wakeup_latency", latency_summary(report.wakeup_latency)},
        {"step_time", latency_summary(report.step_time)},
        {"log_events_left_out", queue.left_out()}}},
      {"controller_cycles", report.cycles}});
}

int run(const Options& options) {
  std::vector<common::Override> overrides;
  for (const std::string& text : options.overrides) overrides.push_back(common::parse_override(text));
  const Scenario scenario = load_scenario_file(options.scenario, overrides);
  LockstepSettings settings = lockstep_settings(scenario);
  DriveRun drive = drive_run(scenario);
  settings.run_identity = drive.run_identity =
      options.run_identity.empty() ? msgs::fresh_run_identity() : msgs::hash_of_text(options.run_identity);
  CranePlant plant(machine_settings(scenario), drive);
  const auto bus = msgs::open_lcm_bus(options.bus);
  msgs::LogWriter log(options.log);

  common::catch_stop_signals();
  // A launcher that was killed reads no more of what is told here; the log is to be put in order all the same.
  std::signal(SIGPIPE, SIG_IGN);
  std::optional<SteeringSettings> steered;
  if (options.steered) {
    settings.operator_moves.clear();  // the operator is at the desk
    steered = {settings.controller_period, scenario.crane.parameters.drive, static_cast<std::uint64_t>(scenario.seed),
               scenario.faults.size(), plant.machine().switchable, after_loss_of(scenario.crane.parameters)};
  }
  return options.realtime ? run_in_real_time(options, settings, plant, *bus, log, steered)
                          : run_in_lockstep(settings, plant, *bus, log, steered);
}

}  // namespace
}  // namespace slewlab::sim

int main(int argc, char** argv) {
  using namespace slewlab;
  CLI::App app{"The simulated crane as a process on the bus, in lockstep with a controller.", "slewlab-plant"};
  app.set_version_flag("--version", "slewlab-plant " SLEWLAB_VERSION, "version of slewlab");
  sim::Options options;
  app.add_option("--scenario", options.scenario, "scenario file")->required();
  app.add_option("--bus", options.bus, "LCM address, e.g. " + msgs::bus_url(msgs::kDefaultPort))
      ->envname("SLEWLAB_BUS")
      ->required();
  app.add_option("--log", options.log, "log to write; NAME.partial until it is complete")->required();
  app.add_option("--run-identity", options.run_identity,
                 "16 hexadecimal digits that stand in every message of this run; a new one where absent")
      ->check(CLI::Validator([](const std::string& text) { return msgs::is_hash_text(text) ? "" : "16 hexadecimal digits are wanted"; },
                             "HEX"));
  CLI::Option* realtime = app.add_flag("--realtime", options.realtime, "against the wall clock instead of in lockstep");
  app.add_flag("--steered", options.steered, "by lines on standard input, in place of the scenario's operator");
  app.add_option("--speed", options.speed, "with --realtime: simulated seconds per second")->check(CLI::PositiveNumber)->needs(realtime);
  app.add_option("--set", options.overrides, "key=value over the files, e.g. crane.load.mass=20t");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return common::exit_code_of_refused("slewlab-plant", app, error, argc, argv);
  }
  try {
    return sim::run(options);
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const msgs::BusUrlError& error) {
    std::fprintf(stderr, "slewlab-plant: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-plant: %s\n", error.what());
    return 1;
  }
}
