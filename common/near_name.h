// What a mistyped name was meant to be.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slewlab::common {

// The known name that differs from `name` least, where one is near enough to be meant: by a third of its letters, two of
// a short one, never all.
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

// What to expect instead of an unknown name: "'near' (or one of a, b, near)", "one of a, b".
std::string known_names_text(std::string_view name, const std::vector<std::string>& known);

}  // namespace slewlab::common
