#include "msgs/configuration_hash.h"

namespace slewlab::msgs {

std::int64_t configuration_hash(std::string_view canonical_text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : canonical_text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return static_cast<std::int64_t>(hash);
}

std::string hash_text(std::int64_t hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  auto bits = static_cast<std::uint64_t>(hash);
  for (int i = 15; i >= 0; --i, bits >>= 4) text[static_cast<std::size_t>(i)] = kDigits[bits & 15];
  return text;
}

}  // namespace slewlab::msgs
