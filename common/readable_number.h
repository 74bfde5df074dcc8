// A number in a message to people.
#pragma once

#include <cstdint>
#include <string>

namespace slewlab::common {

// Six digits: 0.415 for 0.41500000000000004, 6000000 for 6e6. Very large and very small ones with an exponent.
std::string readable(double number);

// [deg] of an angle in rad, "82 deg".
std::string readable_angle(double radians);

// Of a time in nanoseconds with all its digits, in ms below a second and in s from there on: "10 ms", "5.0005 s".
std::string readable_time(std::int64_t nanoseconds);

}  // namespace slewlab::common
