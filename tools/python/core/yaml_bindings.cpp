#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "common/number_and_unit.h"
#include "common/unit.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

// (kind, scalar, items, [(key, line, column, value)], file, line, column)
nb::tuple node_of(const common::YamlNode& node) {
  static constexpr const char* kKinds[] = {"null", "scalar", "sequence", "map"};
  nb::list items, entries;
  for (const common::YamlNode& item : node.items) items.append(node_of(item));
  for (const common::YamlEntry& entry : node.entries) {
    entries.append(nb::make_tuple(entry.key, entry.mark.line, entry.mark.column, node_of(entry.value)));
  }
  return nb::make_tuple(kKinds[static_cast<std::size_t>(node.kind)], node.scalar, items, entries, node.mark.file.text(), node.mark.line,
                        node.mark.column);
}

nb::tuple load_yaml(const std::filesystem::path& path) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(path, {}, problems);
  std::vector<std::string> lines;
  for (const common::InputProblem& problem : problems) lines.push_back(common::to_text(problem));
  return nb::make_tuple(node_of(root), lines);
}

// What a quantity may be given in; `unit` is any of its spellings.
std::vector<std::pair<std::string, double>> spellings(const std::string& unit) {
  const std::optional<common::Unit> known = common::unit_of(unit);
  if (!known) throw nb::value_error(("'" + unit + "' is no unit that is known here").c_str());
  std::vector<std::pair<std::string, double>> factors;
  const std::string all = common::spellings_of(*known);
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find(", ", begin), all.size());
    const std::string spelling = all.substr(begin, end - begin);
    factors.emplace_back(spelling, *common::factor_to_si(*known, spelling));
    begin = end + 2;
  }
  return factors;
}

std::optional<std::pair<double, std::string>> number_and_unit(const std::string& text) {
  const auto parts = common::number_and_unit(text);
  if (!parts) return std::nullopt;
  return std::pair{parts->number, std::string(parts->unit)};
}

}  // namespace

void bind_yaml(nb::module_& m) {
  m.def("load_yaml", &load_yaml, nb::arg("path"),
        "(root, problems): the tree of a file with what it includes, every node with its place, and what is wrong, a line each.");
  m.def("spellings", &spellings, nb::arg("unit"), "[(spelling, factor to SI)] of the quantity that a unit measures, the SI one first.");
  m.def("number_and_unit", &number_and_unit, nb::arg("text"), "(number, unit) of \"60 t\", the unit empty where none is there; None where it does not begin with a number.");
}

}  // namespace slewlab::tools
