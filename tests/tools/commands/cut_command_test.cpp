#include "tools/commands/cut_command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "common/input_error.h"
#include "msgs/codec.h"
#include "msgs/log_writer.h"
#include "msgs/run_log.h"
#include "tests/msgs/example_messages.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSecond = 1000000000;  // [ns]

class CutCommand : public testing::Test {
 protected:
  template <class Message>
  void add(msgs::LogWriter& writer, const char* channel, Message message, std::int64_t sequence, std::int64_t time, std::int64_t run) {
    message.sequence = sequence;
    message.simulated_time = time;
    message.configuration_hash = 1;
    message.run_identity = run;
    std::vector<std::uint8_t> bytes;
    msgs::encode(message, bytes);
    writer.append(channel, 7000000 + time / 1000, bytes);  // stamped by another clock than the run's
  }

  // ENCODER every 10 ms; OPERATOR at 1 s and at 4 s; PLANT_STATUS every second.
  void write(const fs::path& path, int runs) {
    msgs::LogWriter writer(path);
    for (std::int64_t run = 5; run < 5 + runs; ++run) {
      for (std::int64_t n = 0; n <= 600; ++n) {
        if (n == 100 || n == 400) {
          auto move = msgs::example::operator_move();
          move.speed_request = static_cast<double>(n);
          add(writer, "OPERATOR", move, n, n * kSecond / 100, run);
        }
        add(writer, "ENCODER", msgs::example::encoder(), n, n * kSecond / 100, run);
        if (n % 100 == 0) add(writer, "PLANT_STATUS", msgs::example::plant_status(), n, n * kSecond / 100, run);
      }
    }
    writer.finish();
  }

  void expect_refused(const CutOptions& options, const std::string& said) {
    std::ostringstream out;
    try {
      cut(options, out);
      ADD_FAILURE() << "not refused: " << said;
    } catch (const common::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(piece_)) << said;
  }

  const TemporaryFolder folder_;
  const fs::path log_ = folder_.path() / "run.lcmlog", piece_ = folder_.path() / "piece.lcmlog";
};

// 2.5 s to 5 s hold 251 ENCODER, the move of 4 s and the states of 3, 4 and 5 s; what the operator wanted at 2.5 s was said at 1 s, the drive's state at 2 s.
TEST_F(CutCommand, KeepsTheMessagesOfTheStretchAndWhatHeldWhenItBegan) {
  write(log_, 1);
  std::ostringstream out;
  EXPECT_EQ(cut({.log = log_, .out = piece_, .from = 2.5, .until = 5.0}, out), 0);
  EXPECT_NE(out.str().find("2.500 s to 5.000 s of " + log_.string() + ": 251 ENCODER, 2 OPERATOR, 4 PLANT_STATUS"), std::string::npos) << out.str();
  const msgs::RunLogs logs = msgs::read_run_logs(piece_);
  ASSERT_EQ(logs.runs.size(), 1u);
  const msgs::RunLog& run = logs.runs[0];
  EXPECT_EQ(run.run_identity, 5);
  ASSERT_EQ(run.encoder.size(), 251u);
  EXPECT_EQ(run.encoder.front().simulated_time, 5 * kSecond / 2);
  EXPECT_EQ(run.encoder.back().simulated_time, 5 * kSecond);
  ASSERT_EQ(run.operator_moves.size(), 2u);
  EXPECT_EQ(run.operator_moves[0].speed_request, 100.0);
  EXPECT_EQ(run.operator_moves[1].speed_request, 400.0);
  ASSERT_EQ(run.plant_status.size(), 4u);
  EXPECT_EQ(run.plant_status[0].simulated_time, 2 * kSecond);
}

// The whole of a log that is in order is that log, time stamps and numbers of the events included.
TEST_F(CutCommand, KeepsTheBytes) {
  write(log_, 1);
  std::ostringstream out;
  cut({.log = log_, .out = piece_}, out);
  EXPECT_EQ(contents(piece_), contents(log_));
}

TEST_F(CutCommand, OfSeveralRunsTheOneThatIsNamed) {
  write(log_, 2);
  expect_refused({.log = log_, .out = piece_}, "--run: found none, and");
  expect_refused({.log = log_, .out = piece_, .run = 3}, "one of the runs 1 (0.000 s to 6.000 s), 2 (0.000 s to 6.000 s)");
  std::ostringstream out;
  cut({.log = log_, .out = piece_, .until = 1.0, .run = 2}, out);
  const msgs::RunLogs logs = msgs::read_run_logs(piece_);
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_EQ(logs.runs[0].run_identity, 6);
  EXPECT_EQ(logs.runs[0].encoder.size(), 101u);
}

TEST_F(CutCommand, RefusesTimesAndNamesThatAreNoGood) {
  write(log_, 1);
  expect_refused({.log = log_, .out = piece_, .from = 7.0}, "[s] within the run, which goes from 0.000 s to 6.000 s");
  expect_refused({.log = log_, .out = piece_, .until = -1.0}, "--until: found -1");
  expect_refused({.log = log_, .out = piece_, .from = std::nan("")}, "--from: found nan");
  expect_refused({.log = log_, .out = piece_, .from = 1e300}, "--from: found 1e+300");
  expect_refused({.log = log_, .out = piece_, .from = 3.0, .until = 2.0}, "3, not before --until 2");
  const std::string before = contents(log_);
  std::ostringstream out;
  EXPECT_THROW(cut({.log = log_, .out = log_}, out), common::InputError);
  EXPECT_THROW(cut({.log = log_, .out = folder_.path()}, out), common::InputError);
  EXPECT_EQ(contents(log_), before);
}

}  // namespace
}  // namespace slewlab::tools
