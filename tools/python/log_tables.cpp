// slewlab-log-tables LOG: the log's run as tables (msgs/run_table.h), for tools/python/run_log.py. A program at the other
// end of a pipe: decoding goes on while Python computes, and needs nothing of Python's interpreter.
//
// Standard output begins with a line of JSON: {"tables": [{"channel", "rows", "row_bytes", "first_time", "last_time",
// "fields": [[name, numpy's type, number of elements or null, place in the row], ...]}, ...], "remarks": [...],
// "lateness"}. Then every line of standard input is a request: the names of channels, parted by blanks. The answer is made
// of records that begin with two int32_t in the machine's order: number of the table and number of rows, and the rows
// follow; -1: the end of a stretch of the file; -2: the end of the answer; -3: an error, and so many bytes of text follow.
// What the log does not give stands in standard error, exit code 1.

#include <cstdint>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "msgs/run_table.h"

namespace {

using namespace slewlab;

std::string numpy_type(const msgs::TableField& field) {
  if (field.kind == 'b') return "?";
  return std::string(1, field.kind) + std::to_string(field.bytes);
}

nlohmann::json description(const msgs::RunTables& run) {
  nlohmann::json tables = nlohmann::json::array();
  for (const msgs::ChannelTable& table : run.tables()) {
    nlohmann::json fields = nlohmann::json::array();
    for (const msgs::TableField& field : table.fields) {
      fields.push_back({field.name, numpy_type(field), field.count < 0 ? nlohmann::json() : nlohmann::json(field.count), field.offset});
    }
    tables.push_back({{"channel", msgs::wire_messages()[table.channel].channel},
                      {"rows", table.rows},
                      {"row_bytes", table.row_bytes},
                      {"first_time", table.first_time},
                      {"last_time", table.last_time},
                      {"fields", fields}});
  }
  return {{"tables", tables}, {"remarks", run.remarks()}, {"lateness", run.lateness()}};
}

void say(std::int32_t what, std::size_t count) {
  const std::int32_t head[2] = {what, static_cast<std::int32_t>(count)};
  std::fwrite(head, sizeof head, 1, stdout);
}

void answer(const msgs::RunTables& run, const std::string& request) {
  std::vector<bool> asked(run.tables().size(), false);
  std::istringstream words(request);
  for (std::string name; words >> name;) {
    for (std::size_t t = 0; t < asked.size(); ++t) {
      if (msgs::wire_messages()[run.tables()[t].channel].channel == name) asked[t] = true;
    }
  }
  try {
    run.read(asked, {[](std::size_t table, std::size_t rows, msgs::Bytes bytes) {
                       say(static_cast<std::int32_t>(table), rows);
                       std::fwrite(bytes.data(), 1, bytes.size(), stdout);
                     },
                     [] { say(-1, 0); }});
    say(-2, 0);
  } catch (const msgs::LogError& error) {
    const std::string text = error.what();
    say(-3, text.size());
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: slewlab-log-tables LOG\n");
    return 2;
  }
  try {
    const msgs::RunTables run(words[1]);
    std::printf("%s\n", description(run).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    std::fflush(stdout);
    for (std::string request; std::getline(std::cin, request);) answer(run, request);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
