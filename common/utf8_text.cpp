#include "common/utf8_text.h"

#include <algorithm>

namespace slewlab::common {
namespace {

unsigned byte_at(std::string_view text, std::size_t place) { return static_cast<unsigned char>(text[place]); }

bool goes_on(std::string_view text, std::size_t place) { return place < text.size() && (byte_at(text, place) & 0xC0u) == 0x80u; }

// How many bytes the character at `place` has; 0 where none begins.
std::size_t length_at(std::string_view text, std::size_t place) {
  const unsigned first = byte_at(text, place);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first <= 0xDF ? 2 : first >= 0xE0 && first <= 0xEF ? 3 : first >= 0xF0 && first <= 0xF4 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (!goes_on(text, place + i)) return 0;
  }
  if (length < 3) return length;
  const unsigned second = byte_at(text, place + 1);
  const bool is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_none = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);  // surrogates; beyond U+10FFFF
  return is_overlong || is_none ? 0 : length;
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t place = 0; place < text.size();) {
    const std::size_t length = length_at(text, place);
    if (length == 0) return false;
    place += length;
  }
  return true;
}

std::string utf8_text(std::string_view text) {
  std::string result;
  for (std::size_t place = 0; place < text.size();) {
    const std::size_t length = length_at(text, place);
    result += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(place, length);
    place += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string without_control(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string result;
  for (std::size_t place = 0; place < text.size();) {
    const unsigned byte = byte_at(text, place);
    const std::size_t length = std::max<std::size_t>(length_at(text, place), 1);
    const unsigned second = length == 2 ? byte_at(text, place + 1) : 0;
    if (byte < 0x20 || byte == 0x7F) {
      result += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
    } else if (byte == 0xC2 && second >= 0x80 && second <= 0x9F) {
      result += {'\\', 'u', '0', '0', kDigits[second >> 4], kDigits[second & 15]};
    } else {
      result += text.substr(place, length);
    }
    place += length;
  }
  return result;
}

std::string_view first_characters(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  while (most_bytes > 0 && goes_on(text, most_bytes)) --most_bytes;
  return text.substr(0, most_bytes);
}

}  // namespace slewlab::common
