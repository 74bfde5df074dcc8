// Runs in a private network (tests/msgs/CMakeLists.txt): real LCM multicast on a loopback that nobody shares.

#include "msgs/lcm_bus.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

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

// liblcm keeps 30 messages unless told otherwise and drops the newest beyond that. A hundred small ones fit
// into a socket's buffer even where the system grants no more than its default (208 KiB, under 1 KiB each).
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
  EXPECT_EQ(heard_here, 1);
  EXPECT_FALSE(right->handle_one(milliseconds{0}));
  EXPECT_EQ(heard_there, 0);
}

TEST(LcmBus, WhatIsUnsubscribedHearsNothingAnyMore) {
  const ReservedPort port;
  const auto bus = open_lcm_bus(bus_url(port.number()));
  int staying = 0;
  bus->subscribe("A", [&](Bytes) { ++staying; });
  int ended_by_itself = 0;
  Bus::SubscriptionId itself = -1;
  itself = bus->subscribe("A", [&](Bytes) {
    ++ended_by_itself;
    bus->unsubscribe(itself);
  });
  int scoped = 0;
  {
    const Subscription subscription(*bus, "A", [&](Bytes) { ++scoped; });
    bus->publish("A", kByte);
    ASSERT_TRUE(bus->handle_one(kPatience));
  }
  bus->publish("A", kByte);
  ASSERT_TRUE(bus->handle_one(kPatience));
  EXPECT_EQ(staying, 2);
  EXPECT_EQ(ended_by_itself, 1);
  EXPECT_EQ(scoped, 1);
}

// The protocol is LCM's: its own library hears us and we hear it, with every byte and the channel's name.
TEST(LcmBus, LcmsOwnLibraryIsAPartyToTheBus) {
  const ReservedPort port;
  const std::string url = bus_url(port.number());
  lcm_t* lcm = lcm_create(url.c_str());
  ASSERT_NE(lcm, nullptr);
  struct Heard {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  } heard;
  lcm_subscribe(
      lcm, ".*",
      [](const lcm_recv_buf_t* buffer, const char* channel, void* user) {
        const auto* data = static_cast<const std::uint8_t*>(buffer->data);
        *static_cast<Heard*>(user) = {channel, {data, data + buffer->data_size}};
      },
      &heard);
  const auto bus = open_lcm_bus(url);
  std::vector<std::uint8_t> received;
  bus->subscribe("FROM_LCM", [&](Bytes bytes) { received.assign(bytes.begin(), bytes.end()); });

  std::vector<std::uint8_t> data(3000);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i * 7);
  bus->publish("FROM_US", data);
  while (heard.channel != "FROM_US") ASSERT_GT(lcm_handle_timeout(lcm, static_cast<int>(kPatience.count())), 0);
  EXPECT_EQ(heard.bytes, data);

  ASSERT_EQ(lcm_publish(lcm, "FROM_LCM", data.data(), 2000), 0);
  ASSERT_TRUE(bus->handle_one(kPatience));
  EXPECT_EQ(received, std::vector<std::uint8_t>(data.begin(), data.begin() + 2000));
  lcm_destroy(lcm);
}

TEST(LcmBus, DatagramsThatAreNoLcmMessageAreLeftAlone) {
  const ReservedPort port;
  const auto bus = open_lcm_bus(bus_url(port.number()));
  int heard = 0;
  bus->subscribe("A", [&](Bytes) { ++heard; });
  const int stranger = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(static_cast<std::uint16_t>(port.number()));
  inet_pton(AF_INET, "239.255.76.67", &group.sin_addr);
  const auto send = [&](const std::string& bytes) {
    ::sendto(stranger, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&group), sizeof group);
  };
  using namespace std::string_literals;
  send("");
  send("LC02");
  send("LC02\0\0\0\0A"s);          // no zero behind the channel's name
  send("LC03\0\0\0\0A\0data"s);    // another kind of datagram
  send("XXXX\0\0\0\0A\0data"s);
  send("LC02\0\0\0\0A\0"s);        // a whole message without data
  ::close(stranger);
  ASSERT_TRUE(bus->handle_one(kPatience));
  EXPECT_FALSE(bus->handle_one(milliseconds{0}));
  EXPECT_EQ(heard, 1);
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
  EXPECT_THROW(open_lcm_bus("udpm://239.255.76.67:70000"), BusError);
  EXPECT_THROW(open_lcm_bus("udpm://239.255.76.67:7667?ttl=x"), BusError);
  EXPECT_THROW(open_lcm_bus("udpm://239.255.76.67:7667?loud=1"), BusError);
}

// Last in the file: it takes the route away that the tests before it need.
TEST(LcmBusWithoutRoute, SaysAtOnceWhichCommandsMendIt) {
  ASSERT_EQ(multicast_problem(bus_url(kDefaultPort)), "");
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);  // NOLINT(bugprone-command-processor): one command, and no word of it from outside
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
