#include "msgs/codec.h"

#include <array>
#include <stdexcept>
#include <string>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kHeadBytes = kFingerprintBytes + 3 * 8;  // and sequence, simulated time, configuration

// A message is a row of sections: `fixed` bytes, then (but for the last) a 32-bit count and `element` bytes
// for each counted element. The count itself is not part of `fixed`.
struct Section {
  std::size_t fixed;
  std::size_t element;
};

// One Layout per message: its sections, the bytes behind the last array, and its arrays with their counts.
template <class Message>
struct Layout;

template <>
struct Layout<Encoder> {
  static constexpr std::array<Section, 1> sections{{{4 * 8, 2 * 8}}};
  static constexpr std::size_t tail = 0;
  template <class M, class Visit>
  static void arrays(M& m, Visit visit) {
    visit(m.group_count, m.shaft_speed);
    visit(m.group_count, m.shaft_position);
  }
};

template <>
struct Layout<Torque> {
  static constexpr std::array<Section, 1> sections{{{5 * 8 + 4, 8}}};
  static constexpr std::size_t tail = 0;
  template <class M, class Visit>
  static void arrays(M& m, Visit visit) {
    visit(m.group_count, m.motor_torque);
  }
};

template <>
struct Layout<Operator> {
  static constexpr std::array<Section, 0> sections{};
  static constexpr std::size_t tail = 4 * 8 + 2;
  template <class M, class Visit>
  static void arrays(M&, Visit) {}
};

template <>
struct Layout<Sensors> {
  static constexpr std::array<Section, 0> sections{};
  static constexpr std::size_t tail = 8 * 8;
  template <class M, class Visit>
  static void arrays(M&, Visit) {}
};

template <>
struct Layout<Truth> {
  static constexpr std::array<Section, 3> sections{{{3 * 8, 3 * 8}, {7 * 8, 8}, {0, 8}}};
  static constexpr std::size_t tail = 0;
  template <class M, class Visit>
  static void arrays(M& m, Visit visit) {
    visit(m.group_count, m.gearbox_torque);
    visit(m.group_count, m.gear_deflection);
    visit(m.group_count, m.play_crossings);
    visit(m.element_count, m.shear_force);
    visit(m.mode_count, m.modal_energy);
  }
};

template <>
struct Layout<ControllerState> {
  static constexpr std::array<Section, 1> sections{{{4 * 8 + 1 + 3 * 8, 2 * 8}}};
  static constexpr std::size_t tail = 0;
  template <class M, class Visit>
  static void arrays(M& m, Visit visit) {
    visit(m.group_count, m.proportional_torque);
    visit(m.group_count, m.integral_torque);
  }
};

template <>
struct Layout<PlantStatus> {
  static constexpr std::array<Section, 2> sections{{{3 * 8 + 2, 8}, {2 * 8, 3 * 8}}};
  static constexpr std::size_t tail = 0;
  template <class M, class Visit>
  static void arrays(M& m, Visit visit) {
    visit(m.fault_count, m.faults);
    visit(m.bin_count, m.bin_edge);
    visit(m.bin_count, m.wakeup_latency);
    visit(m.bin_count, m.step_time);
  }
};

std::int64_t big_endian_64(const std::uint8_t* p) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | p[i];
  return static_cast<std::int64_t>(value);
}

std::int32_t big_endian_32(const std::uint8_t* p) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | p[i];
  return static_cast<std::int32_t>(value);
}

bool plausible_head(Bytes bytes) {
  constexpr std::int64_t kSequenceLimit = std::int64_t{1} << 40;
  constexpr std::int64_t kTimeLimit = 1'000'000'000'000'000'000;  // [ns]
  const std::int64_t sequence = big_endian_64(bytes.data() + 8);
  const std::int64_t time = big_endian_64(bytes.data() + 16);
  return sequence >= 0 && sequence <= kSequenceLimit && time >= 0 && time <= kTimeLimit;
}

template <class Message>
DecodeStatus check(Bytes bytes) {
  if (bytes.size() < kFingerprintBytes) return DecodeStatus::truncated;
  if (big_endian_64(bytes.data()) != Message::getHash()) {
    if (bytes.size() < kHeadBytes) return DecodeStatus::garbage;
    return plausible_head(bytes) ? DecodeStatus::other_version : DecodeStatus::garbage;
  }
  std::size_t left = bytes.size() - kFingerprintBytes;
  for (const Section& section : Layout<Message>::sections) {
    if (left < section.fixed + 4) return DecodeStatus::truncated;
    left -= section.fixed + 4;
    const std::int32_t count = big_endian_32(bytes.data() + bytes.size() - left - 4);
    if (count < 0) return DecodeStatus::garbage;
    const std::size_t wanted = static_cast<std::size_t>(count) * section.element;
    if (left < wanted) return DecodeStatus::truncated;
    left -= wanted;
  }
  if (left < Layout<Message>::tail) return DecodeStatus::truncated;
  return left == Layout<Message>::tail ? DecodeStatus::ok : DecodeStatus::garbage;
}

template <class Message>
DecodeStatus decode_checked(Bytes bytes, Message& message) {
  const DecodeStatus status = check<Message>(bytes);
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

void encode(const Encoder& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Torque& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Operator& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Sensors& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const Truth& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }
void encode(const ControllerState& message, std::vector<std::uint8_t>& bytes) {
  encode_checked(message, bytes);
}
void encode(const PlantStatus& message, std::vector<std::uint8_t>& bytes) { encode_checked(message, bytes); }

}  // namespace slewlab::msgs
