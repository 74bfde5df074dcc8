#include "common/unit.h"

#include <numbers>

namespace slewlab::common {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;                  // [rad]
constexpr double kTurnPerMinute = 2.0 * std::numbers::pi / 60.0;      // [rad/s]

struct Spelling {
  Unit unit;
  std::string_view text;
  double factor;
};

// The first spelling of each unit is the SI one.
constexpr Spelling kSpellings[] = {
    {Unit::none, "-", 1.0},
    {Unit::none, "%", 1e-2},
    {Unit::second, "s", 1.0},
    {Unit::second, "ms", 1e-3},
    {Unit::second, "us", 1e-6},
    {Unit::second, "min", 60.0},
    {Unit::second, "h", 3600.0},
    {Unit::hertz, "Hz", 1.0},
    {Unit::hertz, "kHz", 1e3},
    {Unit::metre, "m", 1.0},
    {Unit::metre, "mm", 1e-3},
    {Unit::metre, "cm", 1e-2},
    {Unit::metre, "km", 1e3},
    {Unit::square_metre, "m^2", 1.0},
    {Unit::square_metre, "cm^2", 1e-4},
    {Unit::square_metre, "mm^2", 1e-6},
    {Unit::metre_to_the_fourth, "m^4", 1.0},
    {Unit::metre_to_the_fourth, "cm^4", 1e-8},
    {Unit::metre_to_the_fourth, "mm^4", 1e-12},
    {Unit::metre_per_second, "m/s", 1.0},
    {Unit::metre_per_second, "mm/s", 1e-3},
    {Unit::metre_per_second, "km/h", 1.0 / 3.6},
    {Unit::metre_per_second_squared, "m/s^2", 1.0},
    {Unit::metre_per_second_squared, "mm/s^2", 1e-3},
    {Unit::radian, "rad", 1.0},
    {Unit::radian, "mrad", 1e-3},
    {Unit::radian, "deg", kDegree},
    {Unit::radian_per_second, "rad/s", 1.0},
    {Unit::radian_per_second, "mrad/s", 1e-3},
    {Unit::radian_per_second, "deg/s", kDegree},
    {Unit::radian_per_second, "rpm", kTurnPerMinute},
    {Unit::radian_per_second, "1/min", kTurnPerMinute},
    {Unit::radian_per_second_squared, "rad/s^2", 1.0},
    {Unit::radian_per_second_squared, "deg/s^2", kDegree},
    {Unit::kilogram, "kg", 1.0},
    {Unit::kilogram, "t", 1e3},
    {Unit::kilogram_per_metre, "kg/m", 1.0},
    {Unit::kilogram_per_metre, "t/m", 1e3},
    {Unit::kilogram_per_cubic_metre, "kg/m^3", 1.0},
    {Unit::kilogram_square_metre, "kg m^2", 1.0},
    {Unit::kilogram_square_metre, "t m^2", 1e3},
    {Unit::kilogram_square_metre, "kg cm^2", 1e-4},
    {Unit::kilogram_square_metre, "kg mm^2", 1e-6},
    {Unit::kilogram_square_metre, "g cm^2", 1e-7},
    {Unit::newton, "N", 1.0},
    {Unit::newton, "kN", 1e3},
    {Unit::newton, "MN", 1e6},
    {Unit::newton_per_metre, "N/m", 1.0},
    {Unit::newton_per_metre, "kN/m", 1e3},
    {Unit::newton_per_metre, "MN/m", 1e6},
    {Unit::newton_per_second, "N/s", 1.0},
    {Unit::newton_per_second, "kN/s", 1e3},
    {Unit::newton_second_per_metre, "N s/m", 1.0},
    {Unit::newton_second_per_metre, "kN s/m", 1e3},
    {Unit::newton_metre, "N m", 1.0},
    {Unit::newton_metre, "kN m", 1e3},
    {Unit::newton_metre, "MN m", 1e6},
    {Unit::newton_metre, "N cm", 1e-2},
    {Unit::newton_metre, "mN m", 1e-3},
    {Unit::newton_metre_per_second, "N m/s", 1.0},
    {Unit::newton_metre_per_second, "kN m/s", 1e3},
    {Unit::newton_metre_per_radian, "N m/rad", 1.0},
    {Unit::newton_metre_per_radian, "kN m/rad", 1e3},
    {Unit::newton_metre_per_radian, "MN m/rad", 1e6},
    {Unit::newton_metre_per_radian, "GN m/rad", 1e9},
    {Unit::newton_metre_second_per_radian, "N m s/rad", 1.0},
    {Unit::newton_metre_second_per_radian, "kN m s/rad", 1e3},
    {Unit::newton_metre_second_per_radian, "MN m s/rad", 1e6},
    {Unit::newton_square_metre, "N m^2", 1.0},
    {Unit::newton_square_metre, "kN m^2", 1e3},
    {Unit::newton_square_metre, "MN m^2", 1e6},
    {Unit::pascal, "Pa", 1.0},
    {Unit::pascal, "N/m^2", 1.0},
    {Unit::pascal, "kPa", 1e3},
    {Unit::pascal, "MPa", 1e6},
    {Unit::pascal, "GPa", 1e9},
    {Unit::pascal, "bar", 1e5},
    {Unit::per_second, "1/s", 1.0},
};

std::string squeezed(std::string_view spelling) {
  std::string text;
  for (std::size_t i = 0; i < spelling.size();) {
    const std::string_view rest = spelling.substr(i);
    if (rest[0] == ' ' || rest[0] == '*') {
      i += 1;
    } else if (rest.starts_with("\u00b7")) {
      i += 2;
    } else if (rest.starts_with("\u00b2")) {
      text += "^2";
      i += 2;
    } else if (rest.starts_with("\u00b3")) {
      text += "^3";
      i += 2;
    } else if (rest.starts_with("\u00b0")) {
      text += "deg";
      i += 2;
    } else {
      text += rest[0];
      i += 1;
    }
  }
  return text;
}

}  // namespace

std::string_view name_of(Unit unit) {
  for (const Spelling& known : kSpellings) {
    if (known.unit == unit) return known.text;
  }
  return "";
}

std::string spellings_of(Unit unit) {
  std::string text;
  for (const Spelling& known : kSpellings) {
    if (known.unit != unit) continue;
    if (!text.empty()) text += ", ";
    text += known.text;
  }
  return text;
}

std::optional<double> factor_to_si(Unit unit, std::string_view spelling) {
  const std::string wanted = squeezed(spelling);
  for (const Spelling& known : kSpellings) {
    if (known.unit == unit && squeezed(known.text) == wanted) return known.factor;
  }
  return std::nullopt;
}

std::optional<Unit> unit_of(std::string_view spelling) {
  const std::string wanted = squeezed(spelling);
  for (const Spelling& known : kSpellings) {
    if (squeezed(known.text) == wanted) return known.unit;
  }
  return std::nullopt;
}

}  // namespace slewlab::common
