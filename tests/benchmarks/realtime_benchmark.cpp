// How well the plant keeps the wall clock against a bare loop that only sleeps, side by side in the same run: the same
// period of 1 ms, half a period apart, the same scheduling, the same processor. The plant is the whole thing: the thesis's crane, its
// drive, ENCODER every 1 ms over LCM to a controller in a process of its own, and the log.
//
// Usage: tools/in-private-network realtime_benchmark [SECONDS]

#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/lcm_bus.h"
#include "msgs/log_queue.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/scenario_run.h"
#include "sim/drive/system_clock.h"
#include "tests/common/number_argument.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // [ns]

[[noreturn]] void be_controller(const std::string& bus_url, const sim::Scenario& scenario, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  controller::ControllerSettings settings = controller::load_controller_file(scenario.controller_file).settings;
  settings.period = static_cast<double>(kPeriod) * 1e-9;
  const auto bus = msgs::open_lcm_bus(bus_url);
  const controller::AnswerLoop loop(*bus, controller::computed_answer(settings));
  while (true) bus->handle_one(std::chrono::milliseconds{1000});
}

void print(const char* what, const sim::LatencyHistogram& histogram) {
  constexpr double kMicrosecond = 1e3;  // [ns]
  std::printf("%-22s median %8.1f us   99 %% %8.1f us   99.9 %% %8.1f us   largest %9.1f us   of %lld\n", what,
              histogram.percentile(0.5) / kMicrosecond, histogram.percentile(0.99) / kMicrosecond,
              histogram.percentile(0.999) / kMicrosecond, static_cast<double>(histogram.largest()) / kMicrosecond,
              static_cast<long long>(histogram.count()));
}

// The crane's plant with a stopwatch on every step.
class TimedPlant : public sim::CranePlant {
 public:
  using sim::CranePlant::CranePlant;
  void step(const sim::PlantConditions& conditions) override {
    const std::int64_t begin = clock_.now();
    sim::CranePlant::step(conditions);
    durations.push_back(clock_.now() - begin);
  }
  std::vector<std::int64_t> durations;  // [ns]

 private:
  sim::SystemClock clock_;
};

// The longest step of the run, each step taken as the least of several runs of the same bits: what the computation
// itself needs, whatever else the machine does. [ns]
std::int64_t longest_own_step(const sim::Scenario& scenario) {
  constexpr int kRuns = 5;
  const TemporaryFolder folder;
  controller::ControllerSettings settings = controller::load_controller_file(scenario.controller_file).settings;
  settings.period = static_cast<double>(kPeriod) * 1e-9;
  std::vector<std::int64_t> least;
  for (int i = 0; i < kRuns; ++i) {
    TimedPlant plant(sim::machine_settings(scenario), sim::drive_run(scenario));
    msgs::LogWriter log(folder.path() / "run.lcmlog");
    diagnosis::run_wire_loop(sim::lockstep_settings(scenario), settings, plant, log);
    if (least.empty()) least = plant.durations;
    for (std::size_t k = 0; k < least.size(); ++k) least[k] = std::min(least[k], plant.durations[k]);
  }
  return *std::max_element(least.begin(), least.end());
}

// Processor time that the hypervisor has taken from this machine since its start; 0 where it is none. It counts as a
// thread's own in the thread's clock. [s]
double stolen_time() {
  std::ifstream file("/proc/stat");
  std::string name;
  long long user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft = 0, stolen = 0;
  file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft >> stolen;
  return static_cast<double>(stolen) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

int run(double seconds) {
  sim::Scenario scenario = sim::load_scenario_file(SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml");
  scenario.controller_period = kPeriod;
  scenario.duration = static_cast<std::int64_t>(seconds) * 1'000'000'000;
  const msgs::ReservedPort port;
  const std::string bus_url = msgs::bus_url(port.number());
  const pid_t self = ::getpid();
  const pid_t controller = ::fork();
  if (controller == 0) be_controller(bus_url, scenario, self);

  const auto bus = msgs::open_lcm_bus(bus_url);
  const TemporaryFolder folder;
  msgs::LogWriter writer(folder.path() / "run.lcmlog");
  msgs::LogQueue queue(writer);
  for (const std::string& line : sim::ask_for_real_time()) std::printf("%s\n", line.c_str());
  // Both on one processor, for what else runs differs from one to the next; which one, the machine has chosen.
  cpu_set_t here;
  CPU_ZERO(&here);
  CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &here);
  ::sched_setaffinity(0, sizeof here, &here);

  std::atomic<bool> ending{false};
  sim::LatencyHistogram bare;
  // Inherits the scheduling and the processor of this thread.
  std::thread sleeper([&] {
    sim::SystemClock clock;
    const std::int64_t start = clock.now() + kPeriod / 2;
    for (std::int64_t step = 0; !ending; ++step) {
      clock.sleep_until(start + step * kPeriod);
      bare.add(clock.now() - (start + step * kPeriod));
    }
  });

  sim::CranePlant plant(sim::machine_settings(scenario), sim::drive_run(scenario));
  const sim::LockstepSettings settings = sim::lockstep_settings(scenario);
  sim::SystemClock clock;
  const sim::LogSink log = [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) {
    queue.put(channel, timestamp_us, bytes);
  };
  const double stolen_before = stolen_time();
  const sim::WallClockReport report = sim::run_wall_clock(settings, 1.0, plant, *bus, log, clock);
  const double stolen = stolen_time() - stolen_before;
  ending = true;
  sleeper.join();
  queue.finish();
  ::kill(controller, SIGKILL);
  ::waitpid(controller, nullptr, 0);

  print("plant, wake-up", report.wakeup_latency);
  print("bare loop, wake-up", bare);
  print("plant, step", report.step_time);
  std::printf("ratio of the wake-up latencies at 99.9 %%: %.3f (wanted: at most 1.3)\n",
              report.wakeup_latency.percentile(0.999) / bare.percentile(0.999));
  const double own_step = static_cast<double>(longest_own_step(scenario)) / 1e3;  // [us]
  std::printf("missed deadlines: %lld, of them in steps that used more than 1000 us of processor time: %lld (wanted: 0)\n",
              static_cast<long long>(report.missed_deadlines),
              static_cast<long long>(report.missed_by_own_computation));
  std::printf("longest step of the plant alone: %.1f us (least of five runs of the same step); the hypervisor took %.2f s "
              "of processor time meanwhile\n", own_step, stolen);
  std::printf("stale commands: %lld of %lld, log events left out: %lld\n",
              static_cast<long long>(plant.drive().stale_commands), static_cast<long long>(report.cycles),
              static_cast<long long>(queue.left_out()));
  return 0;
}

}  // namespace
}  // namespace slewlab

int main(int argc, char** argv) {
  try {
    return slewlab::run(slewlab::number_argument(argc, argv, 1, 60.0));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "realtime_benchmark: %s\n", error.what());
    return 1;
  }
}
