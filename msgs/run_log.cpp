#include "msgs/run_log.h"

#include <algorithm>
#include <map>

namespace slewlab::msgs {
namespace {

// A message that speaks of a time this far before its channel's newest is no late arrival but of another run.
constexpr std::uint64_t kRestartDistance = 1'000'000'000;  // [ns]

// For any numbers that a damaged message may hold.
std::uint64_t distance(std::int64_t from, std::int64_t to) {
  return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
}

struct Unusable {
  std::int64_t count = 0;
  DecodeStatus status = DecodeStatus::ok;
};

struct Sorting {
  RunLogs& logs;
  std::map<std::int64_t, std::size_t> run_of_configuration;  // the newest run of each configuration
  std::map<std::string, Unusable> unusable;                  // by channel
  std::map<std::string, std::int64_t> foreign;               // channels that are not slewlab's
};

template <class Message>
void take(Sorting& sorting, const LogEvent& event, std::vector<Message> RunLog::*channel) {
  Message message;
  const DecodeStatus status = decode(event.data, message);
  if (status != DecodeStatus::ok) {
    Unusable& unusable = sorting.unusable[std::string(event.channel)];
    ++unusable.count;
    unusable.status = status;
    return;
  }
  auto& runs = sorting.logs.runs;
  const auto known = sorting.run_of_configuration.find(message.configuration_hash);
  const bool begins_again =
      known != sorting.run_of_configuration.end() && !(runs[known->second].*channel).empty() &&
      message.simulated_time < (runs[known->second].*channel).back().simulated_time &&
      distance(message.simulated_time, (runs[known->second].*channel).back().simulated_time) > kRestartDistance;
  if (known == sorting.run_of_configuration.end() || begins_again) {
    sorting.run_of_configuration[message.configuration_hash] = runs.size();
    runs.emplace_back();
    runs.back().configuration_hash = message.configuration_hash;
  }
  (runs[sorting.run_of_configuration[message.configuration_hash]].*channel).push_back(std::move(message));
}

// An answer counts by the ENCODER it answers: a controller that was started anew counts its own messages from 0 again.
template <class Message>
std::int64_t key_of(const Message& message) {
  if constexpr (requires { message.answered_sequence; }) return message.answered_sequence;
  else return message.sequence;
}

template <class Message>
void put_in_order(std::vector<Message>& messages, const char* channel, std::vector<std::string>& remarks) {
  const auto earlier = [](const Message& a, const Message& b) { return key_of(a) < key_of(b); };
  const auto same = [](const Message& a, const Message& b) { return key_of(a) == key_of(b); };
  if (!std::is_sorted(messages.begin(), messages.end(), earlier)) {
    remarks.push_back(std::string(channel) + ": out of order in the file, sorted by sequence number");
    std::stable_sort(messages.begin(), messages.end(), earlier);
  }
  const auto end = std::unique(messages.begin(), messages.end(), same);
  if (end != messages.end()) {
    remarks.push_back(std::string(channel) + ": " + std::to_string(messages.end() - end) +
                      " repeated messages left out");
    messages.erase(end, messages.end());
  }
  if (messages.empty()) return;
  const std::uint64_t span = distance(key_of(messages.front()), key_of(messages.back())) + 1;
  const std::uint64_t missing = span - messages.size();
  if (missing > 0) {
    remarks.push_back(std::string(channel) + ": " + std::to_string(missing) + " of " + std::to_string(span) +
                      " messages are missing");
  }
}

}  // namespace

RunLogs read_run_logs(const std::filesystem::path& path) {
  RunLogs logs;
  Sorting sorting{logs, {}, {}, {}};
  LogReader reader(path);
  LogEvent event;
  while (reader.next(event)) {
    if (event.channel == kEncoderChannel) {
      take(sorting, event, &RunLog::encoder);
    } else if (event.channel == kTorqueChannel) {
      take(sorting, event, &RunLog::torque);
    } else if (event.channel == kOperatorChannel) {
      take(sorting, event, &RunLog::operator_moves);
    } else if (event.channel == kSensorsChannel) {
      take(sorting, event, &RunLog::sensors);
    } else if (event.channel == kTruthChannel) {
      take(sorting, event, &RunLog::truth);
    } else if (event.channel == kControllerStateChannel) {
      take(sorting, event, &RunLog::controller_state);
    } else if (event.channel == kPlantStatusChannel) {
      take(sorting, event, &RunLog::plant_status);
    } else {
      ++sorting.foreign[std::string(event.channel)];
    }
  }

  logs.remarks = describe(reader.damage());
  for (const auto& [channel, unusable] : sorting.unusable) {
    logs.remarks.push_back(channel + ": " + std::to_string(unusable.count) + " messages could not be decoded (last: " +
                           to_string(unusable.status) + ")");
  }
  for (const auto& [channel, count] : sorting.foreign) {
    logs.remarks.push_back("channel " + channel + " is not slewlab's: " + std::to_string(count) + " events left out");
  }
  if (logs.runs.empty()) {
    std::string text = "the log " + path.string() + " holds no message that slewlab can read";
    for (const std::string& remark : logs.remarks) text += "; " + remark;
    throw LogError(text);
  }
  for (RunLog& run : logs.runs) {
    put_in_order(run.encoder, kEncoderChannel, logs.remarks);
    put_in_order(run.torque, kTorqueChannel, logs.remarks);
    put_in_order(run.operator_moves, kOperatorChannel, logs.remarks);
    put_in_order(run.sensors, kSensorsChannel, logs.remarks);
    put_in_order(run.truth, kTruthChannel, logs.remarks);
    put_in_order(run.controller_state, kControllerStateChannel, logs.remarks);
    put_in_order(run.plant_status, kPlantStatusChannel, logs.remarks);
  }
  return logs;
}

}  // namespace slewlab::msgs
