#include "msgs/datagram.h"

#include <gtest/gtest.h>

#include <string>

namespace slewlab::msgs {
namespace {

Bytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Laid out by hand from LCM's description of its protocol.
const std::string kHead = std::string("LC02") + std::string("\0\0\0\7", 4);

TEST(Datagram, IsTakenApartIntoChannelAndData) {
  const std::string whole = kHead + "TORQUE" + '\0' + "abc";
  const auto datagram = read_datagram(bytes_of(whole));
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->channel, "TORQUE");
  EXPECT_EQ(std::string(datagram->data.begin(), datagram->data.end()), "abc");
}

TEST(Datagram, MayCarryNoData) {
  const std::string whole = kHead + "TORQUE" + '\0';
  const auto datagram = read_datagram(bytes_of(whole));
  ASSERT_TRUE(datagram);
  EXPECT_TRUE(datagram->data.empty());
}

TEST(Datagram, WhatIsNoneIsRefused) {
  EXPECT_FALSE(read_datagram({}));
  EXPECT_FALSE(read_datagram(bytes_of(kHead.substr(0, 7))));
  EXPECT_FALSE(read_datagram(bytes_of(kHead))) << "no channel";
  EXPECT_FALSE(read_datagram(bytes_of(kHead + "TORQUE"))) << "no zero behind the channel's name";
  EXPECT_FALSE(read_datagram(bytes_of("LC03" + kHead.substr(4) + "TORQUE" + '\0'))) << "a fragment";
}

}  // namespace
}  // namespace slewlab::msgs
