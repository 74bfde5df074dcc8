#include "common/number_and_unit.h"

#include <algorithm>

#include "common/yaml_node.h"

namespace slewlab::common {

std::optional<NumberAndUnit> number_and_unit(std::string_view text) {
  NumberAndUnit parts;
  parts.digits = text.substr(0, std::min(text.find_first_not_of("+-.0123456789eE"), text.size()));
  if (!parse_number(parts.digits, parts.number)) return std::nullopt;
  const std::size_t unit = text.find_first_not_of(' ', parts.digits.size());
  if (unit != std::string_view::npos) parts.unit = text.substr(unit);
  return parts;
}

}  // namespace slewlab::common
