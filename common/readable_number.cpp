#include "common/readable_number.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/yaml_node.h"

namespace slewlab::common {

std::string readable(double number) {
  constexpr int kDigitsBehindTheFirst = 5;
  constexpr double kLeastWrittenOut = 1e-4, kMostWrittenOut = 1e9;
  std::array<char, 32> text{};
  char* const end = text.data() + text.size();
  const auto rounded = std::to_chars(text.data(), end, number, std::chars_format::scientific, kDigitsBehindTheFirst);
  double value = number;
  std::from_chars(text.data(), rounded.ptr, value);
  const double size = std::abs(value);
  const bool is_written_out = value == 0.0 || (size >= kLeastWrittenOut && size < kMostWrittenOut);
  const auto written = is_written_out ? std::to_chars(text.data(), end, value, std::chars_format::fixed) : std::to_chars(text.data(), end, value);
  return {text.data(), written.ptr};
}

std::string readable_angle(double radians) { return readable(radians * 180.0 / std::numbers::pi) + " deg"; }

std::string readable_time(std::int64_t nanoseconds) {
  const bool is_short = std::abs(nanoseconds) < 1'000'000'000;
  return shortest(static_cast<double>(nanoseconds) / (is_short ? 1e6 : 1e9)) + (is_short ? " ms" : " s");
}

}  // namespace slewlab::common
