#pragma once

// Messages to bytes and back. Decoding is safe for any bytes whatsoever: what lcm-gen's own decoder takes
// on trust (array counts) is checked against the number of bytes first, so nothing is allocated beyond the
// size of what came in and nothing is thrown. What is wrong with the bytes is told apart:
//
//   truncated      shorter than the message's head, or than its own array counts demand
//   other_version  another fingerprint, but the common head behind it is plausible: sequence in 0 ... 2^40,
//                  simulated time in 0 ... 10^18 ns (31 years); random bytes pass for it once in 2^27 cases
//   garbage        another fingerprint and no plausible head, a negative array count, or bytes left over
//
// A message object that is used again keeps its memory: decoding and encoding allocate only while sizes grow.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "msgs/messages.h"

namespace slewlab::msgs {

enum class DecodeStatus { ok, truncated, other_version, garbage };

const char* to_string(DecodeStatus status);

using Bytes = std::span<const std::uint8_t>;

// `message` is meaningful only where ok is returned.
DecodeStatus decode(Bytes bytes, Encoder& message);
DecodeStatus decode(Bytes bytes, Torque& message);
DecodeStatus decode(Bytes bytes, Operator& message);
DecodeStatus decode(Bytes bytes, Sensors& message);
DecodeStatus decode(Bytes bytes, Truth& message);
DecodeStatus decode(Bytes bytes, ControllerState& message);
DecodeStatus decode(Bytes bytes, PlantStatus& message);
DecodeStatus decode(Bytes bytes, Motion& message);

// Arrays must be as long as their counts say (std::logic_error otherwise: a fault of the program).
void encode(const Encoder& message, std::vector<std::uint8_t>& bytes);
void encode(const Torque& message, std::vector<std::uint8_t>& bytes);
void encode(const Operator& message, std::vector<std::uint8_t>& bytes);
void encode(const Sensors& message, std::vector<std::uint8_t>& bytes);
void encode(const Truth& message, std::vector<std::uint8_t>& bytes);
void encode(const ControllerState& message, std::vector<std::uint8_t>& bytes);
void encode(const PlantStatus& message, std::vector<std::uint8_t>& bytes);
void encode(const Motion& message, std::vector<std::uint8_t>& bytes);

}  // namespace slewlab::msgs
