#include "msgs/run_table.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <slewlab_msgs/fields.hpp>

#include "msgs/run_log.h"
#include "tests/msgs/example_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

using example::damaged;
using example::Event;
using example::run;
using example::write;

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
    write(path, damaged(whole, seed));
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
