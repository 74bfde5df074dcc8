// Text for an XML document, in an element or between double quotes.
#pragma once

#include <string>
#include <string_view>

namespace slewlab::common {

// &, <, > and " as entities. Control characters, which XML 1.0 has not, become blanks, but for line breaks.
std::string xml_text(std::string_view text);

}  // namespace slewlab::common
