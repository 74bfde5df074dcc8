// Any bytes as a log: every byte is part of an event or counted as damage, and the whole reader sorts what it found or
// says that there is nothing. Tables of it hold as many rows as they say, and their keys rise.

#include <cstring>

#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "msgs/run_table.h"
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
  try {
    const msgs::RunTables run(path);
    std::vector<std::int64_t> rows(run.tables().size(), 0), last(run.tables().size());
    std::vector<std::size_t> key_at;
    for (const msgs::ChannelTable& table : run.tables()) {
      const bool is_answer = msgs::wire_messages()[table.channel].is_answer;
      for (const msgs::TableField& field : table.fields) {
        if (field.name == (is_answer ? "answered_sequence" : "sequence")) key_at.push_back(field.offset);
      }
    }
    const auto take = [&](std::size_t t, std::size_t count, msgs::Bytes bytes) {
      fuzz::require(bytes.size() == count * run.tables()[t].row_bytes, "rows are whole");
      for (std::size_t i = 0; i < count; ++i, ++rows[t]) {
        std::int64_t key = 0;
        std::memcpy(&key, bytes.data() + i * run.tables()[t].row_bytes + key_at[t], sizeof key);
        fuzz::require(rows[t] == 0 || last[t] < key, "keys rise");
        last[t] = key;
      }
    };
    run.read(std::vector<bool>(rows.size(), true), {take, [] {}});
    for (std::size_t t = 0; t < rows.size(); ++t) fuzz::require(rows[t] == run.tables()[t].rows, "as many rows as the table says");
  } catch (const msgs::LogError&) {
  }
  return 0;
}
