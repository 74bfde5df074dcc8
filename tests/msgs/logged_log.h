#pragma once

// Runs as logs, for tests of what reads parts of them.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "msgs/codec.h"
#include "msgs/log_writer.h"
#include "msgs/logged_run.h"

namespace slewlab::msgs {

// A run written to a log, in the order of its times, and read again by its order. Its messages are numbered anew, from 0 on.
inline LoggedRun logged(const RunLog& run, const std::filesystem::path& path) {
  struct Event {
    std::int64_t time;  // [ns]
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Event> events;
  const auto add = [&](const char* channel, const auto& messages) {
    std::int64_t sequence = 0;
    for (auto message : messages) {
      message.configuration_hash = 1;
      message.run_identity = 5;
      message.sequence = sequence++;
      if constexpr (requires { message.answered_sequence; }) message.answered_sequence = message.sequence;
      events.push_back({message.simulated_time, channel, {}});
      encode(message, events.back().bytes);
    }
  };
  add("ENCODER", run.encoder);
  add("TORQUE", run.torque);
  add("OPERATOR", run.operator_moves);
  add("SENSORS", run.sensors);
  add("TRUTH", run.truth);
  add("CONTROLLER_STATE", run.controller_state);
  add("PLANT_STATUS", run.plant_status);
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
  LogWriter writer(path);
  for (const Event& each : events) writer.append(each.channel, each.time / 1000, each.bytes);
  writer.finish();
  return std::move(logged_runs(path).runs.at(0));
}

}  // namespace slewlab::msgs
