#pragma once

// Which messages of a log are a run, and in which order: by their heads alone, 24 bytes each, so that the messages
// themselves need not be in memory. The rules:
//
// - A run is what one pair of run_identity and configuration_hash says, if at least two different messages of the plant
//   (ENCODER, SENSORS, TRUTH, PLANT_STATUS) say it, or if it is the largest part of a file without such a pair. Messages
//   of any other pair are strays: a bit that turned over, or another controller on the bus.
// - Of one pair, the simulated time of ENCODER (without any: of the plant's channel with most messages) tells the runs
//   apart, in the order of the file. Where it falls back by more than 1 s or leaps ahead by more (or by four times the
//   usual distance between messages, if that is more still), the next message decides: if it goes on from there, another
//   run has begun, or there is a gap; if not, the message that leapt is a stray. All other messages go with those around
//   them in the file, and between two runs with the one whose time is nearer.
// - A file in which simulated time falls back more than 20 times into the middle of a run is in no order, and is refused.
// - Within a run, sequence number and simulated time of a channel go together: where nine messages in ten lie on
//   time = offset + period * sequence exactly, those that do not are strays. Answers are measured by the line of ENCODER,
//   if more than half of them lie on it. Where there is no such line (OPERATOR never has one) those are strays that spoil
//   the order: what remains is the longest row, by time, in which no sequence number falls. If that took more than one
//   message in a hundred (and more than one), it would be no stray but a clock that was set, and everything stays.
// Strays are counted, told and left out.

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "msgs/log_reader.h"
#include "msgs/wire_layout.h"

namespace slewlab::msgs {

struct EventHead {
  std::int64_t offset = 0;  // [bytes] of the event in the file
  std::int64_t time = 0;    // [ns] simulated
  std::int64_t key = 0;     // WireHead::key
};

struct OrderedRun {
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::array<std::vector<EventHead>, kChannels> channels;  // keys rise
  std::size_t messages = 0;                                // of all channels, repeated ones included
};

struct RunOrder {
  std::vector<OrderedRun> runs;      // in the order in which they begin in the file
  std::vector<std::string> remarks;  // what could not be used, one line each
  std::int64_t lost_bytes = 0;       // as in RunLogs
  std::int64_t lost_messages = 0;
};

// What of a log could not be used, counted while its events go by.
struct LeftOut {
  std::int64_t count = 0;
  std::int64_t offset = 0;  // [bytes] of the first
  void add(std::int64_t at) {
    if (count++ == 0) offset = at;
  }
};
struct Unused {
  std::array<LeftOut, kChannels> undecodable;
  std::array<DecodeStatus, kChannels> last_status{};  // of the undecodable
  std::array<LeftOut, kChannels> other_counts;        // whose arrays have other lengths than those asked for
  std::array<LeftOut, kChannels> other_runs;          // of no run of this file
  std::array<LeftOut, kChannels> strays;              // at odds with their run
  std::map<std::string, std::int64_t, std::less<>> foreign;  // messages of channels that are not slewlab's
  std::int64_t further_foreign = 0;                          // of more channels than are kept by name
  void add_foreign(std::string_view channel);
};

// One line each.
std::vector<std::string> describe(const Unused& unused, const LogDamage& damage);
// What putting a channel in order left out: `repeated` messages, and those missing between first and last key.
void describe_order(std::string_view channel, bool sorted, std::int64_t repeated, std::int64_t count, std::int64_t first_key,
                    std::int64_t last_key, std::vector<std::string>& remarks);

// The lengths of arrays that are asked for, by channel; none: any.
using AskedCounts = std::array<std::optional<ArrayCounts>, kChannels>;

// Throws LogError where the file cannot be read, holds no message of slewlab or is in no order.
RunOrder order_runs(const std::filesystem::path& path, const AskedCounts& asked = {});

[[noreturn]] void throw_no_message(const std::filesystem::path& path, const std::vector<std::string>& remarks);

// Events whose offsets order_runs() or a LogReader gave, read anew; cheap where offsets rise. Valid until the next call; LogError where no event stands there any
// more.
class EventsAt {
 public:
  explicit EventsAt(const std::filesystem::path& path);
  LogEvent event(std::int64_t offset);
  Bytes data(std::int64_t offset) { return event(offset).data; }

 private:
  bool have(std::int64_t offset, std::size_t bytes);
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<std::uint8_t> window_;
  std::int64_t begin_ = 0;   // [bytes] of the window in the file
  std::size_t filled_ = 0;
};

}  // namespace slewlab::msgs
