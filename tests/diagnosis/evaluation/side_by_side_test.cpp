#include "diagnosis/evaluation/side_by_side.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <stdexcept>

namespace slewlab::diagnosis::withheld {
namespace {

constexpr std::size_t kCount = 40;

TEST(SideBySide, DoesEachOnceWithOneThreadAndWithThree) {
  for (const int threads : {0, 1, 3}) {
    std::array<std::atomic<int>, kCount> times{};
    EXPECT_TRUE(side_by_side(kCount, threads, {}, [&](std::size_t n) { ++times[n]; }));
    for (const std::atomic<int>& one : times) EXPECT_EQ(one, 1) << threads << " threads";
  }
  EXPECT_TRUE(side_by_side(0, 2, {}, [](std::size_t) { FAIL() << "there is nothing to do"; }));
}

TEST(SideBySide, BeginsNothingMoreOnceItIsStopped) {
  int done = 0;
  EXPECT_FALSE(side_by_side(kCount, 1, [&] { return done == 3; }, [&](std::size_t) { ++done; }));
  EXPECT_EQ(done, 3);
  // Stopped after the last: all of it is done.
  done = 0;
  EXPECT_TRUE(side_by_side(3, 1, [&] { return done == 3; }, [&](std::size_t) { ++done; }));
}

TEST(SideBySide, ThrowsWhatTheWorkThrowsAndLeavesTheRest) {
  int done = 0;
  const auto work = [&](std::size_t n) {
    if (n == 2) throw std::runtime_error("the third");
    ++done;
  };
  EXPECT_THROW(side_by_side(kCount, 1, {}, work), std::runtime_error);
  EXPECT_EQ(done, 2);
}

TEST(SideBySide, WorkThatUnwindsBecauseItIsStoppedIsNoFailure) {
  std::atomic<bool> stop{false};
  const auto work = [&](std::size_t n) {
    if (n < 2) return;
    stop = true;
    throw std::runtime_error("unwound");
  };
  EXPECT_FALSE(side_by_side(kCount, 2, [&] { return stop.load(); }, work));
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
