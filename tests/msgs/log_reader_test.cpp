#include "msgs/log_reader.h"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>

#include <fstream>
#include <iterator>
#include <random>

#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

namespace fs = std::filesystem;

class LogReaderTest : public testing::Test {
 protected:
  // Ten events; number n carries n bytes of value n.
  std::vector<char> log_bytes() {
    {
      LogWriter writer(path_);
      for (int n = 0; n < 10; ++n) {
        writer.append("CHANNEL", 1000 * n, std::vector<std::uint8_t>(n, static_cast<std::uint8_t>(n)));
      }
      writer.finish();
    }
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::size_t event_begin(int n) { return n * (kLogEventHeadBytes + 7) + n * (n - 1) / 2; }

  void store(const std::vector<char>& bytes) {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  std::vector<std::int64_t> numbers() {
    LogReader reader(path_);
    std::vector<std::int64_t> found;
    LogEvent event;
    while (reader.next(event)) {
      found.push_back(event.number);
      EXPECT_EQ(event.data.size(), static_cast<std::size_t>(event.number));
      EXPECT_EQ(event.timestamp_us, 1000 * event.number);
    }
    damage_ = reader.damage();
    return found;
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "run.lcmlog";
  LogDamage damage_;
};

TEST_F(LogReaderTest, ReadsWhatLcmItselfWrites) {
  lcm_eventlog_t* log = lcm_eventlog_create(path_.c_str(), "w");
  ASSERT_NE(log, nullptr);
  char channel[] = "POSE";
  char data[] = "abc";
  lcm_eventlog_event_t written{};
  written.timestamp = 77;
  written.channellen = 4;
  written.channel = channel;
  written.datalen = 3;
  written.data = data;
  lcm_eventlog_write_event(log, &written);
  lcm_eventlog_destroy(log);

  LogReader reader(path_);
  LogEvent event;
  ASSERT_TRUE(reader.next(event));
  EXPECT_EQ(event.timestamp_us, 77);
  EXPECT_EQ(event.channel, "POSE");
  EXPECT_EQ(std::string(event.data.begin(), event.data.end()), "abc");
  EXPECT_FALSE(reader.next(event));
  EXPECT_TRUE(describe(reader.damage()).empty());
}

TEST_F(LogReaderTest, WhereverTheEndIsCutTheWholeEventsBeforeItAreRead) {
  const std::vector<char> whole = log_bytes();
  ASSERT_EQ(whole.size(), event_begin(10));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    store({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    int events = 0;
    while (event_begin(events + 1) <= size) ++events;
    ASSERT_EQ(numbers().size(), static_cast<std::size_t>(events)) << size;
    EXPECT_EQ(damage_.cut_off_bytes, static_cast<std::int64_t>(size - event_begin(events))) << size;
    EXPECT_EQ(damage_.skipped_bytes, 0) << size;
  }
}

TEST_F(LogReaderTest, ReadsOnBehindADamagedSyncWord) {
  std::vector<char> bytes = log_bytes();
  bytes[event_begin(4)] = 0;
  store(bytes);
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{0, 1, 2, 3, 5, 6, 7, 8, 9}));
  EXPECT_EQ(damage_.skipped_stretches, 1);
  EXPECT_EQ(damage_.skipped_bytes, static_cast<std::int64_t>(event_begin(5) - event_begin(4)));
}

TEST_F(LogReaderTest, ReadsOnBehindALengthThatWouldReachBeyondTheEnd) {
  std::vector<char> bytes = log_bytes();
  bytes[event_begin(4) + 25] = 0x10;  // a million bytes more
  store(bytes);
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{0, 1, 2, 3, 5, 6, 7, 8, 9}));
  EXPECT_EQ(damage_.skipped_bytes, static_cast<std::int64_t>(event_begin(5) - event_begin(4)));
  EXPECT_EQ(damage_.cut_off_bytes, 0);
}

// A length that is damaged to reach over whole events must not swallow them, whether a sync word stands at its end or not.
TEST_F(LogReaderTest, ALengthThatReachesOverOtherEventsSwallowsNone) {
  for (const int longer : {1, 40, 77, 100}) {
    std::vector<char> bytes = log_bytes();
    bytes[event_begin(2) + 27] = static_cast<char>(bytes[event_begin(2) + 27] + longer);
    store(bytes);
    EXPECT_EQ(numbers(), (std::vector<std::int64_t>{0, 1, 3, 4, 5, 6, 7, 8, 9})) << longer;
    EXPECT_EQ(damage_.skipped_bytes, static_cast<std::int64_t>(event_begin(3) - event_begin(2)));
  }
}

TEST_F(LogReaderTest, SaysWhereTheDamageIs) {
  std::vector<char> bytes = log_bytes();
  bytes[event_begin(4)] = 0;
  bytes.resize(event_begin(9) + 5);
  store(bytes);
  numbers();
  const std::string told = describe(damage_).at(0) + describe(damage_).at(1);
  EXPECT_NE(told.find("39 at byte " + std::to_string(event_begin(4)) + " behind 0.003 s"), std::string::npos) << told;
  EXPECT_NE(told.find("5 at byte " + std::to_string(event_begin(9)) + " behind 0.008 s"), std::string::npos) << told;
}

// A file of nothing but heads that claim large events: each is looked at once, and none is read into memory.
TEST_F(LogReaderTest, LargeLengthsEverywhereTakeNoMoreTimeThanTheFilesSize) {
  std::vector<char> bytes;
  constexpr std::size_t kHeads = 200'000;
  for (std::size_t i = 0; i < kHeads; ++i) {
    std::vector<char> head(kLogEventHeadBytes + 1, 0);
    for (int b = 0; b < 4; ++b) head[b] = static_cast<char>(kLogSyncWord >> (24 - 8 * b));
    head[23] = 1;                                   // channel length
    head[25] = static_cast<char>(0x20 + i % 0x20);  // 2 to 4 MiB of data
    bytes.insert(bytes.end(), head.begin(), head.end());
  }
  store(bytes);
  LogReader reader(path_);
  LogEvent event;
  std::size_t used = 0;
  while (reader.next(event)) used += kLogEventHeadBytes + event.channel.size() + event.data.size();
  EXPECT_EQ(used + static_cast<std::size_t>(reader.damage().skipped_bytes + reader.damage().cut_off_bytes), bytes.size());
  EXPECT_LE(reader.damage().places.size(), LogDamage::kPlaces);
}

TEST_F(LogReaderTest, RandomDamageNeverStopsTheReadingAndEveryByteIsAccountedFor) {
  const std::vector<char> whole = log_bytes();
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    std::vector<char> bytes = whole;
    for (int changes = 0; changes < 4; ++changes) bytes[random() % bytes.size()] = static_cast<char>(random());
    store(bytes);
    LogReader reader(path_);
    LogEvent event;
    std::size_t used = 0;
    while (reader.next(event)) used += kLogEventHeadBytes + event.channel.size() + event.data.size();
    EXPECT_EQ(used + static_cast<std::size_t>(reader.damage().skipped_bytes + reader.damage().cut_off_bytes),
              bytes.size());
  }
}

TEST_F(LogReaderTest, StampsThatRunBackwardAreCounted) {
  LogWriter writer(path_);
  for (const std::int64_t stamp : {10, 30, 20, 40}) writer.append("A", stamp, {});
  writer.finish();
  LogReader reader(path_);
  LogEvent event;
  while (reader.next(event)) {
  }
  EXPECT_EQ(reader.damage().backward_stamps, 1);
}

TEST_F(LogReaderTest, AFileThatIsNotThereIsNamed) {
  EXPECT_THROW(LogReader("/nonexistent.lcmlog"), LogError);
  EXPECT_THROW(LogReader(folder_.path()), LogError);
}

}  // namespace
}  // namespace slewlab::msgs
