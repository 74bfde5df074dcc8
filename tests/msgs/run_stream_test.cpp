#include "msgs/run_stream.h"

#include <gtest/gtest.h>

#include "msgs/run_log.h"
#include "tests/msgs/example_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

template <class Message>
void expect_same(const std::vector<Message>& messages, const RunStream& run, const std::string& where) {
  const ChannelExtent& extent = extent_of<Message>(run);
  ASSERT_EQ(extent.messages, static_cast<std::int64_t>(messages.size())) << where;
  if (!messages.empty()) {
    EXPECT_EQ(extent.first_time, messages.front().simulated_time) << where;
    EXPECT_EQ(extent.last_time, messages.back().simulated_time) << where;
  }
  MessageReader<Message> reader(run);
  std::vector<std::uint8_t> wanted, found;
  for (const Message& message : messages) {
    ASSERT_NE(reader.current(), nullptr) << where;
    encode(message, wanted);
    encode(*reader.current(), found);
    ASSERT_EQ(found, wanted) << where;
    reader.advance();
  }
  EXPECT_EQ(reader.current(), nullptr) << where;
}

void expect_as_in_memory(const std::filesystem::path& path, const std::string& where) {
  const RunLogs logs = read_run_logs(path);
  const RunStreams streams = run_streams(path);
  EXPECT_EQ(streams.remarks, logs.remarks) << where;
  ASSERT_EQ(streams.runs.size(), logs.runs.size()) << where;
  for (std::size_t r = 0; r < logs.runs.size(); ++r) {
    const RunLog& log = logs.runs[r];
    const RunStream& run = streams.runs[r];
    EXPECT_EQ(run.configuration_hash, log.configuration_hash) << where;
    EXPECT_EQ(run.run_identity, log.run_identity) << where;
    expect_same(log.encoder, run, where);
    expect_same(log.torque, run, where);
    expect_same(log.operator_moves, run, where);
    expect_same(log.sensors, run, where);
    expect_same(log.truth, run, where);
    expect_same(log.controller_state, run, where);
    expect_same(log.plant_status, run, where);
  }
}

// The reader of whole messages says what the runs are (its own test: run_log_test.cpp).
TEST(RunStream, GivesTheMessagesOfTheOtherReaderWhateverHappenedToTheLog) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  const std::vector<example::Event> whole = example::run(120);
  example::write(path, whole);
  EXPECT_TRUE(file_order(path).is_in_order);
  expect_as_in_memory(path, "as written");
  for (unsigned seed = 0; seed < 300; ++seed) {
    example::write(path, example::damaged(whole, seed));
    expect_as_in_memory(path, "seed " + std::to_string(seed));
  }
}

TEST(RunStream, RunsOfOneFileComeOutApart) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "run.lcmlog";
  std::vector<example::Event> events = example::run(200);
  const std::vector<example::Event> again = example::run(150);
  events.insert(events.end(), again.begin(), again.end());
  example::write(path, events);
  EXPECT_EQ(run_streams(path).runs.size(), 2u);
  expect_as_in_memory(path, "two runs");
}

}  // namespace
}  // namespace slewlab::msgs
