#include "msgs/log_queue.h"

#include <gtest/gtest.h>

#include "msgs/log_reader.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

TEST(LogQueue, TheFileHoldsWhatWasPutInItsOrderHoweverOftenTheMemoryWrapsAround) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  LogWriter writer(path);
  LogQueue queue(writer, 100'000);
  std::int64_t put = 0;
  while (put < 5000) {
    const std::vector<std::uint8_t> data(static_cast<std::size_t>(put % 97), static_cast<std::uint8_t>(put));
    const std::int64_t left_out = queue.left_out();
    queue.put("SENSORS", put, data);
    if (queue.left_out() == left_out) {
      ++put;
    } else {
      std::this_thread::yield();  // and again, once the other thread has made room
    }
  }
  queue.finish();
  writer.finish();
  LogReader reader(path);
  LogEvent event;
  std::int64_t read = 0;
  while (reader.next(event)) {
    EXPECT_EQ(event.timestamp_us, read);
    EXPECT_EQ(event.data.size(), static_cast<std::size_t>(read % 97));
    if (!event.data.empty()) {
      EXPECT_EQ(event.data.back(), static_cast<std::uint8_t>(read));
    }
    ++read;
  }
  EXPECT_EQ(read, 5000);
}

TEST(LogQueue, WhatDoesNotFitIsLeftOutAndCounted) {
  const TemporaryFolder folder;
  LogWriter writer(folder.path() / "run.lcmlog");
  LogQueue queue(writer, 100);
  queue.put("SENSORS", 0, std::vector<std::uint8_t>(200));
  EXPECT_EQ(queue.left_out(), 1);
  queue.finish();
  EXPECT_EQ(writer.event_count(), 0);
}

}  // namespace
}  // namespace slewlab::msgs
