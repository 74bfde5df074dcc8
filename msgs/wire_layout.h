#pragma once

// The byte layout of every message as the .lcm files have it (msgs/layouts.cmake), for whoever has to do with bytes of any
// channel: the codec, the order of a log's messages, tables.

#include <array>
#include <cstdint>
#include <optional>
#include <slewlab_msgs/layouts.hpp>
#include <span>
#include <string_view>

#include "msgs/codec.h"

namespace slewlab::msgs {

constexpr std::size_t kChannels = 8;
constexpr std::size_t kMostCounts = 3;  // of arrays in one message

struct WireMessage {
  std::string_view channel;
  std::int64_t fingerprint = 0;
  std::span<const Piece> pieces;
  std::span<const WireField> fields;
  bool is_answer = false;          // counts by the ENCODER it answers
  std::size_t answered_at = 0;     // [bytes] where answered_sequence stands in an answer
};

// In the order ENCODER, TORQUE, OPERATOR, SENSORS, TRUTH, CONTROLLER_STATE, PLANT_STATUS, MOTION.
const std::array<WireMessage, kChannels>& wire_messages();
constexpr std::size_t kEncoderIndex = 0;
constexpr std::size_t kOperatorIndex = 2;
constexpr std::array<std::size_t, 4> kPlantIndices{0, 3, 4, 6};  // ENCODER, SENSORS, TRUTH, PLANT_STATUS

// Which of them a channel is; none: it is not slewlab's.
std::optional<std::size_t> channel_index(std::string_view channel);

// The lengths of a message's arrays, count by count.
using ArrayCounts = std::array<std::int32_t, kMostCounts>;

// What decode() says of the bytes, without decoding them; `counts` is meaningful where that is ok.
DecodeStatus check(Bytes bytes, std::int64_t fingerprint, std::span<const Piece> pieces, ArrayCounts& counts);

// What every message begins with.
struct WireHead {
  std::int64_t sequence = 0;
  std::int64_t simulated_time = 0;  // [ns]
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::int64_t key = 0;  // sequence, of an answer: of the ENCODER it answers, for a controller started anew counts from 0 again
};
// Of bytes that check() finds ok.
WireHead head_of(Bytes bytes, const WireMessage& message);

}  // namespace slewlab::msgs
