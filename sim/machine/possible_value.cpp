#include "sim/machine/possible_value.h"

#include <cmath>
#include <string>

#include "common/readable_number.h"

namespace slewlab::sim {
namespace {

void expect_possible(common::YamlReader& reader, std::string_view key, common::Unit unit, Possible possible, double value) {
  const double magnitude = std::fabs(value);
  if (value == 0.0 || (magnitude >= possible.least && magnitude <= possible.most)) return;
  const std::string name = unit == common::Unit::none ? "" : ' ' + std::string(common::name_of(unit));
  reader.report(key, common::readable(value) + name + ", which no machine has",
                "from " + common::shortest(possible.least) + " to " + common::shortest(possible.most) + name + (value < 0.0 ? ", or as much below 0" : ""));
}

}  // namespace

double sized(common::YamlReader& reader, std::string_view key, common::Unit unit, common::Range range, Possible possible) {
  const double value = reader.number(key, unit, range);
  expect_possible(reader, key, unit, possible, value);
  return value;
}

std::optional<double> optional_sized(common::YamlReader& reader, std::string_view key, common::Unit unit, common::Range range, Possible possible) {
  const std::optional<double> value = reader.optional_number(key, unit, range);
  if (value) expect_possible(reader, key, unit, possible, *value);
  return value;
}

}  // namespace slewlab::sim
