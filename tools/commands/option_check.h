#pragma once

// What an option's value may be, told as a file's values are: "found X, expected Y".

#include <CLI/CLI.hpp>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace slewlab::tools {

CLI::Validator positive_number();
CLI::Validator whole_number(long long lowest, long long highest = std::numeric_limits<long long>::max());
CLI::Validator one_of(std::vector<std::string> words);
// What `words` stand for: the word becomes the number beside it.
CLI::Validator number_of(std::vector<std::pair<std::string, int>> words);
CLI::Validator readable_file();
CLI::Validator readable_folder();
CLI::Validator readable_path();  // a file or a folder
// Not empty: an unset variable of a shell would else be no command at all, and ours would run in its place.
CLI::Validator shell_command();

}  // namespace slewlab::tools
