#include "msgs/run_log.h"

#include <utility>

#include "msgs/run_order.h"

namespace slewlab::msgs {
namespace {

template <class Message>
void read_channel(EventsAt& events, std::vector<EventHead>& heads, std::vector<Message>& messages) {
  messages.resize(heads.size());
  for (std::size_t i = 0; i < heads.size(); ++i) {
    if (decode(events.data(heads[i].offset), messages[i]) != DecodeStatus::ok) {
      throw LogError("the log changed while it was read: the message at byte " + std::to_string(heads[i].offset));
    }
  }
  heads = std::vector<EventHead>();
}

}  // namespace

RunLogs read_run_logs(const std::filesystem::path& path) {
  RunOrder order = order_runs(path);
  RunLogs logs;
  logs.remarks = std::move(order.remarks);
  logs.lost_bytes = order.lost_bytes;
  logs.lost_messages = order.lost_messages;
  EventsAt events(path);
  for (OrderedRun& ordered : order.runs) {
    RunLog run;
    run.configuration_hash = ordered.configuration_hash;
    run.run_identity = ordered.run_identity;
    std::size_t next = 0;  // in the order of wire_messages()
    const auto read = [&](auto& messages) { read_channel(events, ordered.channels[next++], messages); };
    read(run.encoder);
    read(run.torque);
    read(run.operator_moves);
    read(run.sensors);
    read(run.truth);
    read(run.controller_state);
    read(run.plant_status);
    logs.runs.push_back(std::move(run));
  }
  return logs;
}

}  // namespace slewlab::msgs
