#pragma once

// The 64-bit number by which every message names the configuration it belongs to: FNV-1a over the canonical
// text of crane, controller and scenario (resolved, keys in a fixed order, so that comments and layout do
// not count). FNV-1a, 64 bits: offset basis 0xcbf29ce484222325, prime 0x100000001b3 (Fowler, Noll, Vo).

#include <cstdint>
#include <string>
#include <string_view>

namespace slewlab::msgs {

// Signed because LCM knows no unsigned 64-bit integers; the bits are those of the hash.
std::int64_t configuration_hash(std::string_view canonical_text);

// 16 hexadecimal digits, for files and people.
std::string hash_text(std::int64_t hash);

}  // namespace slewlab::msgs
