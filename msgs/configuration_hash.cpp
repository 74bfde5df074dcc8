#include "msgs/configuration_hash.h"

#include <stdexcept>

namespace slewlab::msgs {

std::int64_t configuration_hash(std::string_view canonical_text) {
  return continued_hash(kHashOfNothing,
                        {reinterpret_cast<const std::uint8_t*>(canonical_text.data()), canonical_text.size()});
}

std::int64_t continued_hash(std::int64_t hash, std::span<const std::uint8_t> bytes) {
  auto value = static_cast<std::uint64_t>(hash);
  for (const std::uint8_t byte : bytes) {
    value ^= byte;
    value *= 0x100000001b3ULL;
  }
  return static_cast<std::int64_t>(value);
}

std::string hash_text(std::int64_t hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  auto bits = static_cast<std::uint64_t>(hash);
  for (int i = 15; i >= 0; --i, bits >>= 4) text[static_cast<std::size_t>(i)] = kDigits[bits & 15];
  return text;
}

bool is_hash_text(std::string_view text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::int64_t hash_of_text(std::string_view text) {
  if (!is_hash_text(text)) throw std::invalid_argument("'" + std::string(text) + "' is no number of 16 hexadecimal digits");
  std::uint64_t hash = 0;
  for (const char c : text) hash = hash << 4 | static_cast<std::uint64_t>(c <= '9' ? c - '0' : c - 'a' + 10);
  return static_cast<std::int64_t>(hash);
}

}  // namespace slewlab::msgs
