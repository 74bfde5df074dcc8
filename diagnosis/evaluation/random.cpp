#include "diagnosis/evaluation/random.h"

#include <cmath>
#include <numbers>

namespace slewlab::diagnosis::withheld {

Random::Random(std::uint64_t seed, std::string_view purpose, std::uint64_t index) : state_(seed) {
  for (const char letter : purpose) {
    state_ ^= static_cast<unsigned char>(letter);
    state_ = bits();
  }
  state_ ^= index;
  state_ = bits();
}

std::uint64_t Random::bits() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

double Random::between(double low, double high) { return low + (high - low) * uniform(); }

double Random::log_between(double low, double high) { return low * std::pow(high / low, uniform()); }

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

std::size_t Random::below(std::size_t count) {
  return static_cast<std::size_t>(uniform() * static_cast<double>(count));
}

double Random::sign() { return bits() >> 63 == 0 ? -1.0 : 1.0; }

}  // namespace slewlab::diagnosis::withheld
