#include "msgs/run_log.h"

#include <gtest/gtest.h>

#include <memory>

#include "msgs/codec.h"
#include "tests/msgs/example_messages.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

class RunLogTest : public testing::Test {
 protected:
  template <class Message>
  void add(const char* channel, Message message, std::int64_t sequence, std::int64_t time_ns,
           std::int64_t configuration = 1, std::int64_t run = 5) {
    message.sequence = sequence;
    message.simulated_time = time_ns;
    message.configuration_hash = configuration;
    message.run_identity = run;
    std::vector<std::uint8_t> bytes;
    encode(message, bytes);
    writer_->append(channel, time_ns / 1000, bytes);
  }
  RunLogs read() {
    writer_->finish();
    return read_run_logs(path_);
  }
  static bool mentions(const RunLogs& logs, const std::string& text) {
    for (const std::string& remark : logs.remarks) {
      if (remark.find(text) != std::string::npos) return true;
    }
    return false;
  }

  template <class Change>
  void add_run(std::int64_t run, Change change);

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.lcmlog";
  std::unique_ptr<LogWriter> writer_ = std::make_unique<LogWriter>(path_);
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
  EXPECT_EQ(logs.remarks.size(), 2u);
  EXPECT_TRUE(mentions(logs, "2 events carry an earlier time stamp"));
  EXPECT_TRUE(mentions(logs, "run 2 of the file has configuration 0000000000000002, run 1 has 0000000000000001: another machine, controller or scenario"));
}

// A run of a hundred cycles of 10 ms as a lockstep run logs it, with what `change` makes of each TORQUE.
template <class Change>
void RunLogTest::add_run(std::int64_t run, Change change) {
  add("SENSORS", example::sensors(), 0, 0, 1, run);
  for (std::int64_t k = 0; k < 100; ++k) {
    const std::int64_t time = k * 10'000'000;
    if (k == 0) add("OPERATOR", example::operator_move(), 0, time, 1, run);
    add("ENCODER", example::encoder(), k, time, 1, run);
    Torque torque = example::torque();
    torque.answered_sequence = torque.sequence = k;
    torque.simulated_time = time;
    torque.configuration_hash = 1;
    torque.run_identity = run;
    change(k, torque);
    std::vector<std::uint8_t> bytes;
    encode(torque, bytes);
    writer_->append("TORQUE", time / 1000, bytes);
    add("SENSORS", example::sensors(), k + 1, time + 10'000'000, 1, run);
  }
}

// One bit of one TORQUE, wherever it is in the head: one run, without that message if its place in the run is wrong.
TEST_F(RunLogTest, NoBitOfATorquesHeadSplitsARun) {
  for (int bit = 0; bit < 64; ++bit) {
    for (const char* field : {"time", "configuration", "run", "answered"}) {
      TemporaryFolder folder;
      path_ = folder.path() / "run.lcmlog";
      writer_ = std::make_unique<LogWriter>(path_);
      add_run(5, [&](std::int64_t k, Torque& torque) {
        if (k != 60) return;
        const auto flip = static_cast<std::int64_t>(std::uint64_t{1} << bit);
        if (field == std::string("time")) torque.simulated_time ^= flip;
        if (field == std::string("configuration")) torque.configuration_hash ^= flip;
        if (field == std::string("run")) torque.run_identity ^= flip;
        if (field == std::string("answered")) torque.answered_sequence ^= flip;
      });
      const RunLogs logs = read();
      ASSERT_EQ(logs.runs.size(), 1u) << field << " bit " << bit;
      EXPECT_EQ(logs.runs[0].encoder.size(), 100u);
      EXPECT_EQ(logs.runs[0].torque.size(), 99u) << field << " bit " << bit;
      EXPECT_EQ(logs.runs[0].sensors.size(), 101u);
      EXPECT_TRUE(mentions(logs, "TORQUE: 1 messages")) << field << " bit " << bit;
      EXPECT_EQ(logs.lost_messages, 0);
    }
  }
}

// Two minutes of a run in strides of 997 places around its 12 000, which meet each place once.
TEST_F(RunLogTest, AShuffledLogIsRefusedInOneSentence) {
  constexpr std::int64_t kMessages = 12'000;
  for (std::int64_t i = 0; i < kMessages; ++i) {
    const std::int64_t k = i * 997 % kMessages;
    add("ENCODER", example::encoder(), k, k * 10'000'000);
  }
  try {
    const RunLogs logs = read();
    FAIL() << logs.runs.size() << " runs";
  } catch (const LogError& error) {
    EXPECT_NE(std::string(error.what()).find("holds its messages in no order: simulated time falls back"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos) << error.what();
  }
}

// A day of runs of one configuration, in one file.
TEST_F(RunLogTest, ManyRunsBehindEachOtherAreNoShuffledLog) {
  for (int run = 0; run < 60; ++run) {
    for (std::int64_t k = 0; k < 300; ++k) add("ENCODER", example::encoder(), k, k * 10'000'000);
  }
  EXPECT_EQ(read().runs.size(), 60u);
}

TEST_F(RunLogTest, APlantsMessageWithAWrongTimeIsAStrayAndNotARun) {
  for (int k = 0; k < 50; ++k) {
    const std::int64_t time = k * 10'000'000;
    add("ENCODER", example::encoder(), k, k == 20 ? (std::int64_t{1} << 60) : k == 40 ? -time : time);
  }
  const RunLogs logs = read();
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_EQ(logs.runs[0].encoder.size(), 48u);
  EXPECT_TRUE(mentions(logs, "ENCODER: 2 messages whose time or sequence number is at odds with the others left out"));
  EXPECT_EQ(logs.lost_messages, 2);
}

// Two runs of one configuration, one behind the other, as two lockstep logs in one file are.
TEST_F(RunLogTest, NothingOfARunLandsInTheOneBefore) {
  for (const bool same_identity : {true, false}) {
    TemporaryFolder folder;
    path_ = folder.path() / "run.lcmlog";
    writer_ = std::make_unique<LogWriter>(path_);
    const auto as_it_is = [](std::int64_t, Torque&) {};
    for (int i = 0; i < 3; ++i) {  // the end of a run
      add("ENCODER", example::encoder(), 1000 + i, 10'000'000'000 + i * 10'000'000, 1, 5);
      add("SENSORS", example::sensors(), 1001 + i, 10'010'000'000 + i * 10'000'000, 1, 5);
    }
    add_run(same_identity ? 5 : 6, as_it_is);
    const RunLogs logs = read();
    ASSERT_EQ(logs.runs.size(), 2u) << same_identity;
    EXPECT_EQ(logs.runs[0].sensors.size(), 3u);
    EXPECT_TRUE(logs.runs[0].operator_moves.empty());
    EXPECT_TRUE(logs.runs[0].torque.empty());
    EXPECT_EQ(logs.runs[1].operator_moves.size(), 1u);
    EXPECT_EQ(logs.runs[1].encoder.size(), 100u);
    EXPECT_EQ(logs.runs[1].torque.size(), 100u);
    EXPECT_EQ(logs.runs[1].run_identity, same_identity ? 5 : 6);
  }
}

// A controller that was stopped answers late and all at once: TORQUE of seconds ago, and no run of its own.
TEST_F(RunLogTest, LateAnswersAreOfTheRunThatAsked) {
  for (std::int64_t k = 0; k < 1000; ++k) {
    const std::int64_t time = k * 10'000'000;
    add("ENCODER", example::encoder(), k, time);
    if (k != 900) continue;
    for (std::int64_t late = 100; late <= 900; ++late) {
      Torque torque = example::torque();
      torque.answered_sequence = late;
      add("TORQUE", torque, late, late * 10'000'000);
    }
  }
  const RunLogs logs = read();
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_EQ(logs.runs[0].torque.size(), 801u);
  EXPECT_FALSE(mentions(logs, "left out"));
}

TEST_F(RunLogTest, AGapIsNoOtherRun) {
  for (const std::int64_t k : {0, 1, 2, 3, 4, 500, 501, 502}) add("ENCODER", example::encoder(), k, k * 10'000'000);
  const RunLogs logs = read();
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_EQ(logs.runs[0].encoder.size(), 8u);
  EXPECT_TRUE(mentions(logs, "495 of 503 messages are missing"));
}

TEST_F(RunLogTest, ChannelsNamesAreShownAsText) {
  add("SENSORS", example::sensors(), 0, 0);
  writer_->append("\x1b[2J\a\xff", 5, std::vector<std::uint8_t>{1});
  for (int i = 0; i < 100; ++i) writer_->append("C" + std::to_string(i), 5, std::vector<std::uint8_t>{1});
  const RunLogs logs = read();
  std::string all;
  for (const std::string& remark : logs.remarks) all += remark + "\n";
  for (const char c : all) EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f)) << static_cast<int>(c);
  EXPECT_NE(all.find("\\x1b[2J\\x07\\xff"), std::string::npos) << all;
  EXPECT_LE(logs.remarks.size(), 12u);
  EXPECT_TRUE(mentions(logs, "further channels are not slewlab's"));
}

TEST_F(RunLogTest, ForeignChannelsAndUndecodableMessagesAreTold) {
  add("SENSORS", example::sensors(), 0, 0);
  writer_->append("CAMERA", 5, std::vector<std::uint8_t>{1, 2, 3});
  writer_->append("TORQUE", 6, std::vector<std::uint8_t>{1, 2, 3});
  const RunLogs logs = read();
  EXPECT_TRUE(mentions(logs, "channel CAMERA is not slewlab's: 1 events"));
  EXPECT_TRUE(mentions(logs, "TORQUE: 1 messages could not be decoded (last: truncated)"));
}

TEST_F(RunLogTest, ALogWithNothingOfOursIsRefused) {
  writer_->append("CAMERA", 5, std::vector<std::uint8_t>{1, 2, 3});
  EXPECT_THROW(read(), LogError);
}

}  // namespace
}  // namespace slewlab::msgs
