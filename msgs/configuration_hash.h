#pragma once

// The 64-bit number by which every message names the configuration it belongs to: FNV-1a over the canonical
// text of crane, controller and scenario (resolved, keys in a fixed order, so that comments and layout do
// not count). FNV-1a, 64 bits: offset basis 0xcbf29ce484222325, prime 0x100000001b3 (Fowler, Noll, Vo).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace slewlab::msgs {

// Signed because LCM knows no unsigned 64-bit integers; the bits are those of the hash.
std::int64_t configuration_hash(std::string_view canonical_text);

// The same algorithm over any bytes, piece by piece: begin with kHashOfNothing.
inline constexpr std::int64_t kHashOfNothing = static_cast<std::int64_t>(0xcbf29ce484222325ULL);
std::int64_t continued_hash(std::int64_t hash, std::span<const std::uint8_t> bytes);

// 16 hexadecimal digits, for files and people.
std::string hash_text(std::int64_t hash);
bool is_hash_text(std::string_view text);
std::int64_t hash_of_text(std::string_view text);  // of what hash_text() gives; anything else: std::invalid_argument

}  // namespace slewlab::msgs
