#include "msgs/logged_run.h"

#include <gtest/gtest.h>

#include "tests/msgs/example_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;  // [ns]

class LoggedRunTest : public testing::Test {
 protected:
  LoggedRun read(const std::vector<example::Event>& events) {
    example::write(path_, events);
    return logged_runs(path_).runs.at(0);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.lcmlog";
};

// OPERATOR comes every 17 cycles, PLANT_STATUS every 50, SENSORS twice in each.
TEST_F(LoggedRunTest, APartHoldsItsMessagesAndWhatStoodBefore) {
  const RunLog part = read_run(read(example::run(400)), 100 * kPeriod, 199 * kPeriod);
  ASSERT_EQ(part.encoder.size(), 100u);
  EXPECT_EQ(part.encoder.front().sequence, 100);
  EXPECT_EQ(part.encoder.back().sequence, 199);
  EXPECT_EQ(part.torque.size(), 100u);
  EXPECT_EQ(part.controller_state.size(), 100u);
  EXPECT_EQ(part.sensors.size(), 199u);
  EXPECT_EQ(part.truth.size(), 99u);  // half a cycle later than the others
  ASSERT_EQ(part.operator_moves.size(), 7u);
  EXPECT_EQ(part.operator_moves.front().simulated_time, 5 * 17 * kPeriod);
  EXPECT_EQ(part.operator_moves.back().simulated_time, 11 * 17 * kPeriod);
  ASSERT_EQ(part.plant_status.size(), 3u);
  EXPECT_EQ(part.plant_status.front().simulated_time, 50 * kPeriod);
  EXPECT_EQ(part.run_identity, 5);
  EXPECT_EQ(part.configuration_hash, 1);
}

TEST_F(LoggedRunTest, OfALogThatIsInNoOrderThePartIsTheSame) {
  std::vector<example::Event> events = example::run(400);
  const RunLog part = read_run(read(events), 100 * kPeriod, 199 * kPeriod);
  for (std::size_t k = 0; k + 40 < events.size(); k += 40) std::rotate(events.begin() + static_cast<std::ptrdiff_t>(k), events.begin() + static_cast<std::ptrdiff_t>(k + 20), events.begin() + static_cast<std::ptrdiff_t>(k + 40));
  const RunLog other = read_run(read(events), 100 * kPeriod, 199 * kPeriod);
  ASSERT_EQ(other.encoder.size(), part.encoder.size());
  for (std::size_t n = 0; n < part.encoder.size(); ++n) EXPECT_EQ(other.encoder[n].sequence, part.encoder[n].sequence);
  EXPECT_EQ(other.operator_moves.size(), part.operator_moves.size());
}

TEST_F(LoggedRunTest, EncodersAreReadAsFarApartAsIsAsked) {
  const std::vector<Encoder> encoders = read_encoders(read(example::run(400)), 25 * kPeriod);
  ASSERT_EQ(encoders.size(), 16u);
  for (std::size_t n = 0; n < encoders.size(); ++n) EXPECT_EQ(encoders[n].sequence, static_cast<std::int64_t>(25 * n));
}

TEST_F(LoggedRunTest, ALogThatChangedMeanwhileIsSaid) {
  const LoggedRun run = read(example::run(100));
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_NO_THROW(read_run(run, 0, 10 * kPeriod));
  EXPECT_THROW(read_run(run), LogError);
}

}  // namespace
}  // namespace slewlab::msgs
