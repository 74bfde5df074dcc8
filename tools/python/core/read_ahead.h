#pragma once

// A log's rows, a stretch of the file at a time, decoded by a thread of its own while whoever takes them computes. At most two
// stretches wait, so that memory does not grow with the log.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "msgs/run_table.h"

namespace slewlab::tools {

struct TableRows {
  std::size_t table = 0;  // its number in RunTables::tables()
  std::vector<std::uint8_t> bytes;
};
using Stretch = std::vector<TableRows>;

class ReadAhead {
 public:
  // `tables` outlives this; `asked` as of RunTables::read().
  ReadAhead(const msgs::RunTables& tables, std::vector<bool> asked);
  ~ReadAhead();  // what was not taken yet is left
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // The next stretch, nothing behind the last one; throws what the reading threw.
  std::optional<Stretch> next();

 private:
  void read(const msgs::RunTables& tables, const std::vector<bool>& asked);
  void put(Stretch stretch);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Stretch> waiting_;
  bool is_left_ = false, has_ended_ = false;
  std::exception_ptr problem_;
  std::thread thread_;
};

}  // namespace slewlab::tools
