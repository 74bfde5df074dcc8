#include "msgs/memory_bus.h"

#include <gtest/gtest.h>

namespace slewlab::msgs {
namespace {

using std::chrono::milliseconds;

const std::vector<std::uint8_t> kOne{1};
const std::vector<std::uint8_t> kTwo{2, 2};

TEST(MemoryBus, CarriesToEverySubscriberInOrder) {
  MemoryWire wire;
  const auto left = wire.connect();
  const auto right = wire.connect();
  std::vector<std::size_t> heard;
  right->subscribe("A", [&](Bytes bytes) { heard.push_back(bytes.size()); });
  right->subscribe("B", [&](Bytes bytes) { heard.push_back(10 + bytes.size()); });
  left->publish("A", kOne);
  left->publish("B", kTwo);
  left->publish("C", kTwo);
  left->publish("A", kTwo);
  EXPECT_EQ(right->drain(), 3);
  EXPECT_EQ(heard, (std::vector<std::size_t>{1, 12, 2}));
}

TEST(MemoryBus, WaitingRunsTheOtherSideAndThenCountsAsTimedOut) {
  MemoryWire wire;
  const auto left = wire.connect();
  const auto right = wire.connect();
  int heard = 0;
  int waits = 0;
  left->subscribe("A", [&](Bytes) { ++heard; });
  left->on_wait = [&] {
    if (++waits == 2) right->publish("A", kOne);
  };
  EXPECT_FALSE(left->handle_one(milliseconds{30}));
  EXPECT_EQ(left->waited, milliseconds{30});
  EXPECT_TRUE(left->handle_one(milliseconds{30}));
  EXPECT_EQ(left->waited, milliseconds{30});
  EXPECT_EQ(heard, 1);
}

TEST(MemoryBus, MessagesCanBeLostDoubledAndChanged) {
  MemoryWire wire;
  const auto left = wire.connect();
  const auto right = wire.connect();
  std::vector<std::uint8_t> heard;
  right->subscribe("A", [&](Bytes bytes) { heard.insert(heard.end(), bytes.begin(), bytes.end()); });
  int copies = 0;
  wire.copies = [&](const std::string&, std::vector<std::uint8_t>& bytes) {
    bytes[0] = 9;
    return copies++;
  };
  for (int i = 0; i < 3; ++i) left->publish("A", kOne);
  right->drain();
  EXPECT_EQ(heard, (std::vector<std::uint8_t>{9, 9, 9}));
}

TEST(MemoryBus, WhatIsUnsubscribedHearsNothingAnyMoreNotEvenWhatWaits) {
  MemoryWire wire;
  const auto left = wire.connect();
  const auto right = wire.connect();
  int ended = 0;
  int staying = 0;
  const Bus::SubscriptionId id = right->subscribe("A", [&](Bytes) { ++ended; });
  right->subscribe("A", [&](Bytes) { ++staying; });
  left->publish("A", kOne);
  right->drain();
  left->publish("A", kOne);
  right->unsubscribe(id);
  right->unsubscribe(id);  // nothing to end any more
  right->drain();
  left->publish("A", kOne);
  right->drain();
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(staying, 3);
}

TEST(MemoryBus, AHandlerMayEndItsOwnSubscription) {
  MemoryWire wire;
  const auto left = wire.connect();
  int heard = 0;
  std::unique_ptr<Subscription> once;
  once = std::make_unique<Subscription>(*left, "A", [&](Bytes bytes) {
    once.reset();
    heard += static_cast<int>(bytes.size());  // its own state and the bytes still stand
  });
  left->publish("A", kTwo);
  left->publish("A", kTwo);
  left->drain();
  EXPECT_EQ(heard, 2);
}

}  // namespace
}  // namespace slewlab::msgs
