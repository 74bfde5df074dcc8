#include "msgs/row_layout.h"

#include <algorithm>
#include <cstring>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kFingerprintBytes = 8;

template <class Unsigned>
void swap_into(const std::uint8_t* from, std::uint8_t* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i, from += sizeof(Unsigned), to += sizeof(Unsigned)) {
    Unsigned value = 0;
    for (std::size_t b = 0; b < sizeof(Unsigned); ++b) value = static_cast<Unsigned>(value << 8 | from[b]);
    std::memcpy(to, &value, sizeof value);
  }
}

std::size_t aligned(std::size_t offset, std::size_t to) { return (offset + to - 1) / to * to; }

}  // namespace

RowLayout row_layout(std::size_t channel, const ArrayCounts& counts) {
  RowLayout table;
  table.channel = channel;
  std::vector<RowLayout::Copy>& copies = table.copies;
  std::size_t from = kFingerprintBytes, to = 0;
  for (const WireField& field : wire_messages()[channel].fields) {
    const int count = field.count < 0 ? -1 : counts[static_cast<std::size_t>(field.count)];
    const std::size_t elements = count < 0 ? 1 : static_cast<std::size_t>(count);
    to = aligned(to, field.bytes);
    table.fields.push_back({field.name, field.kind, field.bytes, count, to});
    const bool joins = !copies.empty() && copies.back().bytes == field.bytes && field.kind != 'b' && !copies.back().is_boolean &&
                       copies.back().to + copies.back().bytes * copies.back().count == to;
    if (joins) {
      copies.back().count += elements;
    } else {
      copies.push_back({from, to, field.bytes, elements, field.kind == 'b'});
    }
    from += field.bytes * elements;
    to += field.bytes * elements;
  }
  table.row_bytes = aligned(to, 8);
  return table;
}

void append_row(const RowLayout& layout, Bytes message, std::vector<std::uint8_t>& rows) {
  const std::size_t begin = rows.size();
  rows.resize(begin + layout.row_bytes);
  for (const RowLayout::Copy& copy : layout.copies) {
    const std::uint8_t* from = message.data() + copy.from;
    std::uint8_t* to = rows.data() + begin + copy.to;
    switch (copy.bytes) {
      case 8: swap_into<std::uint64_t>(from, to, copy.count); break;
      case 4: swap_into<std::uint32_t>(from, to, copy.count); break;
      case 2: swap_into<std::uint16_t>(from, to, copy.count); break;
      default: std::copy_n(from, copy.count, to);
    }
    if (copy.is_boolean) std::transform(to, to + copy.count, to, [](std::uint8_t value) { return std::uint8_t{value != 0}; });
  }
}

}  // namespace slewlab::msgs
