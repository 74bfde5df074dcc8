#include "common/stop_signal.h"

#include <atomic>
#include <csignal>

namespace slewlab::common {
namespace {

// Threads ask while a handler answers, in whichever thread the signal comes.
std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may use no other");

}  // namespace

void catch_stop_signals() {
  struct sigaction action{};
  action.sa_handler = [](int number) {
    int none = 0;
    received.compare_exchange_strong(none, number);
  };
  // Of two that come at once the second waits until the first is noted.
  sigaddset(&action.sa_mask, SIGINT);
  sigaddset(&action.sa_mask, SIGTERM);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() { return received != 0; }

int stop_signal() { return received; }

int stop_exit_code() {
  constexpr int kSignalExit = 128;
  return kSignalExit + received;
}

}  // namespace slewlab::common
