#include "msgs/codec.h"

#include <algorithm>
#include <array>
#include <slewlab_msgs/layouts.hpp>
#include <stdexcept>
#include <string>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kHeadBytes = kFingerprintBytes + 4 * 8;  // and sequence, simulated time, configuration, run

std::int64_t big_endian_64(const std::uint8_t* p) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | p[i];
  return static_cast<std::int64_t>(value);
}

std::int32_t big_endian_32(const std::uint8_t* p) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | p[i];
  return static_cast<std::int32_t>(value);
}

bool plausible_head(Bytes bytes) {
  constexpr std::int64_t kSequenceLimit = std::int64_t{1} << 40;
  constexpr std::int64_t kTimeLimit = 1'000'000'000'000'000'000;  // [ns]
  const std::int64_t sequence = big_endian_64(bytes.data() + 8);
  const std::int64_t time = big_endian_64(bytes.data() + 16);
  return sequence >= 0 && sequence <= kSequenceLimit && time >= 0 && time <= kTimeLimit;
}

template <class Message>
DecodeStatus check(Bytes bytes) {
  if (bytes.size() < kFingerprintBytes) return DecodeStatus::truncated;
  if (big_endian_64(bytes.data()) != Message::getHash()) {
    if (bytes.size() < kHeadBytes) return DecodeStatus::garbage;
    return plausible_head(bytes) ? DecodeStatus::other_version : DecodeStatus::garbage;
  }
  std::size_t left = bytes.size() - kFingerprintBytes;
  std::array<std::size_t, std::max(1, Layout<Message>::counts)> counts{};
  for (const Piece& piece : Layout<Message>::pieces) {
    const std::size_t wanted = piece.kind == Piece::array ? counts[piece.index] * piece.bytes : piece.bytes;
    if (left < wanted) return DecodeStatus::truncated;
    left -= wanted;
    if (piece.kind != Piece::count) continue;
    const std::int32_t count = big_endian_32(bytes.data() + bytes.size() - left - piece.bytes);
    if (count < 0) return DecodeStatus::garbage;
    counts[piece.index] = static_cast<std::size_t>(count);
  }
  return left == 0 ? DecodeStatus::ok : DecodeStatus::garbage;
}

template <class Message>
DecodeStatus decode_checked(Bytes bytes, Message& message) {
  const DecodeStatus status = check<Message>(bytes);
  if (status != DecodeStatus::ok) return status;
  // The generated decoder leaves an array alone whose count is zero.
  Layout<Message>::arrays(message, [](auto, auto& array) { array.clear(); });
  const int size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size ? DecodeStatus::ok : DecodeStatus::garbage;
}

template <class Message>
void encode_checked(const Message& message, std::vector<std::uint8_t>& bytes) {
  Layout<Message>::arrays(message, [](auto count, const auto& array) {
    if (count < 0 || array.size() != static_cast<std::size_t>(count)) {
      throw std::logic_error(std::string(Message::getTypeName()) + ": an array of " +
                             std::to_string(array.size()) + " elements whose count says " +
                             std::to_string(count));
    }
  });
  bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

}  // namespace

const char* to_string(DecodeStatus status) {
  switch (status) {
    case DecodeStatus::ok: return "ok";
    case DecodeStatus::truncated: return "truncated";
    case DecodeStatus::other_version: return "other version";
    case DecodeStatus::garbage: return "garbage";
  }
  return "unknown";
}

DecodeStatus decode(Bytes bytes, Encoder& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Torque& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Operator& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Sensors& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Truth& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, ControllerState& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, PlantStatus& message) { return decode_checked(bytes, message); }

void encode(const Encoder& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Torque& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Operator& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Sensors& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Truth& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const ControllerState& message, std::vector<std::uint8_t>& bytes) {
  encode_checked(message, bytes);
}
void encode(const PlantStatus& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }

}  // namespace slewlab::msgs
