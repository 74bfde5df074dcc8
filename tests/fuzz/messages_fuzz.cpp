// Any bytes as any message of the wire: decoded whole, or refused. What decodes is encoded to the same bytes again,
// and what drive and controller make of it is safe.

#include <algorithm>

#include "msgs/codec.h"
#include "sim/drive/drive_protection.h"
#include "tests/fuzz/fuzz_target.h"

namespace slewlab {
namespace {

template <class Message>
msgs::DecodeStatus try_as(msgs::Bytes bytes) {
  static Message message;  // used again and again, as the programs do
  const msgs::DecodeStatus status = msgs::decode(bytes, message);
  if (status != msgs::DecodeStatus::ok) return status;
  static std::vector<std::uint8_t> again;
  msgs::encode(message, again);
  fuzz::require(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()),
                "a message that decodes is encoded to the same bytes");
  return status;
}

}  // namespace
}  // namespace slewlab

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  using namespace slewlab::msgs;
  const Bytes bytes(data, size);
  int fits = 0;
  fits += try_as<Encoder>(bytes) == DecodeStatus::ok;
  fits += try_as<Torque>(bytes) == DecodeStatus::ok;
  fits += try_as<Operator>(bytes) == DecodeStatus::ok;
  fits += try_as<Sensors>(bytes) == DecodeStatus::ok;
  fits += try_as<Truth>(bytes) == DecodeStatus::ok;
  fits += try_as<ControllerState>(bytes) == DecodeStatus::ok;
  fits += try_as<PlantStatus>(bytes) == DecodeStatus::ok;
  fits += try_as<Motion>(bytes) == DecodeStatus::ok;
  fuzz::require(fits <= 1, "bytes are one message at most");
  return 0;
}
