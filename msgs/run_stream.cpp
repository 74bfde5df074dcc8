#include "msgs/run_stream.h"

#include <memory>
#include <utility>

#include "msgs/run_order.h"

namespace slewlab::msgs {
namespace {

RunStream stream_in_order(const std::filesystem::path& path, const FileOrder& file) {
  RunStream run{file.configuration_hash, file.run_identity, file.channels, {}};
  run.open = [path](std::size_t channel) -> NextBytes {
    return [events = std::make_shared<EventsInOrder>(path, channel)] { return events->next(); };
  };
  return run;
}

RunStream stream_of_heads(const std::filesystem::path& path, OrderedRun&& ordered) {
  RunStream run{ordered.configuration_hash, ordered.run_identity, {}, {}};
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto& heads = ordered.channels[c];
    if (heads.empty()) continue;
    run.channels[c] = {static_cast<std::int64_t>(heads.size()), heads.front().key, heads.front().time, heads.back().key, heads.back().time};
  }
  run.open = [path, kept = std::make_shared<const OrderedRun>(std::move(ordered))](std::size_t channel) -> NextBytes {
    return [kept, channel, events = std::make_shared<EventsAt>(path), next = std::size_t{0}]() mutable -> std::optional<Bytes> {
      const auto& heads = kept->channels[channel];
      if (next == heads.size()) return std::nullopt;
      return events->data(heads[next++].offset);
    };
  };
  return run;
}

}  // namespace

RunStreams run_streams(const std::filesystem::path& path) {
  FileOrder file = file_order(path);
  RunStreams streams;
  if (file.is_in_order) {
    streams.runs.push_back(stream_in_order(path, file));
    streams.remarks = std::move(file.remarks);
    streams.lost_bytes = file.lost_bytes;
    streams.lost_messages = file.lost_messages;
    return streams;
  }
  RunOrder order = order_runs(path);
  streams.remarks = std::move(order.remarks);
  streams.lost_bytes = order.lost_bytes;
  streams.lost_messages = order.lost_messages;
  for (OrderedRun& ordered : order.runs) streams.runs.push_back(stream_of_heads(path, std::move(ordered)));
  return streams;
}

}  // namespace slewlab::msgs
