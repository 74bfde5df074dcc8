// Text of others, which may be no UTF-8: a file in another encoding, or a bit that turned over. What is told of it goes into JSON and
// into Python, which take nothing else.
#pragma once

#include <string>
#include <string_view>

namespace slewlab::common {

// Whether every byte belongs to a character of UTF-8 (Unicode 15, table 3-7: no overlong forms, no surrogates).
bool is_utf8(std::string_view text);

// The text with U+FFFD in place of every byte that does not.
std::string utf8_text(std::string_view text);

// The text with \\xNN or \\u00NN in place of every control character (C0, DEL, C1), as it may be shown: a terminal obeys some of them.
std::string without_control(std::string_view text);

// Its first characters, at most so many bytes of them.
std::string_view first_characters(std::string_view text, std::size_t most_bytes);

}  // namespace slewlab::common
