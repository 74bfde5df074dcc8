#pragma once

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace slewlab {

// The number at a place of a program's command line, `otherwise` where it has fewer words. What is none ends the program with exit code 2.
template <class Number>
Number number_argument(int argc, char** argv, int place, Number otherwise) {
  if (place >= argc) return otherwise;
  const std::string_view word = argv[place];
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc{} && end == word.data() + word.size()) return number;
  std::fprintf(stderr, "%s: argument %d: found '%s', expected a number\n", argv[0], place, argv[place]);
  std::exit(2);
}

}  // namespace slewlab
