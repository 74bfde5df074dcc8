#include "common/refused_words.h"

#include <optional>
#include <string_view>

namespace slewlab::common {
namespace {

// The text before and behind `middle`.
struct Sides {
  std::string before, behind;
};

std::optional<Sides> sides_of(const std::string& text, std::string_view middle) {
  const std::size_t place = text.find(middle);
  if (place == std::string::npos) return std::nullopt;
  return Sides{text.substr(0, place), text.substr(place + middle.size())};
}

}  // namespace

std::string refused_words(const std::string& command, const std::string& said) {
  const std::string beginning = command + ": ", help = "; " + command + " --help says what it takes";
  if (said == "A subcommand is required") return beginning + "a command is required; " + command + " --help lists them";
  if (said.ends_with(" is required")) return beginning + said + help;
  if (const auto sides = sides_of(said, "not expected: ")) return beginning + "found '" + sides->behind + "', expected no word more" + help;
  if (const auto sides = sides_of(said, " excludes ")) return beginning + "found " + sides->before + " beside " + sides->behind + ", expected one of the two";
  if (const auto sides = sides_of(said, " requires ")) return beginning + "found " + sides->before + " without " + sides->behind + ", expected both or neither";
  if (const auto sides = sides_of(said, ": 1 required "); sides && said.ends_with(" missing")) {
    return beginning + sides->before + ": found nothing behind it, expected a value";
  }
  if (said.starts_with("Could not convert: ")) {
    if (const auto sides = sides_of(said.substr(said.find(": ") + 2), " = ")) {
      return beginning + sides->before + ": found '" + sides->behind + "', expected a value of another kind" + help;
    }
  }
  return beginning + said;
}

}  // namespace slewlab::common
