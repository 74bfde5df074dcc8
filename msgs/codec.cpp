#include "msgs/codec.h"

#include <stdexcept>
#include <string>

#include "msgs/wire_layout.h"

namespace slewlab::msgs {
namespace {

template <class Message>
DecodeStatus decode_checked(Bytes bytes, Message& message) {
  ArrayCounts counts;
  const DecodeStatus status = check(bytes, Message::getHash(), Layout<Message>::pieces, counts);
  if (status != DecodeStatus::ok) return status;
  // The generated decoder leaves an array alone whose count is zero.
  Layout<Message>::arrays(message, [](auto, auto& array) { array.clear(); });
  const int size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size ? DecodeStatus::ok : DecodeStatus::garbage;
}

template <class Message>
void encode_checked(const Message& message, std::vector<std::uint8_t>& bytes) {
  Layout<Message>::arrays(message, [](auto count, const auto& array) {
    if (count < 0 || array.size() != static_cast<std::size_t>(count)) {
      throw std::logic_error(std::string(Message::getTypeName()) + ": an array of " +
                             std::to_string(array.size()) + " elements whose count says " +
                             std::to_string(count));
    }
  });
  bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

}  // namespace

const char* to_string(DecodeStatus status) {
  switch (status) {
    case DecodeStatus::ok: return "ok";
    case DecodeStatus::truncated: return "truncated";
    case DecodeStatus::other_version: return "other version";
    case DecodeStatus::garbage: return "garbage";
  }
  return "unknown";
}

DecodeStatus decode(Bytes bytes, Encoder& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Torque& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Operator& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Sensors& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Truth& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, ControllerState& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, PlantStatus& message) { return decode_checked(bytes, message); }
DecodeStatus decode(Bytes bytes, Motion& message) { return decode_checked(bytes, message); }

void encode(const Encoder& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Torque& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Operator& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Sensors& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Truth& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const ControllerState& message, std::vector<std::uint8_t>& bytes) {
  encode_checked(message, bytes);
}
void encode(const PlantStatus& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Motion& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }

}  // namespace slewlab::msgs
