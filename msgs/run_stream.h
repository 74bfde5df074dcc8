#pragma once

// The runs of a log message by message, as read_run_logs() (msgs/run_log.h) has them in memory: the same messages in the
// same order. What is kept is one buffer per channel that is being read and, where the log is not in order as it stands
// (msgs/file_order.h), 24 bytes per message; so a log may be larger than memory.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "msgs/codec.h"
#include "msgs/file_order.h"
#include "msgs/wire_layout.h"

namespace slewlab::msgs {

// A channel's messages, one per call, keys rising; nothing behind the last. The bytes are valid until the next call.
using NextBytes = std::function<std::optional<Bytes>()>;

struct RunStream {
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::array<ChannelExtent, kChannels> channels;
  std::function<NextBytes(std::size_t channel)> open;  // from the channel's beginning; several may be read beside each other
};

struct RunStreams {
  std::vector<RunStream> runs;       // in the order in which they begin in the file
  std::vector<std::string> remarks;  // what could not be used, one line each
  std::int64_t lost_bytes = 0;       // as in RunLogs (msgs/run_log.h)
  std::int64_t lost_messages = 0;
};

// Throws LogError where the file cannot be read or holds no message of slewlab; so does reading them.
RunStreams run_streams(const std::filesystem::path& path);

template <class Message>
constexpr std::size_t channel_of() {
  if constexpr (std::is_same_v<Message, Encoder>) return 0;
  if constexpr (std::is_same_v<Message, Torque>) return 1;
  if constexpr (std::is_same_v<Message, Operator>) return 2;
  if constexpr (std::is_same_v<Message, Sensors>) return 3;
  if constexpr (std::is_same_v<Message, Truth>) return 4;
  if constexpr (std::is_same_v<Message, ControllerState>) return 5;
  if constexpr (std::is_same_v<Message, PlantStatus>) return 6;
}

template <class Message>
const ChannelExtent& extent_of(const RunStream& run) {
  return run.channels[channel_of<Message>()];
}

// Reads a channel message by message: `current()` is nullptr behind the last.
template <class Message>
class MessageReader {
 public:
  explicit MessageReader(const RunStream& run) : next_(run.open(channel_of<Message>())) { advance(); }
  const Message* current() const { return is_there_ ? &message_ : nullptr; }
  void advance() {
    const std::optional<Bytes> bytes = next_();
    is_there_ = bytes.has_value();
    if (is_there_ && decode(*bytes, message_) != DecodeStatus::ok) throw LogError("the log changed while it was read");
  }

 private:
  NextBytes next_;
  Message message_{};
  bool is_there_ = false;
};

}  // namespace slewlab::msgs
