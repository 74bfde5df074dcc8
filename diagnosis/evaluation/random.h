// Random numbers of the withheld cases: a named stream per purpose, so that drawing more for one purpose moves
// nothing in another. splitmix64 (Steele, Lea, Flood 2014).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace slewlab::diagnosis::withheld {

class Random {
 public:
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0);

  std::uint64_t bits();
  double uniform();                             // [0, 1)
  double between(double low, double high);      // evenly
  double log_between(double low, double high);  // evenly in the logarithm; 0 < low
  double normal();                              // mean 0, deviation 1
  std::size_t below(std::size_t count);         // 0 ... count - 1
  double sign();                                // -1 or +1

  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::uint64_t state_;
};

}  // namespace slewlab::diagnosis::withheld
