#include "tools/commands/option_check.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "common/near_name.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

std::string refusal(const std::string& found, const std::string& expected) { return "found '" + found + "', expected " + expected; }

template <class Number>
bool read(const std::string& text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && rest == end;
}

template <class IsRight>
CLI::Validator existing(const char* name, IsRight is_right, const char* expected) {
  return CLI::Validator([=](const std::string& text) { return is_right(fs::path(text)) ? std::string() : refusal(text, expected); }, name);
}

}  // namespace

CLI::Validator positive_number() {
  return CLI::Validator(
      [](const std::string& text) {
        double number = 0.0;
        return read(text, number) && std::isfinite(number) && number > 0.0 ? std::string() : refusal(text, "a number above 0");
      },
      "POSITIVE");
}

CLI::Validator whole_number(long long lowest, long long highest) {
  const bool is_bounded = highest != std::numeric_limits<long long>::max();
  const std::string low = std::to_string(lowest), high = std::to_string(highest);
  const std::string expected = "a whole number " + (is_bounded ? "from " + low + " to " + high : "of at least " + low);
  return CLI::Validator(
      [=](const std::string& text) {
        long long number = 0;
        return read(text, number) && number >= lowest && number <= highest ? std::string() : refusal(text, expected);
      },
      is_bounded ? low + "..." + high : ">=" + low);
}

CLI::Validator one_of(std::vector<std::string> words) {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "{" : ",") + word;
  return CLI::Validator(
      [words = std::move(words)](const std::string& text) {
        const bool is_known = std::find(words.begin(), words.end(), text) != words.end();
        return is_known ? std::string() : refusal(text, common::known_names_text(text, words));
      },
      name + "}");
}

CLI::Validator number_of(std::vector<std::pair<std::string, int>> words) {
  std::vector<std::string> names;
  for (const auto& [name, number] : words) names.push_back(name);
  const CLI::Validator known = one_of(names);
  return CLI::Validator(
      [words = std::move(words), known](std::string& text) {
        if (std::string why = known(text); !why.empty()) return why;
        const auto named = std::find_if(words.begin(), words.end(), [&](const auto& each) { return each.first == text; });
        text = std::to_string(named->second);
        return std::string();
      },
      known.get_description());
}

CLI::Validator readable_file() {
  return existing("FILE", [](const fs::path& path) { return fs::exists(path) && !fs::is_directory(path); }, "the name of a file that is there");
}

CLI::Validator readable_folder() {
  return existing("DIR", [](const fs::path& path) { return fs::is_directory(path); }, "the name of a folder that is there");
}

CLI::Validator readable_path() {
  return existing("PATH(existing)", [](const fs::path& path) { return fs::exists(path); }, "the name of a file or a folder that is there");
}

CLI::Validator shell_command() {
  return CLI::Validator(
      [](const std::string& text) {
        return text.find_first_not_of(" \t\n") != std::string::npos ? std::string() : refusal(text, "a command of the shell");
      },
      "CMD");
}

}  // namespace slewlab::tools
