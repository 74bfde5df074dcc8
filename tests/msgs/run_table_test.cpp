#include "msgs/run_table.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>
#include <slewlab_msgs/fields.hpp>

#include "msgs/run_log.h"
#include "tests/msgs/example_messages.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

struct Event {
  std::string channel;
  std::int64_t time = 0;  // [ns]
  std::vector<std::uint8_t> bytes;
};

template <class Message>
Event event(const char* channel, Message message, std::int64_t sequence, std::int64_t time) {
  message.sequence = sequence;
  message.simulated_time = time;
  message.configuration_hash = 1;
  message.run_identity = 5;
  if constexpr (requires { message.answered_sequence; }) message.answered_sequence = sequence;
  Event made{channel, time, {}};
  encode(message, made.bytes);
  return made;
}

// As a lockstep run logs it, cycles of `period` [ns].
std::vector<Event> run(std::int64_t cycles, std::int64_t period = 10'000'000) {
  std::vector<Event> events;
  for (std::int64_t k = 0; k < cycles; ++k) {
    const std::int64_t time = k * period;
    if (k % 17 == 0) events.push_back(event("OPERATOR", example::operator_move(), k / 17, time));
    events.push_back(event("ENCODER", example::encoder(), k, time));
    events.push_back(event("CONTROLLER_STATE", example::controller_state(), k, time));
    events.push_back(event("TORQUE", example::torque(), k, time));
    if (k % 50 == 0) events.push_back(event("PLANT_STATUS", example::plant_status(), k / 50, time));
    for (int i = 0; i < 2; ++i) events.push_back(event("SENSORS", example::sensors(), 2 * k + i, time + i * period / 2));
    events.push_back(event("TRUTH", example::truth(), k, time + period / 2));
  }
  return events;
}

void write(const std::filesystem::path& path, const std::vector<Event>& events) {
  LogWriter writer(path);
  for (const Event& each : events) writer.append(each.channel, each.time / 1000, each.bytes);
  writer.finish();
}

// Every field of every row by channel and field, one number after the other.
using Columns = std::map<std::string, std::map<std::string, std::vector<double>>>;

Columns columns_of(const RunTables& run) {
  Columns columns;
  const auto take = [&](std::size_t t, std::size_t rows, Bytes bytes) {
    const ChannelTable& table = run.tables()[t];
    for (std::size_t i = 0; i < rows; ++i) {
      for (const TableField& field : table.fields) {
        for (int k = 0; k < (field.count < 0 ? 1 : field.count); ++k) {
          const std::uint8_t* at = bytes.data() + i * table.row_bytes + field.offset + field.bytes * static_cast<std::size_t>(k);
          const auto as = [&]<class Value>(Value value) {
            std::memcpy(&value, at, sizeof value);
            return static_cast<double>(value);
          };
          const double value = field.kind == 'f' ? as(0.0) : field.bytes == 8 ? as(std::int64_t{}) : field.bytes == 4 ? as(std::int32_t{}) : as(std::int8_t{});
          columns[std::string(wire_messages()[table.channel].channel)][std::string(field.name)].push_back(value);
        }
      }
    }
  };
  run.read(std::vector<bool>(run.tables().size(), true), {take, [] {}});
  return columns;
}

template <class Message>
void add_columns(const char* channel, const std::vector<Message>& messages, Columns& columns) {
  for (const Message& message : messages) {
    visit_fields(message, [&](const char* field, const char*, const auto& value) {
      auto& column = columns[channel][field];
      if constexpr (requires { value.begin(); }) {
        for (const auto& each : value) column.push_back(static_cast<double>(each));
      } else {
        column.push_back(static_cast<double>(value));
      }
    });
  }
}

// The same of the longest run that the reader of whole messages finds.
Columns columns_of(const std::filesystem::path& path) {
  const RunLogs logs = read_run_logs(path);
  const RunLog* longest = nullptr;
  std::size_t most = 0;
  for (const RunLog& each : logs.runs) {
    const std::size_t size = each.encoder.size() + each.torque.size() + each.operator_moves.size() + each.sensors.size() +
                             each.truth.size() + each.controller_state.size() + each.plant_status.size();
    if (size > most) longest = &each;
    most = std::max(most, size);
  }
  Columns columns;
  add_columns(kEncoderChannel, longest->encoder, columns);
  add_columns(kTorqueChannel, longest->torque, columns);
  add_columns(kOperatorChannel, longest->operator_moves, columns);
  add_columns(kSensorsChannel, longest->sensors, columns);
  add_columns(kTruthChannel, longest->truth, columns);
  add_columns(kControllerStateChannel, longest->controller_state, columns);
  add_columns(kPlantStatusChannel, longest->plant_status, columns);
  return columns;
}

TEST(RunTable, HoldsEveryFieldOfEveryMessage) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  for (const std::int64_t period : {10'000'000, 3'333'333}) {
    write(path, run(300, period));
    const RunTables tables(path);
    EXPECT_EQ(tables.remarks(), std::vector<std::string>());
    EXPECT_EQ(tables.tables().size(), kChannels - 1);  // no MOTION: the crane only slews
    EXPECT_EQ(columns_of(tables), columns_of(path));
  }
}

// What one reading finds in order must be what the rules for whole logs leave; whatever is out of order goes by these rules.
TEST(RunTable, IsTheRunOfTheOtherReaderWhateverHappenedToTheLog) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  const std::vector<Event> whole = run(120);
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 draw(seed);
    const auto any = [&](std::size_t below) { return std::uniform_int_distribution<std::size_t>(0, below - 1)(draw); };
    std::vector<Event> events = whole;
    for (std::size_t changes = any(4); changes > 0; --changes) {
      const std::size_t at = any(events.size() - 40);
      switch (any(6)) {
        case 0: events.insert(events.begin() + static_cast<std::ptrdiff_t>(any(events.size())), Event(events[at])); break;
        case 1: events.erase(events.begin() + static_cast<std::ptrdiff_t>(at), events.begin() + static_cast<std::ptrdiff_t>(at + 1 + any(30))); break;
        case 2: std::swap(events[at], events[any(events.size())]); break;
        case 3: events[at].bytes[8 + any(32)] ^= static_cast<std::uint8_t>(1u << any(8)); break;  // of the head
        case 4: std::swap(events[at], events[at + 1 + any(3)]); break;
        default: events[at].bytes.resize(any(events[at].bytes.size()));
      }
    }
    write(path, events);
    EXPECT_EQ(columns_of(RunTables(path)), columns_of(path)) << "seed " << seed;
  }
}

TEST(RunTable, OnlyWhatIsAskedForIsGivenOut) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  write(path, run(20));
  const RunTables tables(path);
  std::vector<bool> asked(tables.tables().size(), false);
  asked[3] = true;
  std::size_t rows = 0;
  tables.read(asked, {[&](std::size_t table, std::size_t count, Bytes) {
                        EXPECT_EQ(table, 3u);
                        rows += count;
                      },
                      [] {}});
  EXPECT_EQ(rows, 40u);
}

// What comes late in the file is at most so late.
TEST(RunTable, SaysHowLateAMessageMayBe) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  std::vector<Event> events = run(100);
  write(path, events);
  EXPECT_EQ(RunTables(path).lateness(), 0);
  std::rotate(events.begin(), events.begin() + 1, events.begin() + 20);  // the first OPERATOR behind three cycles
  write(path, events);
  EXPECT_EQ(RunTables(path).lateness(), 25'000'000);
}

}  // namespace
}  // namespace slewlab::msgs
