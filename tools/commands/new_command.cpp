#include "tools/commands/new_command.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <ostream>
#include <stdexcept>

#include "common/input_error.h"
#include "common/near_name.h"
#include "common/yaml_node.h"
#include "sim/machine/machine_file.h"
#include "sim/model/drive_line.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

[[noreturn]] void refuse(const std::string& where, std::string found, std::string expected) {
  throw common::InputError({{{where, 0, 0}, "", std::move(found), std::move(expected)}});
}

// The line of a key, with its indentation, gets another text; a value over several lines goes as a whole.
void replace_key(std::string& text, const std::string& key, const std::string& value) {
  const std::size_t begin = text.find('\n' + key + ':');
  if (begin == std::string::npos) throw std::logic_error("the template has no line '" + key + "'");
  const std::size_t indentation = key.find_first_not_of(' ');
  std::size_t end = text.find('\n', begin + 1);
  while (end + 1 < text.size()) {
    const std::size_t next = text.find_first_not_of(' ', end + 1);
    if (next == std::string::npos || next - end - 1 <= indentation || text[next] == '\n') break;
    end = text.find('\n', next);
  }
  text.replace(begin + 1, end - begin - 1, key + ": " + value);
}

std::string number(double value, common::Unit unit, const std::filesystem::path& machine) {
  return common::quantity_text(common::shortest(value), unit, "of " + machine.filename().string());
}

// What controller and machine have to have in common.
void fit_controller(std::string& text, const std::filesystem::path& file) {
  const sim::MachineFile machine = sim::load_machine_file(file);
  const sim::DriveParameters& drive = machine.parameters.drive;
  replace_key(text, "groups", number(drive.group_count, common::Unit::none, file));
  replace_key(text, "total_ratio", number(sim::total_ratio(drive), common::Unit::none, file));
  replace_key(text, "motor_torque_rated", number(drive.rated_torque, common::Unit::newton_metre, file));
  replace_key(text, "motor_torque_limit", number(drive.rated_torque, common::Unit::newton_metre, file));
  replace_key(text, "  top_speed", number(drive.top_speed, common::Unit::radian_per_second, file));
}

std::string seen_from(const std::filesystem::path& file, const std::filesystem::path& of) {
  return std::filesystem::proximate(file, std::filesystem::absolute(of).parent_path()).string();
}

}  // namespace

const std::vector<std::string>& new_kinds() {
  static const std::vector<std::string> kKinds{"crane", "axis", "controller", "scenario", "map"};
  return kKinds;
}

int write_new(const NewOptions& options, std::ostream& out) {
  const std::vector<std::string>& kinds = new_kinds();
  if (std::find(kinds.begin(), kinds.end(), options.kind) == kinds.end()) {
    refuse("KIND", "'" + options.kind + "'", common::known_names_text(options.kind, kinds));
  }
  const bool is_scenario = options.kind == "scenario";
  if (!options.machine.empty() && (options.kind == "crane" || options.kind == "axis")) {
    refuse("--" + options.kind, "a machine beside a new " + options.kind, "it beside a controller or a scenario");
  }
  if (!options.controller.empty() && !is_scenario) refuse("--controller", "a controller beside a new " + options.kind, "it beside a scenario");
  if (std::filesystem::exists(options.file)) refuse(options.file.string(), "a file that is there", "another name: nothing is overwritten");
  std::ifstream stream(options.templates / (options.kind + ".yaml"), std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + (options.templates / (options.kind + ".yaml")).string());
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (options.kind == "controller" && !options.machine.empty()) fit_controller(text, options.machine);
  if (is_scenario && !options.machine.empty()) {
    const sim::MachineFile machine = sim::load_machine_file(options.machine);
    replace_key(text, "crane", seen_from(options.machine, options.file));
    if (machine.kind == sim::MachineKind::axis) text.replace(text.find("\ncrane:") + 1, 5, "axis");
  }
  if (is_scenario && !options.controller.empty()) replace_key(text, "controller", seen_from(options.controller, options.file));
  if (options.file.has_parent_path()) make_output_folder(options.file.parent_path(), "FILE");
  write_whole_file(options.file, text);
  out << options.file.string() << ": written; fill it in, then: slewlab check " << options.file.string() << '\n';
  return 0;
}

}  // namespace slewlab::tools
