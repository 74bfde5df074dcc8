#include "common/stop_signal.h"

#include <csignal>

namespace slewlab::common {
namespace {

volatile std::sig_atomic_t received = 0;

}  // namespace

void catch_stop_signals() {
  struct sigaction action{};
  action.sa_handler = [](int number) {
    if (received == 0) received = number;
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
