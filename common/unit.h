// Units that a file may give a value in, and their factors to SI. A value is converted only between the
// declared spellings of one unit (mm -> m, deg -> rad, rpm -> rad/s); anything else is an error.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace slewlab::common {

enum class Unit {
  none,
  second,
  hertz,
  metre,
  square_metre,
  metre_to_the_fourth,
  metre_per_second,
  metre_per_second_squared,
  radian,
  radian_per_second,
  radian_per_second_squared,
  kilogram,
  kilogram_per_metre,
  kilogram_per_cubic_metre,
  kilogram_square_metre,
  newton,
  newton_per_metre,
  newton_per_second,
  newton_second_per_metre,
  newton_metre,
  newton_metre_per_second,
  newton_metre_per_radian,
  newton_metre_second_per_radian,
  newton_square_metre,
  pascal,
  per_second,
};

// The SI spelling, as it stands in messages: "N m".
std::string_view name_of(Unit unit);

// All spellings accepted for the unit, comma between.
std::string spellings_of(Unit unit);

// The factor from the spelling to SI, or nothing where the spelling is not one of the unit's.
// Blanks, '*' and '·' between factors do not matter; "²" and "^2" are the same, and so are "°" and "deg".
std::optional<double> factor_to_si(Unit unit, std::string_view spelling);

// The unit that the spelling belongs to, for messages about mixed units.
std::optional<Unit> unit_of(std::string_view spelling);

}  // namespace slewlab::common
