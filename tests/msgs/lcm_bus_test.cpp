// Runs in a private network (tests/msgs/CMakeLists.txt): real LCM multicast on a loopback that nobody shares.

#include "msgs/lcm_bus.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace slewlab::msgs {
namespace {

using std::chrono::milliseconds;

const std::vector<std::uint8_t> kByte{42};
constexpr milliseconds kPatience{10'000};

TEST(LcmBus, CarriesBytesBetweenTwoParties) {
  const ReservedPort port;
  const auto left = open_lcm_bus(bus_url(port.number()));
  const auto right = open_lcm_bus(bus_url(port.number()));
  std::vector<std::uint8_t> heard;
  right->subscribe("A", [&](Bytes bytes) { heard.assign(bytes.begin(), bytes.end()); });
  left->publish("A", kByte);
  ASSERT_TRUE(right->handle_one(kPatience));
  EXPECT_EQ(heard, kByte);
  EXPECT_FALSE(right->handle_one(milliseconds{0}));
}

// LCM keeps 30 messages unless told otherwise and drops the newest beyond that. A hundred small ones fit into the
// socket's own buffer (208 KiB by default, under 1 KiB each), so that none is lost there on a busy machine.
TEST(LcmBus, AHundredWaitingMessagesAreAllThere) {
  const ReservedPort port;
  const auto left = open_lcm_bus(bus_url(port.number()));
  const auto right = open_lcm_bus(bus_url(port.number()));
  std::vector<int> heard;
  right->subscribe("A", [&](Bytes bytes) { heard.push_back(bytes[0]); });
  for (int i = 0; i < 100; ++i) left->publish("A", std::vector<std::uint8_t>{static_cast<std::uint8_t>(i)});
  while (heard.size() < 100) ASSERT_TRUE(right->handle_one(kPatience));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(heard[i], i);
}

TEST(LcmBus, BusesOnTwoPortsDoNotHearEachOther) {
  const ReservedPort here;
  const ReservedPort there;
  ASSERT_NE(here.number(), there.number());
  const auto left = open_lcm_bus(bus_url(here.number()));
  const auto right = open_lcm_bus(bus_url(there.number()));
  int heard_here = 0;
  int heard_there = 0;
  left->subscribe("A", [&](Bytes) { ++heard_here; });
  right->subscribe("A", [&](Bytes) { ++heard_there; });
  left->publish("A", kByte);
  ASSERT_TRUE(left->handle_one(kPatience));  // the sender hears itself: the message has been round
  EXPECT_FALSE(right->handle_one(milliseconds{0}));
  EXPECT_EQ(heard_there, 0);
}

TEST(LcmBus, WhatAHandlerThrowsComesOutOfHandleOne) {
  const ReservedPort port;
  const auto bus = open_lcm_bus(bus_url(port.number()));
  bus->subscribe("A", [](Bytes) { throw std::out_of_range("handler"); });
  bus->publish("A", kByte);
  EXPECT_THROW(bus->handle_one(kPatience), std::out_of_range);
}

TEST(LcmBus, AUrlThatIsNoBusIsRefused) {
  EXPECT_THROW(open_lcm_bus("udpm://127.0.0.1:7667"), BusError);
  EXPECT_THROW(open_lcm_bus("nonsense"), BusError);
}

// Last in the file: it takes the route away that the tests before it need.
TEST(LcmBusWithoutRoute, SaysAtOnceWhichCommandsMendIt) {
  ASSERT_EQ(multicast_problem(bus_url(kDefaultPort)), "");
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  try {
    open_lcm_bus(bus_url(kDefaultPort));
    FAIL();
  } catch (const BusError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("ip link set lo multicast on"), std::string::npos) << text;
    EXPECT_NE(text.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace slewlab::msgs
