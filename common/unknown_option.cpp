#include "common/unknown_option.h"

#include <algorithm>

#include "common/near_name.h"

namespace slewlab::common {

std::optional<std::string> unknown_option(const std::string& program, const std::vector<std::string>& words, const std::vector<std::string>& known) {
  if (words.empty()) return std::nullopt;
  const auto name_in = [](const std::string& word) { return word.substr(0, word.find('=')); };
  const auto end = std::find(words.begin() + 1, words.end(), "--");
  const auto found = std::find_if(words.begin() + 1, end, [&](const std::string& word) {
    return word.starts_with("--") && std::find(known.begin(), known.end(), name_in(word)) == known.end();
  });
  if (found == end) return std::nullopt;
  const std::string name = name_in(*found);
  return program + ": '" + name + "' is no option of it, expected " + known_names_text(name, known);
}

}  // namespace slewlab::common
