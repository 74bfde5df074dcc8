#include <nanobind/eigen/dense.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>

#include "common/near_name.h"
#include "common/unit.h"
#include "sim/analysis/eigen.h"
#include "sim/analysis/state_space.h"
#include "sim/machine/machine_file.h"
#include "sim/model/drive_line.h"
#include "tools/commands/check_command.h"
#include "tools/commands/run_facts.h"
#include "tools/commands/version.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

// A machine's file with what was changed in it.
struct Machine {
  Machine(const std::filesystem::path& path, const Changes& made)
      : file(path), changes(made), machine(sim::load_machine_file(path, overrides_of(made))) {}

  std::filesystem::path file;
  Changes changes;
  sim::MachineFile machine;
};

// Key, text of the value, unit, source, file, line.
using FileValue = std::tuple<std::string, std::string, std::string, std::string, std::string, int>;

std::string text_of(const common::YamlNode& node) {
  if (node.kind != common::YamlNode::Kind::sequence) return node.scalar;
  std::string text;
  for (const common::YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + item.scalar;
  return '[' + text + ']';
}

void collect_values(const common::YamlNode& node, const std::string& path, std::vector<FileValue>& values) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + '.' + name; };
  if (common::is_sourced_value(node)) {
    const common::YamlNode *unit = node.find("unit"), *source = node.find("source"), *value = node.find("value");
    if (value == nullptr) return;
    values.emplace_back(path, text_of(*value), unit == nullptr ? "" : unit->scalar, source == nullptr ? "" : source->scalar,
                        node.mark.file.text(), node.mark.line);
    return;
  }
  for (const common::YamlEntry& entry : node.entries) collect_values(entry.value, below(entry.key), values);
  for (std::size_t i = 0; i < node.items.size(); ++i) collect_values(node.items[i], below(std::to_string(i)), values);
}

// Every value with its unit and source of a file of any kind, includes laid under it, changes over it.
std::vector<FileValue> file_values(const std::filesystem::path& file, const Changes& changes) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides_of(changes), problems);
  if (!problems.empty()) throw common::InputError(problems);
  std::vector<FileValue> values;
  collect_values(root, "", values);
  return values;
}

// What `slewlab check` says: problems, warnings.
std::pair<std::vector<std::string>, std::vector<std::string>> check(const std::filesystem::path& file, const Changes& changes) {
  const FileFindings found = examine(file, overrides_of(changes));
  std::vector<std::string> problems;
  for (const common::InputProblem& problem : found.problems) problems.push_back(common::to_text(problem));
  return {problems, found.warnings};
}

double factor(const std::string& unit, const std::string& to) {
  const std::optional<common::Unit> known = common::unit_of(to);
  if (!known) throw nb::value_error(("'" + to + "' is no unit that is known here").c_str());
  const std::optional<double> from = common::factor_to_si(*known, unit);
  if (!from) throw nb::value_error(("'" + unit + "' is no unit of this quantity, expected one of " + common::spellings_of(*known)).c_str());
  return *from / *common::factor_to_si(*known, to);
}

// [Hz] What the solution leaves of a rigid mode's zero is rounding.
double shown_frequency(const sim::Mode& mode) { return mode.kind == sim::ModeKind::kRigid ? 0.0 : mode.frequency; }

sim::GearState gears_of(bool closed) { return closed ? sim::GearState::kClosed : sim::GearState::kOpen; }

sim::CraneParameters meshed(const Machine& machine, std::optional<int> elements) {
  sim::CraneParameters crane = machine.machine.parameters;
  if (elements) {
    if (crane.boom.length == 0.0) throw nb::value_error("the machine has no boom that elements could be given to");
    // Rounding grows with the fourth power of the elements: at 200 it moves the slowest mode's frequency by a millionth, at 1000 by a thousandth.
    constexpr int kMostElements = 200;
    if (*elements < 0 || *elements > kMostElements) {
      throw nb::value_error(("found " + std::to_string(*elements) + " elements, expected 0 (a rigid boom) to " + std::to_string(kMostElements) +
                             ": rounding spoils the slow modes of finer meshes").c_str());
    }
    crane.boom.element_count = *elements;
  }
  return crane;
}

std::vector<std::pair<std::string, std::string>> names_of(const std::vector<sim::NamedSignal>& signals) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const sim::NamedSignal& signal : signals) names.emplace_back(signal.name, signal.unit);
  return names;
}

}  // namespace

void bind_machine(nb::module_& m) {
  m.def("version_text", &version_text, "Versions of slewlab, LCM and SUNDIALS, a line each.");
  m.def("known_names_text", &common::known_names_text, nb::arg("name"), nb::arg("known"),
        "What to expect instead of an unknown name: the near one first.");
  m.def("factor", &factor, nb::arg("unit"), nb::arg("to"), "What a number in `unit` is multiplied by to be one in `to`.");
  m.def("check", &check, nb::arg("path"), nb::arg("changes"), "(problems, warnings) of a file, as of `slewlab check`.");
  m.def("file_values", &file_values, nb::arg("path"), nb::arg("changes"),
        "[(key, value, unit, source, file, line)] of a file, with what it includes and what is changed.");

  nb::class_<sim::Mode>(m, "Mode", "An undamped mode of the linear machine.")
      .def_prop_ro("frequency", &shown_frequency, "[Hz]")
      .def_ro("damping_ratio", &sim::Mode::damping_ratio, "[-] share of critical damping")
      .def_prop_ro("kind", [](const sim::Mode& mode) { return std::string(sim::name_of(mode.kind)); },
                   "rigid, load, drive, bending or torsion")
      .def_ro("count", &sim::Mode::count, "counts from 1 within its kind")
      .def_prop_ro("gear_energy", [](const sim::Mode& mode) { return mode.energy.gear; }, "[-] share of the elastic energy in the gears")
      .def_prop_ro("load_energy", [](const sim::Mode& mode) { return mode.energy.load; }, "[-] share in the swing of the load")
      .def_prop_ro("boom_energy", [](const sim::Mode& mode) { return mode.energy.boom; }, "[-] share in the boom")
      .def("__repr__", [](const sim::Mode& mode) {
        return "<Mode " + std::string(sim::name_of(mode.kind)) + " " + std::to_string(mode.count) + ", " + std::to_string(shown_frequency(mode)) + " Hz>";
      });

  nb::class_<sim::StateSpace>(m, "StateSpaceMatrices")
      .def_ro("a", &sim::StateSpace::a)
      .def_ro("b", &sim::StateSpace::b)
      .def_ro("c", &sim::StateSpace::c)
      .def_ro("d", &sim::StateSpace::d)
      .def_prop_ro("states", [](const sim::StateSpace& s) { return names_of(s.states); })
      .def_prop_ro("inputs", [](const sim::StateSpace& s) { return names_of(s.inputs); })
      .def_prop_ro("outputs", [](const sim::StateSpace& s) { return names_of(s.outputs); });

  nb::class_<Machine>(m, "Machine")
      .def(nb::init<const std::filesystem::path&, const Changes&>(), nb::arg("path"), nb::arg("changes"))
      .def_ro("path", &Machine::file)
      .def_ro("changes", &Machine::changes)
      .def_prop_ro("kind", [](const Machine& machine) { return std::string(sim::name_of(machine.machine.kind)); })
      .def_prop_ro("is_linear", [](const Machine& machine) { return machine.machine.axis.is_linear; })
      .def_prop_ro("is_shaft_linear", [](const Machine& machine) { return machine.machine.axis.is_shaft_linear; })
      .def_prop_ro("has_load_encoder", [](const Machine& machine) { return machine.machine.parameters.house.has_encoder; })
      .def_prop_ro("group_count", [](const Machine& machine) { return machine.machine.parameters.drive.group_count; })
      .def_prop_ro("motors_per_group", [](const Machine& machine) { return machine.machine.parameters.drive.motors_per_group; })
      .def_prop_ro("total_ratio", [](const Machine& machine) { return sim::total_ratio(machine.machine.parameters.drive); })
      .def_prop_ro("rated_torque", [](const Machine& machine) { return machine.machine.parameters.drive.rated_torque; })
      .def_prop_ro("top_speed", [](const Machine& machine) { return machine.machine.parameters.drive.top_speed; })
      .def_prop_ro("facts", [](const Machine& machine) { return machine_facts(machine.machine).dump(); })
      .def("modes",
           [](const Machine& machine, bool closed, std::optional<int> elements) {
             return sim::crane_modes(meshed(machine, elements), gears_of(closed));
           },
           nb::arg("gears_closed"), nb::arg("elements").none())
      .def("state_space",
           [](const Machine& machine, bool closed, std::optional<int> elements) {
             return sim::state_space(meshed(machine, elements), gears_of(closed), machine.machine.axis.is_linear,
                                     machine.machine.axis.is_shaft_linear);
           },
           nb::arg("gears_closed"), nb::arg("elements").none());
}

}  // namespace slewlab::tools
