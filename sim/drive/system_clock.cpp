#include "sim/drive/system_clock.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>
#include <ctime>

namespace slewlab::sim {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

}  // namespace

std::int64_t SystemClock::now() { return read_clock(CLOCK_MONOTONIC); }

std::int64_t SystemClock::processor_time() { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

void SystemClock::sleep_until(std::int64_t time) {
  timespec until{};
  until.tv_sec = time / kNanosecondsPerSecond;
  until.tv_nsec = time % kNanosecondsPerSecond;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::vector<std::string> ask_for_real_time() {
  std::vector<std::string> lines;
  // Without real-time scheduling the kernel rounds wake-ups by 50 us unless told not to.
  prctl(PR_SET_TIMERSLACK, 1UL);
  constexpr int kPriority = 49;  // above all ordinary threads, below the kernel's interrupt threads at 50
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  lines.push_back(error == 0 ? "SCHED_FIFO: yes, priority " + std::to_string(parameters.sched_priority)
                             : std::string("SCHED_FIFO: no (") + std::strerror(error) +
                                   "): wake-ups depend on what else runs here; root, CAP_SYS_NICE or 'ulimit -r 50' permit it");
  const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  lines.push_back(locked ? "memory locked: yes"
                         : std::string("memory locked: no (") + std::strerror(errno) +
                               "): a page fault may delay a step; root, CAP_IPC_LOCK or 'ulimit -l unlimited' permit it");
  return lines;
}

}  // namespace slewlab::sim
