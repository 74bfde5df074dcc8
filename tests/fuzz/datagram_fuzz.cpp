// Any bytes as a datagram of the bus: taken apart into channel and data that lie inside it, or refused.

#include <cstring>

#include "msgs/datagram.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  const auto datagram = msgs::read_datagram(msgs::Bytes(data, size));
  if (!datagram) return 0;
  fuzz::require(8 + datagram->channel.size() + 1 + datagram->data.size() == size,
                "head, channel and data are the whole datagram");
  fuzz::require(datagram->data.data() + datagram->data.size() == data + size, "the data end with the datagram");
  fuzz::require(datagram->channel.find('\0') == std::string_view::npos, "the channel's name ends at its zero");
  return 0;
}
