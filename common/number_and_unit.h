// "60 t" as its number and its unit, as --set, messages and Python's changes write it.
#pragma once

#include <optional>
#include <string_view>

namespace slewlab::common {

struct NumberAndUnit {
  double number = 0.0;
  std::string_view digits;  // the number as it is written
  std::string_view unit;    // what stands behind it, known or not; empty: nothing
};

// Parts of the text. Nothing where it does not begin with a number.
std::optional<NumberAndUnit> number_and_unit(std::string_view text);

}  // namespace slewlab::common
