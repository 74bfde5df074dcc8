#pragma once

// A datagram of LCM's UDP multicast protocol, taken apart: the word "LC02", a running number of the sender's, the
// channel's name with its zero, and the data, numbers big-endian. Messages beyond one datagram come in fragments under
// another word; no message of slewlab is that large, and fragments are refused.

#include <cstdint>
#include <optional>
#include <string_view>

#include "msgs/codec.h"

namespace slewlab::msgs {

inline constexpr std::uint32_t kDatagramWord = 0x4c433032;  // "LC02"
inline constexpr std::size_t kDatagramHeadBytes = 8;

struct Datagram {
  std::string_view channel;  // both are parts of the bytes that came in
  Bytes data;
};

// Safe for any bytes; nothing where they are no such datagram.
std::optional<Datagram> read_datagram(Bytes bytes);

}  // namespace slewlab::msgs
