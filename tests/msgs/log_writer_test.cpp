#include "msgs/log_writer.h"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "msgs/log_reader.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::msgs {
namespace {

namespace fs = std::filesystem;

const std::vector<std::uint8_t> kData{1, 2, 3, 4, 5};

TEST(LogWriter, WritesWhatLcmItselfReads) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "run.lcmlog";
  LogWriter writer(path);
  writer.append("ENCODER", 1'000, kData);
  writer.append("TORQUE", 2'000, {});
  writer.finish();

  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(log, nullptr);
  lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log);
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->eventnum, 0);
  EXPECT_EQ(event->timestamp, 1'000);
  EXPECT_STREQ(event->channel, "ENCODER");
  ASSERT_EQ(event->datalen, 5);
  EXPECT_EQ(static_cast<std::uint8_t*>(event->data)[4], 5);
  lcm_eventlog_free_event(event);
  event = lcm_eventlog_read_next_event(log);
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->eventnum, 1);
  EXPECT_STREQ(event->channel, "TORQUE");
  EXPECT_EQ(event->datalen, 0);
  lcm_eventlog_free_event(event);
  EXPECT_EQ(lcm_eventlog_read_next_event(log), nullptr);
  lcm_eventlog_destroy(log);
}

TEST(LogWriter, TheNameSaysWhetherTheLogIsComplete) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "run.lcmlog";
  {
    LogWriter complete(path);
    complete.append("A", 0, kData);
    EXPECT_FALSE(fs::exists(path));
    complete.finish();
    EXPECT_TRUE(fs::exists(path));
    EXPECT_FALSE(fs::exists(partial_log_path(path)));
  }
  {
    LogWriter broken_off(path);
    broken_off.append("A", 0, kData);
  }
  EXPECT_FALSE(fs::exists(path)) << "the earlier run's log passes for this one's";
  LogReader reader(partial_log_path(path));
  LogEvent event;
  EXPECT_TRUE(reader.next(event));
  EXPECT_EQ(reader.damage().cut_off_bytes, 0);
}

TEST(LogWriter, AFolderThatIsNotThereIsNamed) {
  try {
    LogWriter writer("/nonexistent/folder/run.lcmlog");
    FAIL();
  } catch (const LogError& error) {
    EXPECT_NE(std::string(error.what()).find("/nonexistent/folder/run.lcmlog.partial"), std::string::npos);
  }
}

// A limit on the file's size stands for the full disk: the system refuses to write beyond it in the same way,
// with the last write cut in the middle of an event.
TEST(LogWriter, AFullDiskIsReportedAndTheLogIsCutBackToWholeEvents) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "run.lcmlog";
  constexpr rlim_t kRoom = 100'001;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limited{kRoom, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limited);

  std::string text;
  {
    LogWriter writer(path);
    try {
      for (int i = 0; i < 10'000; ++i) writer.append("SENSORS", i, kData);
    } catch (const LogError& error) {
      text = error.what();
    }
    EXPECT_THROW(writer.finish(), LogError) << "a log that lost events must not get its own name";
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);

  const std::size_t event_bytes = kLogEventHeadBytes + 7 + kData.size();
  const std::size_t whole_events = kRoom / event_bytes;
  EXPECT_NE(text.find(std::to_string(whole_events) + " events"), std::string::npos) << text;
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(fs::file_size(partial_log_path(path)), whole_events * event_bytes);
  LogReader reader(partial_log_path(path));
  LogEvent event;
  std::size_t count = 0;
  while (reader.next(event)) EXPECT_EQ(event.number, count++);
  EXPECT_EQ(count, whole_events);
  EXPECT_TRUE(describe(reader.damage()).empty());
}

}  // namespace
}  // namespace slewlab::msgs
