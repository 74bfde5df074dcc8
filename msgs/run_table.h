#pragma once

// The longest run of a log as one table per channel: a row per message, its fields in the machine's own numbers at places
// that are the same in every row, for whoever computes with whole columns. Given out a stretch of the file at a time, so
// that a log of any length fits: which messages are the run follows the rules of msgs/run_order.h; where a log is in order,
// which one reading of it shows, nothing is kept in memory but that stretch. Otherwise 24 bytes per message are.
//
// Of one channel, all arrays have the lengths that most of its messages have; messages with others are told and left out.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "msgs/row_layout.h"
#include "msgs/run_order.h"

namespace slewlab::msgs {

struct ChannelTable : RowLayout {
  std::int64_t rows = 0;
  std::int64_t first_time = 0;  // [ns] smallest simulated time of a row
  std::int64_t last_time = 0;   // [ns] largest
};

class RunTables {
 public:
  explicit RunTables(std::filesystem::path path);  // throws LogError as order_runs() does

  const std::vector<ChannelTable>& tables() const { return tables_; }        // of channels that hold messages
  const std::vector<std::string>& remarks() const { return remarks_; }
  // [ns] by which a row's simulated time may lie behind the latest one that was given out before it
  std::int64_t lateness() const { return lateness_; }

  // rows(table, number, bytes) for the tables that are asked for, in the order of the file, keys rising; after each
  // stretch, end_of_stretch(). Throws LogError.
  struct Taker {
    std::function<void(std::size_t table, std::size_t rows, Bytes bytes)> rows;
    std::function<void()> end_of_stretch;
  };
  void read(const std::vector<bool>& asked, const Taker& taker) const;

 private:
  struct Buffers;

  void lay_out(std::size_t channel, const ArrayCounts& counts);
  void read_in_file_order(const std::vector<bool>& asked, Buffers& buffers) const;
  template <class Take>
  void walk_ordered(const std::vector<bool>& asked, Take take) const;
  void read_ordered(const std::vector<bool>& asked, Buffers& buffers) const;

  std::filesystem::path path_;
  std::vector<ChannelTable> tables_;
  std::vector<std::string> remarks_;
  std::int64_t lateness_ = 0;
  AskedCounts counts_;
  bool in_file_order_ = false;
  OrderedRun run_;  // where the file is not in order
};

}  // namespace slewlab::msgs
