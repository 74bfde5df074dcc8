#include "msgs/datagram.h"

#include <cstring>

namespace slewlab::msgs {

std::optional<Datagram> read_datagram(Bytes bytes) {
  if (bytes.size() < kDatagramHeadBytes) return std::nullopt;
  const std::uint32_t word = std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
                             std::uint32_t{bytes[2]} << 8 | std::uint32_t{bytes[3]};
  if (word != kDatagramWord) return std::nullopt;
  const Bytes rest = bytes.subspan(kDatagramHeadBytes);
  const auto* channel = reinterpret_cast<const char*>(rest.data());
  const std::size_t channel_bytes = ::strnlen(channel, rest.size());
  if (channel_bytes == rest.size()) return std::nullopt;  // no zero behind the channel's name
  return Datagram{std::string_view(channel, channel_bytes), rest.subspan(channel_bytes + 1)};
}

}  // namespace slewlab::msgs
