// Random numbers by counting: the same seed and counter give the same number, in whatever order they are
// asked for, so that a copy of a machine draws on as the original would.
#pragma once

#include <cstdint>

namespace slewlab::sim {

// Mixes all bits of seed and counter.
std::uint64_t mixed(std::uint64_t seed, std::uint64_t counter);

// Evenly in [0, 1).
double uniform_number(std::uint64_t seed, std::uint64_t counter);

}  // namespace slewlab::sim
