// Any bytes as a log: every byte is part of an event or counted as damage, and the whole reader sorts what it found or
// says that there is nothing.

#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  static const TemporaryFolder folder;
  static const std::filesystem::path path = folder.path() / "run.lcmlog";
  fuzz::write_file(path, data, size);

  msgs::LogReader reader(path);
  msgs::LogEvent event;
  std::size_t used = 0;
  while (reader.next(event)) used += msgs::kLogEventHeadBytes + event.channel.size() + event.data.size();
  const msgs::LogDamage& damage = reader.damage();
  used += static_cast<std::size_t>(damage.skipped_bytes) + static_cast<std::size_t>(damage.cut_off_bytes);
  fuzz::require(used == size, "every byte is part of an event or counted as damage");

  try {
    const msgs::RunLogs logs = msgs::read_run_logs(path);
    fuzz::require(!logs.runs.empty(), "a log that can be read holds a run");
    for (const msgs::RunLog& run : logs.runs) {
      for (std::size_t i = 1; i < run.encoder.size(); ++i) {
        fuzz::require(run.encoder[i - 1].sequence < run.encoder[i].sequence, "sequence numbers rise");
      }
    }
  } catch (const msgs::LogError&) {
  }
  return 0;
}
