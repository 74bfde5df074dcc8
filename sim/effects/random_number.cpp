#include "sim/effects/random_number.h"

namespace slewlab::sim {

std::uint64_t mixed(std::uint64_t seed, std::uint64_t counter) {
  // Two rounds of multiply and shift; the odd constants are the golden ratio and two primes of 64 bits.
  std::uint64_t x = seed + 0x9E3779B97F4A7C15ULL * (counter + 1);
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

double uniform_number(std::uint64_t seed, std::uint64_t counter) {
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return static_cast<double>(mixed(seed, counter) >> 11) * kUnit;
}

}  // namespace slewlab::sim
