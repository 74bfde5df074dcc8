#include "common/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <latch>
#include <thread>

namespace slewlab::common {
namespace {

// The thread sanitizer calls it a race where what the handler writes is no atomic number.
TEST(StopSignal, IsSeenByAThreadThatAsks) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";  // a process of its own, not a copy of this one
  EXPECT_EXIT(
      {
        catch_stop_signals();
        std::latch asking(1);
        std::thread other([&] {
          asking.count_down();
          while (!stop_requested()) std::this_thread::yield();
        });
        asking.wait();
        std::raise(SIGTERM);
        std::raise(SIGINT);
        other.join();
        std::exit(stop_exit_code());
      },
      testing::ExitedWithCode(128 + SIGTERM), "");
}

}  // namespace
}  // namespace slewlab::common
