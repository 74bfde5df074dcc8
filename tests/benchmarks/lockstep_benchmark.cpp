// How fast the lockstep turns over LCM against a bare LCM ping-pong of the same machine in the same minute.
// Both run between two processes over udpm, in turns, so that a busy machine hits both; the ratio is that of the
// medians. The bare ping-pong publishes an ENCODER's bytes and handles the answer of a TORQUE's size, with LCM's own
// calls and nothing else. The lockstep is the real loop with the log written.
//
// Usage: tools/in-private-network lockstep_benchmark [ROUNDS [CYCLES]]

#include <lcm/lcm.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <vector>

#include "controller/process/answer_loop.h"
#include "msgs/codec.h"
#include "msgs/lcm_bus.h"
#include "sim/drive/lockstep_loop.h"
#include "tests/common/number_argument.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/sim/drive/toy_plant.h"

namespace slewlab {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

template <class Run>
pid_t in_child(Run run) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  run();
  _exit(0);
}

void end_child(pid_t pid) {
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

// Round trips per second.
double bare_ping_pong(const std::string& url, int cycles) {
  constexpr int kQuestionBytes = 8 + 4 * 8 + 4 + 4 * 8;        // ENCODER with two groups
  constexpr int kAnswerBytes = 8 + 5 * 8 + 4 + 4 + 2 * 8;      // TORQUE with two groups
  static char buffer[256];
  const pid_t child = in_child([&] {
    lcm_t* lcm = lcm_create(url.c_str());
    lcm_subscribe(
        lcm, "PING",
        [](const lcm_recv_buf_t*, const char*, void* user) {
          lcm_publish(static_cast<lcm_t*>(user), "PONG", buffer, kAnswerBytes);
        },
        lcm);
    for (;;) lcm_handle(lcm);
  });
  lcm_t* lcm = lcm_create(url.c_str());
  int pongs = 0;
  lcm_subscribe(lcm, "PONG", [](const lcm_recv_buf_t*, const char*, void* user) { ++*static_cast<int*>(user); },
                &pongs);
  const auto turn = [&](int wanted) {
    while (pongs < wanted) {
      const int before = pongs;
      lcm_publish(lcm, "PING", buffer, kQuestionBytes);
      while (pongs == before && lcm_handle_timeout(lcm, 100) > 0) {
      }
    }
  };
  turn(100);
  const auto begin = Clock::now();
  turn(100 + cycles);
  const double rate = cycles / seconds_since(begin);
  lcm_destroy(lcm);
  end_child(child);
  return rate;
}

double lockstep(const std::string& url, int cycles, std::int64_t controller_period, bool state_follows) {
  const pid_t child = in_child([&] {
    const auto bus = msgs::open_lcm_bus(url);
    controller::AnswerLoop loop(*bus, [&](const msgs::Encoder& encoder, const msgs::Operator&, msgs::Torque& torque,
                                          msgs::ControllerState& state) {
      torque.group_count = state.group_count = encoder.group_count;
      torque.motor_torque = state.proportional_torque = state.integral_torque = encoder.shaft_speed;
      torque.state_follows = state_follows;
    });
    for (;;) bus->handle_one(std::chrono::milliseconds{1000});
  });
  const auto bus = msgs::open_lcm_bus(url);
  const TemporaryFolder folder;
  msgs::LogWriter log(folder.path() / "run.lcmlog");
  sim::ToyPlant plant(2);
  sim::LockstepSettings settings;
  settings.controller_period = controller_period;
  settings.duration = (100 + cycles) * controller_period;
  Clock::time_point begin;
  sim::LockstepHooks hooks;
  hooks.after_cycle = [&](const sim::LockstepCounts& counts) {
    if (counts.cycles == 100) begin = Clock::now();
  };
  sim::run_lockstep(settings, plant, *bus, log, hooks);
  log.finish();
  const double rate = cycles / seconds_since(begin);
  end_child(child);
  return rate;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run(int rounds, int cycles) {
  const msgs::ReservedPort port;
  const std::string url = msgs::bus_url(port.number());
  if (const std::string problem = msgs::multicast_problem(url); !problem.empty()) {
    std::fprintf(stderr, "%s\n", problem.c_str());
    return 2;
  }
  struct Case {
    const char* name;
    std::int64_t period;  // [ns]
    bool state;
    std::vector<double> rates;
  };
  std::vector<Case> cases{{"lockstep, controller every 1 ms, TORQUE alone", 1'000'000, false, {}},
                          {"lockstep, controller every 1 ms, with CONTROLLER_STATE", 1'000'000, true, {}},
                          {"lockstep, controller every 10 ms, with CONTROLLER_STATE", 10'000'000, true, {}}};
  std::vector<double> bare;
  for (int round = 0; round < rounds; ++round) {
    bare.push_back(bare_ping_pong(url, cycles));
    for (Case& c : cases) c.rates.push_back(lockstep(url, cycles, c.period, c.state));
  }
  std::printf("%-58s %10s %8s\n", "median of the rounds", "cycles/s", "of bare");
  std::printf("%-58s %10.0f %8.2f\n", "bare LCM ping-pong", median(bare), 1.0);
  for (const Case& c : cases) {
    std::printf("%-58s %10.0f %8.2f\n", c.name, median(c.rates), median(c.rates) / median(bare));
  }
  return 0;
}

}  // namespace
}  // namespace slewlab

int main(int argc, char** argv) {
  return slewlab::run(slewlab::number_argument(argc, argv, 1, 7), slewlab::number_argument(argc, argv, 2, 5000));
}
