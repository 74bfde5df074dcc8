#include "msgs/logged_run.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "msgs/log_piece.h"

namespace slewlab::msgs {
namespace {

template <class Message>
void read_message(EventsAt& events, const EventHead& head, Message& message) {
  if (decode(events.data(head.offset), message) == DecodeStatus::ok) return;
  throw LogError("the log changed while it was read: the message at byte " + std::to_string(head.offset));
}

}  // namespace

LoggedRuns logged_runs(const std::filesystem::path& path) {
  RunOrder order = order_runs(path);
  LoggedRuns logged{{}, std::move(order.remarks), order.lost_bytes, order.lost_messages};
  for (OrderedRun& run : order.runs) logged.runs.push_back({path, std::move(run)});
  return logged;
}

RunLog read_run(const LoggedRun& run) {
  return read_run(run, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max());
}

RunLog read_run(const LoggedRun& run, std::int64_t from, std::int64_t to) {
  RunLog part;
  part.configuration_hash = run.order.configuration_hash;
  part.run_identity = run.order.run_identity;
  EventsAt events(run.path);
  std::size_t channel = 0;  // in the order of wire_messages()
  const auto read = [&](auto& messages) {
    const std::vector<EventHead>& heads = run.order.channels[channel];
    const auto is_within = [&](const EventHead& head) { return head.time >= from && head.time <= to; };
    auto first = std::find_if(heads.begin(), heads.end(), [&](const EventHead& head) { return head.time >= from; });
    if (std::find(kHeld.begin(), kHeld.end(), channel) != kHeld.end() && first != heads.begin()) {
      read_message(events, *(first - 1), messages.emplace_back());
    }
    messages.reserve(messages.size() + static_cast<std::size_t>(std::count_if(first, heads.end(), is_within)));
    for (auto head = first; head != heads.end(); ++head) {
      if (is_within(*head)) read_message(events, *head, messages.emplace_back());
    }
    ++channel;
  };
  read(part.encoder);
  read(part.torque);
  read(part.operator_moves);
  read(part.sensors);
  read(part.truth);
  read(part.controller_state);
  read(part.plant_status);
  return part;
}

std::vector<Encoder> read_encoders(const LoggedRun& run, std::int64_t distance) {
  EventsAt events(run.path);
  std::vector<Encoder> encoders;
  for (const EventHead& head : run.order.channels[kEncoderIndex]) {
    if (!encoders.empty() && head.time - encoders.back().simulated_time < distance) continue;
    read_message(events, head, encoders.emplace_back());
  }
  return encoders;
}

}  // namespace slewlab::msgs
