#include "common/utf8_text.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

// Well-formed and ill-formed sequences of the Unicode Standard, table 3-7 and section 3.9.
TEST(Utf8Text, KnowsWhatUtf8Is) {
  for (const char* text : {"", "plain", "\xC2\xB0", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xF0\x9F\x8F\x97", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
    EXPECT_EQ(utf8_text(text), text);
  }
  for (const char* text : {"\xB0", "\xC2", "\xC0\xAF", "\xC1\xBF", "\xE0\x9F\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80",
                           "\xE2\x82", "\xFF"}) {
    EXPECT_FALSE(is_utf8(text));
    EXPECT_TRUE(is_utf8(utf8_text(text)));
  }
}

TEST(Utf8Text, ReplacesWhatIsNoneAndKeepsTheRest) {
  EXPECT_EQ(utf8_text("53 \xB0 or 53 \xC2\xB0"), "53 \xEF\xBF\xBD or 53 \xC2\xB0");
  EXPECT_EQ(utf8_text("\xE2\x82x"), "\xEF\xBF\xBD\xEF\xBF\xBDx");
}

TEST(Utf8Text, ControlCharactersAreShownAndNotObeyed) {
  EXPECT_EQ(without_control("gear\x1b[31mbox"), "gear\\x1b[31mbox");
  EXPECT_EQ(without_control("a\nb\x7f" "c\xC2\x9B" "31m"), "a\\x0ab\\x7fc\\u009b31m");
  EXPECT_EQ(without_control("53 \xC2\xB0, \xE2\x82\xAC, \xB0"), "53 \xC2\xB0, \xE2\x82\xAC, \xB0");
}

TEST(Utf8Text, CutsBetweenCharacters) {
  EXPECT_EQ(first_characters("abc", 3), "abc");
  EXPECT_EQ(first_characters("abc", 2), "ab");
  EXPECT_EQ(first_characters("a\xC2\xB0", 2), "a");
  EXPECT_EQ(first_characters("\xE2\x82\xAC", 2), "");
}

}  // namespace
}  // namespace slewlab::common
