// A run in memory as a stream, for tests that change its messages.
#pragma once

#include <memory>

#include "msgs/run_log.h"
#include "msgs/run_stream.h"

namespace slewlab::tools {

template <class Message>
msgs::ChannelExtent extent_of_messages(const std::vector<Message>& messages) {
  if (messages.empty()) return {};
  const auto key = [](const Message& message) {
    if constexpr (requires { message.answered_sequence; }) {
      return message.answered_sequence;
    } else {
      return message.sequence;
    }
  };
  return {static_cast<std::int64_t>(messages.size()), key(messages.front()), messages.front().simulated_time, key(messages.back()),
          messages.back().simulated_time};
}

inline msgs::RunStream stream_of(const msgs::RunLog& log) {
  const auto kept = std::make_shared<const msgs::RunLog>(log);
  msgs::RunStream run{log.configuration_hash, log.run_identity, {}, {}};
  std::array<std::function<msgs::NextBytes()>, msgs::kChannels> begin;
  const auto add = [&]<class Message>(std::vector<Message> msgs::RunLog::* channel) {
    constexpr std::size_t c = msgs::channel_of<Message>();
    run.channels[c] = extent_of_messages((*kept).*channel);
    begin[c] = [kept, channel]() -> msgs::NextBytes {
      return [kept, channel, next = std::size_t{0}, bytes = std::vector<std::uint8_t>()]() mutable -> std::optional<msgs::Bytes> {
        const auto& messages = (*kept).*channel;
        if (next == messages.size()) return std::nullopt;
        msgs::encode(messages[next++], bytes);
        return msgs::Bytes(bytes);
      };
    };
  };
  add(&msgs::RunLog::encoder);
  add(&msgs::RunLog::torque);
  add(&msgs::RunLog::operator_moves);
  add(&msgs::RunLog::sensors);
  add(&msgs::RunLog::truth);
  add(&msgs::RunLog::controller_state);
  add(&msgs::RunLog::plant_status);
  run.open = [begin](std::size_t channel) { return begin[channel](); };
  return run;
}

}  // namespace slewlab::tools
