#pragma once

// A message's fields in the machine's own numbers at places that are the same in every row: what whole columns are computed
// from. All rows of a layout have arrays of the same lengths.

#include <cstdint>
#include <string_view>
#include <vector>

#include "msgs/wire_layout.h"

namespace slewlab::msgs {

struct TableField {
  std::string_view name;
  char kind = 0;           // WireField::kind
  std::size_t bytes = 0;   // of one element
  int count = -1;          // elements of an array, -1: a single one
  std::size_t offset = 0;  // [bytes] in the row
};

struct RowLayout {
  struct Copy {  // a stretch of elements of one size, from a message to a row
    std::size_t from = 0;
    std::size_t to = 0;
    std::size_t bytes = 0;
    std::size_t count = 0;
    bool is_boolean = false;
  };
  std::size_t channel = 0;  // place in wire_messages()
  std::vector<TableField> fields;
  std::size_t row_bytes = 0;  // a multiple of 8; every field is aligned to its size
  std::vector<Copy> copies;
};

RowLayout row_layout(std::size_t channel, const ArrayCounts& counts);

// Of a message that check() finds ok, with the layout's counts.
void append_row(const RowLayout& layout, Bytes message, std::vector<std::uint8_t>& rows);

}  // namespace slewlab::msgs
