#include "tools/commands/check_command.h"

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>

#include "common/effect.h"
#include "common/near_name.h"
#include "common/readable_number.h"
#include "common/yaml_reader.h"
#include "controller/controller_file.h"
#include "sim/drive/run_cost.h"
#include "sim/drive/scenario_file.h"
#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "sim/machine/machine_file.h"
#include "sim/machine/plausibility.h"
#include "tools/acceptance/limits.h"
#include "tools/acceptance/plan.h"
#include "tools/campaign/study.h"
#include "tools/plc/plc_map.h"
#include "tools/soak/settings.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::YamlNode;

const std::vector<std::string>& known_kinds() {
  static const std::vector<std::string> kKinds{"crane",           "axis",     "controller", "scenario",   "acceptance",
                                               "acceptance_plan", "campaign", "soak",       "import_map", "plc_map"};
  return kKinds;
}

// Where the scenario names its controller, for problems that lie between two files.
common::SourceMark mark_of(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                           std::string_view key) {
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  const YamlNode* node = root.find(key);
  return node == nullptr ? root.mark : node->mark;
}

// The node at a key path, or the nearest one above it that there is: a value may lie in an included file.
common::SourceMark mark_at(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  common::SourceMark mark = root.mark;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    node = node->find(path.substr(0, dot));
    if (node == nullptr) break;
    mark = node->mark;
    path = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
  }
  return mark;
}

std::string place_text(const common::SourceMark& mark) {
  std::string text = mark.file.text();
  if (mark.line > 0) text += ':' + std::to_string(mark.line) + ':' + std::to_string(mark.column);
  return text + ": ";
}

// What is possible and yet unlikely of a machine that is read already.
void weigh_machine(const sim::MachineFile& machine, const std::filesystem::path& file,
                 const std::vector<common::Override>& overrides, const sim::RunPeriods& periods, std::vector<std::string>& warnings) {
  const std::vector<sim::ImplausibleValue> values = sim::implausible_values(machine, periods);
  if (values.empty()) return;
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  for (const sim::ImplausibleValue& value : values) {
    const common::SourceMark mark = mark_at(root, value.key);
    const std::string key = as_given({{mark, value.key, "", ""}}, overrides).front().key;
    warnings.push_back(place_text(mark) + "warning: key '" + key + "': " + value.found + "; usual: " + value.usual);
  }
}

void weigh_cost(const sim::Scenario& scenario, const std::filesystem::path& file, std::vector<std::string>& warnings) {
  constexpr double kWorthTelling = 60.0;  // [s]
  const sim::RunCost cost = sim::run_cost(scenario);
  if (cost.seconds < kWorthTelling) return;
  warnings.push_back(file.string() + ": warning: " + text_of(cost) + " of computing in lockstep, with a plant_step of " +
                     common::shortest(static_cast<double>(scenario.plant_step) * 1e-6) + " ms and " +
                     std::to_string(scenario.crane.parameters.boom.element_count) + " boom elements");
}

// What begins when the run is over.
void weigh_times(const sim::Scenario& scenario, const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                 std::vector<std::string>& warnings) {
  struct List {
    const char *name, *time;
  };
  constexpr std::array kLists{List{"operator", "time"}, List{"effect_switches", "time"}, List{"faults", "from"}};
  const double duration = static_cast<double>(scenario.duration) * 1e-9;  // [s]
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  for (const List& list : kLists) {
    const YamlNode* entries = root.find(list.name);
    for (std::size_t i = 0; entries != nullptr && i < entries->items.size(); ++i) {
      const YamlNode* entry = entries->items[i].find(list.time);
      if (entry == nullptr) continue;
      common::YamlReader reader(entries->items[i], "", ignored);
      const double time = reader.number(list.time, common::Unit::second, common::any_number());
      if (time < duration) continue;
      warnings.push_back(place_text(entry->mark) + "warning: key '" + list.name + '.' + std::to_string(i) + '.' + list.time + "': " + common::readable(time) +
                         " s, when the run is over: it lasts " + common::readable(duration) + " s");
    }
  }
}

// What a run would refuse of the crane's effects, said where the user wrote them.
std::vector<common::EffectInstance> check_effects(const sim::MachineFile& crane, InputProblems& problems) {
  return common::read_effects(crane.effects, sim::effects_for(crane), problems);
}

// Names alone, of a machine whose other values are wrong: what bounds an effect is not known then.
void check_effect_names(const std::filesystem::path& file, const std::vector<common::Override>& overrides, InputProblems& problems) {
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  const YamlNode* effects = root.find("effects");
  if (effects == nullptr) return;
  common::EffectCatalogue all;
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) all.effects.push_back(effect->about);
  for (std::size_t i = 0; i < effects->items.size(); ++i) {
    const YamlNode* name = effects->items[i].find("effect");
    if (name == nullptr || name->kind != YamlNode::Kind::scalar || all.find(name->scalar) != nullptr) continue;
    problems.push_back({name->mark, "effects." + std::to_string(i) + ".effect", name->scalar, common::expected_effect_name(all, name->scalar)});
  }
}

// Whether parameters that are good one by one make a machine; a boom of so many elements takes milliseconds to assemble.
void check_machine(const sim::MachineFile& crane, double plant_step, const sim::MotionRequests& requests, const std::filesystem::path& file,
                   InputProblems& problems) {
  constexpr int kMostElements = 64;
  const std::vector<common::EffectInstance> effects = check_effects(crane, problems);
  if (!problems.empty() || crane.parameters.boom.element_count > kMostElements) return;
  try {
    sim::MachineSettings settings;
    settings.crane = crane.parameters;
    settings.drive_protection = crane.drive_protection;
    settings.effects = effects;
    settings.step = plant_step;
    settings.motion_requests = requests;
    sim::make_machine(settings);
  } catch (const std::invalid_argument& error) {
    const bool by_effect = !effects.empty();
    problems.push_back({by_effect ? crane.effects.mark : common::SourceMark{file.string(), 0, 0}, by_effect ? "effects" : "",
                        std::string("a machine that cannot be built (") + error.what() + ")", "values that fit each other"});
  }
}

void check_machine_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides, FileFindings& found) {
  sim::MachineFile crane;
  try {
    crane = sim::load_machine_file(file, overrides);
  } catch (const InputError& error) {
    found.problems = error.problems();
    return check_effect_names(file, overrides, found.problems);
  }
  check_machine(crane, sim::MachineSettings{}.step, {}, file, found.problems);
  if (found.problems.empty()) weigh_machine(crane, file, overrides, {}, found.warnings);
}

void check_scenario(const std::filesystem::path& file, const std::vector<common::Override>& overrides, ControllerBy by,
                    FileFindings& found) {
  InputProblems& problems = found.problems;
  const sim::Scenario scenario = sim::read_scenario_file(file, overrides, problems);
  const bool whole = problems.empty();
  if (whole) {
    const double plant_step = static_cast<double>(scenario.plant_step) * 1e-9;  // [s]
    check_machine(scenario.crane, plant_step, scenario.motion_requests, scenario.crane_file, problems);
    weigh_machine(scenario.crane, scenario.crane_file, scenario.crane_overrides, {plant_step, scenario.controller_period}, found.warnings);
    weigh_cost(scenario, file, found.warnings);
    std::vector<common::Override> own = overrides;
    for (const char* way : {"crane.", "axis.", "controller."}) common::take_overrides(way, own);
    weigh_times(scenario, file, own, found.warnings);
  } else if (scenario.crane.canonical_text.empty()) {  // it could not be read
    check_effect_names(scenario.crane_file, scenario.crane_overrides, problems);
  } else {
    try {
      check_effects(scenario.crane, problems);
    } catch (const std::invalid_argument&) {
      // The machine's own values, told already, give no scales to bound an effect by.
    }
  }
  problems = as_given(std::move(problems), scenario.crane_overrides);
  if (by == ControllerBy::user || !std::filesystem::exists(scenario.controller_file)) return;  // that it is not there is told
  try {
    const controller::ControllerSettings settings =
        controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
    const int crane_groups = scenario.crane.parameters.drive.group_count;
    if (whole && settings.group_count != crane_groups) {
      problems.push_back({mark_of(file, overrides, "controller"), "controller",
                          "a controller for " + std::to_string(settings.group_count) + " motor group(s)",
                          "one for the " + std::string(sim::name_of(scenario.crane.kind)) + "'s " + std::to_string(crane_groups)});
    }
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
}

// The node below `kind:`; nothing after a problem.
std::optional<YamlNode> kind_of(const std::filesystem::path& file, InputProblems& problems) {
  const YamlNode root = common::load_yaml_file(file, {}, problems);
  if (const YamlNode* kind = root.find("kind")) return *kind;
  const auto mistyped = std::find_if(root.entries.begin(), root.entries.end(), [](const common::YamlEntry& entry) { return common::nearest_name(entry.key, {"kind"}).has_value(); });
  if (problems.empty() && mistyped != root.entries.end()) {
    problems.push_back({mistyped->mark, mistyped->key, "a key that is not known here", "'kind'"});
  } else if (problems.empty()) {
    problems.push_back({root.mark, "kind", "nothing: the key is missing", common::known_names_text("", known_kinds())});
  }
  return std::nullopt;
}

}  // namespace

FileFindings examine(const std::filesystem::path& file, const std::vector<common::Override>& overrides, ControllerBy by) {
  FileFindings found;
  const std::optional<YamlNode> kind = kind_of(file, found.problems);
  if (!kind) return found;
  found.problems.clear();
  try {
    if (kind->scalar == "crane" || kind->scalar == "axis") {
      check_machine_file(file, overrides, found);
    } else if (kind->scalar == "controller") {
      controller::load_controller_file(file, overrides);
    } else if (kind->scalar == "scenario") {
      check_scenario(file, overrides, by, found);
    } else if (kind->scalar == "plc_map") {
      load_plc_map(file);
    } else if (kind->scalar == "acceptance") {
      load_acceptance_limits(file, overrides);
    } else if (kind->scalar == "soak") {
      load_soak_settings(file, overrides);
    } else if (kind->scalar == "acceptance_plan") {
      read_acceptance_plan_file(file, found.problems);
    } else if (kind->scalar == "campaign") {
      read_study_file(file, overrides, found.problems);
    } else {
      found.problems.push_back({kind->mark, "kind", common::excerpt(*kind), common::known_names_text(kind->scalar, known_kinds())});
    }
  } catch (const InputError& error) {
    found.problems = error.problems();
  }
  return found;
}

common::InputProblems problems_of_another_kind(const std::filesystem::path& file, const std::string& wanted) {
  InputProblems ignored;
  const std::optional<YamlNode> kind = kind_of(file, ignored);
  if (!kind || kind->scalar == wanted) return {};
  return {{kind->mark, "kind", common::excerpt(*kind), wanted}};
}

std::string kind_in(const std::filesystem::path& file) {
  InputProblems ignored;
  const std::optional<YamlNode> kind = kind_of(file, ignored);
  return kind ? kind->scalar : std::string();
}

void complain(const InputProblems& problems, std::ostream& complaints) {
  constexpr std::size_t kMost = 100;  // nobody reads on; the first ones are told
  for (std::size_t i = 0; i < std::min(kMost, problems.size()); ++i) complaints << common::to_text(problems[i]) << '\n';
  if (problems.size() > kMost) complaints << "and " << problems.size() - kMost << " more problems\n";
}

void warn(const std::vector<std::string>& warnings, std::ostream& complaints) {
  for (const std::string& warning : warnings) complaints << warning << '\n';
}

namespace {

// What the templates of `slewlab new` say where a user's own words belong.
constexpr std::string_view kTemplateSource = "replace by your own", kTemplateDescription = "replace by what";

// Sources that are a template's still: how many, and the first.
struct Unreplaced {
  std::size_t count = 0;
  YamlNode first{};
};

void find_unreplaced(const YamlNode& node, Unreplaced& found) {
  for (const common::YamlEntry& entry : node.entries) {
    if (entry.key == "source" && entry.value.scalar.find(kTemplateSource) != std::string::npos && found.count++ == 0) found.first = entry.value;
    find_unreplaced(entry.value, found);
  }
  for (const YamlNode& item : node.items) find_unreplaced(item, found);
}

std::vector<std::string> remarks_on_template(const std::filesystem::path& file) {
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, {}, ignored);
  std::vector<std::string> remarks;
  const YamlNode* description = root.find("description");
  if (description != nullptr && description->scalar.starts_with(kTemplateDescription)) {
    remarks.push_back(place_text(description->mark) + "warning: key 'description': still the template's, '" + description->scalar + "'");
  }
  Unreplaced found;
  find_unreplaced(root, found);
  if (found.count > 0) {
    remarks.push_back(place_text(found.first.mark) + "warning: " + (found.count == 1 ? "a value has" : std::to_string(found.count) + " values have") +
                      " the template's source still, '" + found.first.scalar + "'" + (found.count == 1 ? "" : "; here is the first"));
  }
  return remarks;
}

}  // namespace

int check_files(const std::vector<std::filesystem::path>& files,
                const std::vector<common::Override>& overrides, std::ostream& out, std::ostream& complaints) {
  int exit_code = 0;
  for (const std::filesystem::path& file : files) {
    const FileFindings found = examine(file, overrides);
    if (found.problems.empty()) {
      warn(found.warnings, complaints);
      warn(remarks_on_template(file), complaints);
      out << file.string() << ": OK\n";
      continue;
    }
    exit_code = 1;
    complain(found.problems, complaints);
  }
  return exit_code;
}

}  // namespace slewlab::tools
