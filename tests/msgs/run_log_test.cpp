#include "msgs/run_log.h"

#include <gtest/gtest.h>

#include "msgs/codec.h"
#include "tests/msgs/example_messages.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

class RunLogTest : public testing::Test {
 protected:
  template <class Message>
  void add(const char* channel, Message message, std::int64_t sequence, std::int64_t time_ns,
           std::int64_t configuration = 1) {
    message.sequence = sequence;
    message.simulated_time = time_ns;
    message.configuration_hash = configuration;
    std::vector<std::uint8_t> bytes;
    encode(message, bytes);
    writer_.append(channel, time_ns / 1000, bytes);
  }
  RunLogs read() {
    writer_.finish();
    return read_run_logs(path_);
  }
  static bool mentions(const RunLogs& logs, const std::string& text) {
    for (const std::string& remark : logs.remarks) {
      if (remark.find(text) != std::string::npos) return true;
    }
    return false;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.lcmlog";
  LogWriter writer_{path_};
};

TEST_F(RunLogTest, SortsDropsRepeatsAndCountsWhatIsMissing) {
  for (const std::int64_t k : {0, 2, 1, 2, 5}) add("ENCODER", example::encoder(), k, k * 1'000'000);
  const RunLogs logs = read();
  ASSERT_EQ(logs.runs.size(), 1u);
  std::vector<std::int64_t> sequences;
  for (const Encoder& message : logs.runs[0].encoder) sequences.push_back(message.sequence);
  EXPECT_EQ(sequences, (std::vector<std::int64_t>{0, 1, 2, 5}));
  EXPECT_TRUE(mentions(logs, "ENCODER: out of order"));
  EXPECT_TRUE(mentions(logs, "ENCODER: 1 repeated"));
  EXPECT_TRUE(mentions(logs, "ENCODER: 2 of 6 messages are missing"));
}

TEST_F(RunLogTest, RunsOfTwoConfigurationsAndARunThatBeginsAgainComeOutApart) {
  for (int k = 0; k < 3; ++k) add("SENSORS", example::sensors(), k, k * 1'000'000'000LL, 1);
  for (int k = 0; k < 2; ++k) add("SENSORS", example::sensors(), k, k * 1'000'000'000LL, 2);
  for (int k = 0; k < 3; ++k) add("SENSORS", example::sensors(), k, k * 1'000'000'000LL, 1);
  const RunLogs logs = read();
  ASSERT_EQ(logs.runs.size(), 3u);
  EXPECT_EQ(logs.runs[0].sensors.size(), 3u);
  EXPECT_EQ(logs.runs[1].sensors.size(), 2u);
  EXPECT_EQ(logs.runs[2].sensors.size(), 3u);
  EXPECT_EQ(logs.runs[1].configuration_hash, 2);
  EXPECT_EQ(logs.remarks.size(), 1u);
  EXPECT_TRUE(mentions(logs, "2 events carry an earlier time stamp"));
}

TEST_F(RunLogTest, ForeignChannelsAndUndecodableMessagesAreTold) {
  add("SENSORS", example::sensors(), 0, 0);
  writer_.append("CAMERA", 5, std::vector<std::uint8_t>{1, 2, 3});
  writer_.append("TORQUE", 6, std::vector<std::uint8_t>{1, 2, 3});
  const RunLogs logs = read();
  EXPECT_TRUE(mentions(logs, "channel CAMERA is not slewlab's: 1 events"));
  EXPECT_TRUE(mentions(logs, "TORQUE: 1 messages could not be decoded (last: truncated)"));
}

TEST_F(RunLogTest, ALogWithNothingOfOursIsRefused) {
  writer_.append("CAMERA", 5, std::vector<std::uint8_t>{1, 2, 3});
  EXPECT_THROW(read(), LogError);
}

}  // namespace
}  // namespace slewlab::msgs
