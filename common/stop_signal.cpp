#include "common/stop_signal.h"

#include <csignal>

namespace slewlab::common {
namespace {

volatile std::sig_atomic_t received = 0;

}  // namespace

void catch_stop_signals() {
  struct sigaction action{};
  action.sa_handler = [](int number) { received = number; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int stop_signal() { return received; }

}  // namespace slewlab::common
