#include "msgs/codec.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/msgs/example_messages.h"

namespace slewlab::msgs {
namespace {

template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes;
  encode(message, bytes);
  return bytes;
}

// Every message, with small and with empty arrays.
template <class Visit>
void for_every_message(Visit visit) {
  for (const int count : {0, 1, 3}) {
    visit(example::encoder(count));
    visit(example::torque(count));
    visit(example::truth(count, 2 * count, 4 * count));
    visit(example::controller_state(count));
    visit(example::plant_status(count, 2 * count));
  }
  visit(example::operator_move());
  visit(example::sensors());
  visit(example::motion());
}

TEST(Codec, AnEncodedMessageComesBackWithEveryField) {
  for_every_message([](const auto& message) {
    const auto bytes = encoded(message);
    // A used object, so that what it held before must vanish.
    auto back = message;
    back.sequence = 99;
    ASSERT_EQ(decode(bytes, back), DecodeStatus::ok) << message.getTypeName();
    EXPECT_EQ(encoded(back), bytes) << message.getTypeName();
  });
  Torque torque;
  ASSERT_EQ(decode(encoded(example::torque()), torque), DecodeStatus::ok);
  EXPECT_EQ(torque.simulated_time, 8'000'000);
  EXPECT_EQ(torque.run_identity, 0x0fedcba987654321LL);
  EXPECT_EQ(torque.alive_counter, 9);
  EXPECT_EQ(torque.enable, 1);
  EXPECT_EQ(torque.brake, 0);
  EXPECT_EQ(torque.motor_torque, (std::vector<double>{100.0, 101.0}));
}

TEST(Codec, AnEmptyArrayReplacesAFullOne) {
  Encoder message = example::encoder(3);
  ASSERT_EQ(decode(encoded(example::encoder(0)), message), DecodeStatus::ok);
  EXPECT_TRUE(message.shaft_speed.empty());
}

TEST(Codec, EveryShorteningIsTruncatedAndEveryExtensionGarbage) {
  for_every_message([](auto message) {
    auto bytes = encoded(message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_EQ(decode(Bytes(bytes.data(), size), message), DecodeStatus::truncated)
          << message.getTypeName() << " cut to " << size << " of " << bytes.size();
    }
    bytes.push_back(0);
    EXPECT_EQ(decode(bytes, message), DecodeStatus::garbage) << message.getTypeName();
  });
}

TEST(Codec, AnArrayCountBeyondTheBytesAllocatesNothing) {
  auto bytes = encoded(example::torque());
  Torque message;
  const std::size_t count_at = 8 + 6 * 8 + 4;  // fingerprint, six numbers, four flags
  const auto set_count = [&](std::uint32_t count) {
    for (std::size_t i = 0; i < 4; ++i) bytes[count_at + i] = static_cast<std::uint8_t>(count >> (24 - 8 * i));
  };
  set_count(0x7fffffff);
  EXPECT_EQ(decode(bytes, message), DecodeStatus::truncated);
  EXPECT_TRUE(message.motor_torque.empty());
  set_count(0xffffffff);  // -1
  EXPECT_EQ(decode(bytes, message), DecodeStatus::garbage);
  set_count(1);  // one torque too many behind it
  EXPECT_EQ(decode(bytes, message), DecodeStatus::garbage);
  set_count(2);
  EXPECT_EQ(decode(bytes, message), DecodeStatus::ok);
}

TEST(Codec, AnotherFingerprintIsAnotherVersionIfTheHeadIsPlausible) {
  auto bytes = encoded(example::torque());
  Torque message;
  bytes[3] ^= 1;
  EXPECT_EQ(decode(bytes, message), DecodeStatus::other_version);
  bytes[8] = 0x80;  // a negative sequence number
  EXPECT_EQ(decode(bytes, message), DecodeStatus::garbage);
  // A message of ours on another one's channel is not garbage either.
  EXPECT_EQ(decode(encoded(example::encoder()), message), DecodeStatus::other_version);
}

TEST(Codec, RandomBytesAreGarbageOrTruncated) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> bytes(random() % 200);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    for_every_message([&](auto message) {
      const DecodeStatus status = decode(bytes, message);
      EXPECT_TRUE(status == DecodeStatus::garbage || status == DecodeStatus::truncated);
    });
  }
}

TEST(Codec, ChangedBytesNeverDecodeToArraysOfAnotherLengthThanTheirCount) {
  std::mt19937_64 random(2);
  for_every_message([&](auto message) {
    const auto good = encoded(message);
    for (int round = 0; round < 2'000; ++round) {
      auto bytes = good;
      for (int changes = 0; changes < 3; ++changes) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
      // Encoding checks each array against its count, and the sizes must agree.
      if (decode(bytes, message) == DecodeStatus::ok) {
        EXPECT_EQ(encoded(message).size(), bytes.size());
      }
    }
  });
}

TEST(Codec, AnArrayThatDoesNotMatchItsCountIsNotSent) {
  Torque message = example::torque();
  message.group_count = 3;
  std::vector<std::uint8_t> bytes;
  EXPECT_THROW(encode(message, bytes), std::logic_error);
}

}  // namespace
}  // namespace slewlab::msgs
