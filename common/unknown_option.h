// What is unknown on the command line of a program with no commands of its own.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "common/refused_words.h"

namespace slewlab::common {

// "slewlab-plant: '--ste' is no option of it, expected '--set' (or one of ...)"; nothing where every option is known. `words` begin with
// the program's name, `known` are as "--set".
std::optional<std::string> unknown_option(const std::string& program, const std::vector<std::string>& words, const std::vector<std::string>& known);

// The exit code of a program whose command line CLI11 did not take, and why on standard error: what is unknown before what is missing, for it may have been
// meant for that. 0 where help was asked for.
template <class App, class ParseError>
int exit_code_of_refused(const std::string& program, const App& app, const ParseError& error, int argc, char** argv) {
  std::vector<std::string> known;
  for (const auto* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  const auto unknown = error.get_exit_code() == 0 ? std::nullopt : unknown_option(program, {argv, argv + argc}, known);
  if (error.get_exit_code() == 0) return app.exit(error);
  std::fprintf(stderr, "%s\n", unknown ? unknown->c_str() : refused_words(program, error.what()).c_str());
  return 2;
}

}  // namespace slewlab::common
