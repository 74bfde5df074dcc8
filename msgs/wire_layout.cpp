#include "msgs/wire_layout.h"

#include <algorithm>

#include "msgs/messages.h"

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
WireMessage wire_message(const char* channel) {
  static_assert(Layout<Message>::counts <= static_cast<int>(kMostCounts));
  WireMessage wire{channel, Message::getHash(), Layout<Message>::pieces, Layout<Message>::fields};
  std::size_t at = kFingerprintBytes;
  for (const WireField& field : wire.fields) {
    if (field.count >= 0) break;  // what stands behind an array has no fixed place
    if (field.name == "answered_sequence") {
      wire.is_answer = true;
      wire.answered_at = at;
    }
    at += field.bytes;
  }
  return wire;
}

}  // namespace

const std::array<WireMessage, kChannels>& wire_messages() {
  static const std::array<WireMessage, kChannels> messages{
      wire_message<Encoder>(kEncoderChannel),   wire_message<Torque>(kTorqueChannel),
      wire_message<Operator>(kOperatorChannel), wire_message<Sensors>(kSensorsChannel),
      wire_message<Truth>(kTruthChannel),       wire_message<ControllerState>(kControllerStateChannel),
      wire_message<PlantStatus>(kPlantStatusChannel), wire_message<Motion>(kMotionChannel)};
  return messages;
}

std::optional<std::size_t> channel_index(std::string_view channel) {
  const auto& messages = wire_messages();
  for (std::size_t c = 0; c < messages.size(); ++c) {
    if (messages[c].channel == channel) return c;
  }
  return std::nullopt;
}

DecodeStatus check(Bytes bytes, std::int64_t fingerprint, std::span<const Piece> pieces, ArrayCounts& counts) {
  counts = {};
  if (bytes.size() < kFingerprintBytes) return DecodeStatus::truncated;
  if (big_endian_64(bytes.data()) != fingerprint) {
    if (bytes.size() < kHeadBytes) return DecodeStatus::garbage;
    return plausible_head(bytes) ? DecodeStatus::other_version : DecodeStatus::garbage;
  }
  std::size_t left = bytes.size() - kFingerprintBytes;
  for (const Piece& piece : pieces) {
    const std::size_t wanted =
        piece.kind == Piece::array ? static_cast<std::size_t>(counts[piece.index]) * piece.bytes : piece.bytes;
    if (left < wanted) return DecodeStatus::truncated;
    left -= wanted;
    if (piece.kind != Piece::count) continue;
    const std::int32_t count = big_endian_32(bytes.data() + bytes.size() - left - piece.bytes);
    if (count < 0) return DecodeStatus::garbage;
    counts[piece.index] = count;
  }
  return left == 0 ? DecodeStatus::ok : DecodeStatus::garbage;
}

WireHead head_of(Bytes bytes, const WireMessage& message) {
  WireHead head;
  head.sequence = big_endian_64(bytes.data() + 8);
  head.simulated_time = big_endian_64(bytes.data() + 16);
  head.configuration_hash = big_endian_64(bytes.data() + 24);
  head.run_identity = big_endian_64(bytes.data() + 32);
  head.key = message.is_answer ? big_endian_64(bytes.data() + message.answered_at) : head.sequence;
  return head;
}

}  // namespace slewlab::msgs
