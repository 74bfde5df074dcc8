// Against the entities and characters of XML 1.0 (sections 2.2 and 4.6).
#include "common/xml_text.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

TEST(XmlText, MarkupBecomesEntities) { EXPECT_EQ(xml_text("a < b & \"c\" > d"), "a &lt; b &amp; &quot;c&quot; &gt; d"); }

TEST(XmlText, ControlCharactersBecomeBlanksAndLineBreaksStay) { EXPECT_EQ(xml_text("a\x1b[1m\tb\nc"), "a [1m b\nc"); }

TEST(XmlText, OtherTextStaysAsItIs) { EXPECT_EQ(xml_text("30 °, m/s²"), "30 °, m/s²"); }

}  // namespace
}  // namespace slewlab::common
