#include "tools/campaign/study.h"

#include <algorithm>
#include <array>
#include <utility>

#include "controller/controller_file.h"
#include "sim/drive/scenario_file.h"
#include "sim/machine/machine_file.h"
#include "tools/acceptance/limits.h"
#include "tools/soak/settings.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::Override;
using common::YamlNode;
using common::YamlReader;

constexpr int kMostRuns = 1'000'000;
constexpr int kLargestSeed = 1'000'000'000;
constexpr double kLowestRate = 1.0, kHighestRate = 1000.0;  // [Hz] less records nothing of a slew; the base step of withheld cases is 1 ms
constexpr std::array<std::pair<Spread, const char*>, 4> kSpreads{
    {{Spread::values, "values"}, {Spread::range, "range"}, {Spread::log_range, "log_range"}, {Spread::normal, "normal"}}};
constexpr const char* kForm = "{value: [...], unit: ..., source: ...}";

// {value: [...], unit, source}: the unit is the key's own affair, and judged where a scenario reads it.
void read_values(YamlReader& reader, const char* name, VariedKey& varied) {
  const YamlNode* node = reader.raw(name);
  if (node == nullptr) return;
  if (node->kind != YamlNode::Kind::map) return reader.report(name, common::excerpt(*node), kForm);
  for (const common::YamlEntry& part : node->entries) {
    if (part.key != "value" && part.key != "unit" && part.key != "source") return reader.report(name, "the unknown key '" + part.key + "'", kForm);
  }
  const YamlNode *value = node->find("value"), *unit = node->find("unit"), *source = node->find("source");
  if (value == nullptr || value->kind != YamlNode::Kind::sequence || value->items.empty()) {
    return reader.report(name, value == nullptr ? "no 'value'" : common::excerpt(*value), "a list of values");
  }
  if (source == nullptr || source->kind != YamlNode::Kind::scalar || source->scalar.empty()) {
    reader.report(name, common::excerpt(*value) + " without a source", "source: where the values are from, or \"chosen: why\"");
  }
  if (unit != nullptr) varied.unit = unit->scalar;
  for (const YamlNode& item : value->items) {
    if (item.kind != YamlNode::Kind::scalar) return reader.report(name, common::excerpt(item), "a number or a word");
    varied.values.push_back(item.scalar);
  }
}

void check_values(YamlReader& reader, const char* name, const VariedKey& varied) {
  if (varied.spread == Spread::values || varied.values.empty()) return;
  const char* meaning = varied.spread == Spread::normal ? "mean and standard deviation, two numbers" : "lowest and highest, two numbers";
  double first = 0.0, second = 0.0;
  if (varied.values.size() != 2 || !common::parse_number(varied.values[0], first) || !common::parse_number(varied.values[1], second)) {
    return reader.report(name, "something else", meaning);
  }
  const std::string found = varied.values[0] + ", " + varied.values[1];
  if (varied.spread == Spread::normal && !(second > 0.0)) reader.report(name, found, "a standard deviation above 0");
  if (varied.spread != Spread::normal && !(first < second)) reader.report(name, found, "a lowest value below the highest");
  if (varied.spread == Spread::log_range && !(first > 0.0)) reader.report(name, found, "values above 0 for a logarithmic range");
}

VariedKey read_varied(YamlReader& reader, Draw draw, const std::vector<VariedKey>& before) {
  VariedKey varied;
  varied.key = reader.text("key");
  const bool twice = std::any_of(before.begin(), before.end(), [&](const VariedKey& other) { return other.key == varied.key; });
  if (twice) reader.report("key", varied.key + " a second time", "each key once");
  int given = 0;
  for (const auto& [spread, name] : kSpreads) {
    if (!reader.has(name)) continue;
    ++given;
    varied.spread = spread;
    varied.values.clear();
    read_values(reader, name, varied);
    check_values(reader, name, varied);
    if (draw == Draw::grid && spread != Spread::values) reader.report(name, "a range", "values: a grid has one run for each");
  }
  if (given != 1) reader.report("key", std::to_string(given) + " of values, range, log_range, normal", "one of them");
  if (reader.has("whole")) varied.whole = reader.flag("whole");
  reader.finish();
  return varied;
}

// Values that a scenario takes: the first of each key, which shows whether key and unit are right.
std::vector<Override> first_values(const Study& study) {
  std::vector<Override> changes;
  for (const VariedKey& varied : study.vary) {
    if (!varied.values.empty()) changes.push_back({varied.key, value_text(varied, varied.values.front())});
  }
  return changes;
}

// What a scenario says of a value that comes from here is told at its line here.
void check_scenarios(const Study& study, const YamlNode& root, InputProblems& problems) {
  const YamlNode* vary = root.find("vary");
  for (const std::filesystem::path& file : study.scenarios) {
    InputProblems found;
    try {
      sim::read_scenario_file(file, first_values(study), found);
    } catch (const InputError& error) {
      found = error.problems();
    }
    for (common::InputProblem& problem : found) {
      if (problem.where.line == 0) {
        for (std::size_t i = 0; vary != nullptr && i < study.vary.size() && i < vary->items.size(); ++i) {
          const std::string& key = study.vary[i].key;
          const bool meant = problem.where.file.text().find(key) != std::string::npos || key.ends_with(problem.key);
          if (meant && !key.empty()) problem.where = vary->items[i].mark;
        }
      }
      problems.push_back(std::move(problem));
    }
  }
}

}  // namespace

std::string_view name_of(Draw draw) {
  switch (draw) {
    case Draw::grid: return "grid";
    case Draw::random: return "random";
    case Draw::latin_hypercube: return "latin_hypercube";
  }
  return "";
}

std::string_view name_of(Spread spread) {
  for (const auto& [known, name] : kSpreads) {
    if (known == spread) return name;
  }
  return "";
}

std::string value_text(const VariedKey& varied, const std::string& value) {
  return varied.unit == "-" ? value : value + ' ' + varied.unit;
}

namespace {

SoakOfStudy read_soak(YamlReader reader) {
  SoakOfStudy soak;
  soak.settings = reader.file("settings");
  soak.crane = reader.file("crane");
  soak.controller = reader.file("controller");
  soak.faults = reader.flag("faults");
  reader.finish();
  return soak;
}

WithheldOfStudy read_withheld(YamlReader reader) {
  WithheldOfStudy withheld;
  withheld.crane = reader.file("crane");
  withheld.controller = reader.file("controller");
  if (reader.has("rate")) withheld.rate = reader.number("rate", common::Unit::hertz, common::between(kLowestRate, kHighestRate));
  if (reader.has("sensors")) withheld.sensors = std::array{"all", "tip", "none"}[reader.choice("sensors", {"all", "tip", "none"})];
  if (reader.has("begin")) withheld.begin = std::array{"rest", "on", "motion", "any"}[reader.choice("begin", {"rest", "on", "motion", "any"})];
  reader.finish();
  return withheld;
}

}  // namespace

void read_study(YamlReader& reader, Study& study) {
  reader.heading("campaign");
  if (reader.has("soak")) study.soak = read_soak(reader.map("soak"));
  if (reader.has("withheld")) study.withheld = read_withheld(reader.map("withheld"));
  if (study.soak && study.withheld) reader.report("withheld", "cases beside the tasks of a soak", "one of scenarios, soak and withheld");
  if (study.soak || study.withheld) {
    study.draw = Draw::random;
    study.runs = reader.integer("runs", 1, kMostRuns);
    study.seed = reader.integer("seed", 0, kLargestSeed);
    return;
  }
  reader.each("scenarios", [&](YamlReader& each) {
    study.scenarios.push_back(each.file("file"));
    each.finish();
  });
  if (study.scenarios.empty()) reader.report("scenarios", "none", "at least one: [{file: SCENARIO.yaml}]");
  if (reader.has("limits")) study.limits = reader.file("limits");
  study.draw = std::array{Draw::grid, Draw::random, Draw::latin_hypercube}[reader.choice("draw", {"grid", "random", "latin_hypercube"})];
  if (study.draw != Draw::grid) {
    study.runs = reader.integer("runs", 1, kMostRuns);
    study.seed = reader.integer("seed", 0, kLargestSeed);
  }
  reader.each("vary", [&](YamlReader& each) { study.vary.push_back(read_varied(each, study.draw, study.vary)); });
  if (study.draw != Draw::grid && study.vary.empty()) reader.report("vary", "nothing", "at least one key to draw");
}

Study read_study_file(const std::filesystem::path& file, const std::vector<Override>& overrides, InputProblems& problems) {
  Study study;
  const YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != YamlNode::Kind::map) return study;
  YamlReader reader(root, "", problems);
  read_study(reader, study);
  reader.finish();
  if (!problems.empty()) return study;
  check_scenarios(study, root, problems);
  const auto check = [&](const std::filesystem::path& named, const auto& load) {
    if (named.empty()) return;
    try {
      load(named);
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  };
  check(study.limits, [](const auto& path) { load_acceptance_limits(path); });
  if (study.soak) {
    check(study.soak->settings, [](const auto& path) { load_soak_settings(path); });
    check(study.soak->crane, [](const auto& path) { sim::load_machine_file(path); });
    check(study.soak->controller, [](const auto& path) { controller::load_controller_file(path); });
  }
  if (study.withheld) {
    check(study.withheld->crane, [](const auto& path) { sim::load_machine_file(path); });
    check(study.withheld->controller, [](const auto& path) { controller::load_controller_file(path); });
  }
  return study;
}

Study load_study_file(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  InputProblems problems;
  Study study = read_study_file(file, overrides, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  return study;
}

}  // namespace slewlab::tools
