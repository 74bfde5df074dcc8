#include "tools/campaign/study.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/effect.h"
#include "controller/controller_file.h"
#include "sim/drive/scenario_file.h"
#include "sim/effects/catalogue.h"
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

VariedKey read_varied(YamlReader& reader, bool is_grid, const std::vector<VariedKey>& before) {
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
    if (is_grid && spread != Spread::values) reader.report(name, "a range", "values: a grid has one run for each");
  }
  if (given != 1) reader.report("key", std::to_string(given) + " of values, range, log_range, normal", "one of them");
  if (reader.has("whole")) varied.whole = reader.flag("whole");
  reader.finish();
  return varied;
}

// What a study's values are tried on: a campaign has a row for each run that is refused, so that the first value of each key, which
// shows whether key and unit are right, is enough for it; a check tries all of them.
enum class Tried { first, all };

InputProblems problems_of(const std::filesystem::path& scenario_file, const std::vector<Override>& changes, Tried tried) {
  InputProblems found;
  const auto collect = [&](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      found.insert(found.end(), error.problems().begin(), error.problems().end());
    }
  };
  sim::Scenario scenario;
  collect([&] { scenario = sim::read_scenario_file(scenario_file, changes, found); });
  if (tried == Tried::first) return found;
  if (found.empty()) collect([&] { common::read_effects(scenario.crane.effects, sim::effects_for(scenario.crane), found); });
  found = common::as_given(std::move(found), scenario.crane_overrides);
  InputProblems ignored;
  const YamlNode root = std::filesystem::exists(scenario.controller_file) ? common::load_yaml_file(scenario.controller_file, {}, ignored) : YamlNode{};
  const YamlNode* kind = root.find("kind");
  if (kind != nullptr && kind->scalar == "controller") {  // one's own controller has settings that only it can read
    collect([&] { controller::load_controller_file(scenario.controller_file, scenario.controller_overrides); });
  }
  return found;
}

// Those of `found` that are not among `known`.
InputProblems new_among(const InputProblems& found, const InputProblems& known) {
  InputProblems result;
  for (const common::InputProblem& problem : found) {
    const auto is_same = [&](const common::InputProblem& other) { return other.key == problem.key && other.where.file == problem.where.file && other.where.line == problem.where.line; };
    if (std::none_of(known.begin(), known.end(), is_same)) result.push_back(problem);
  }
  return result;
}

// Where the value stands in the study, or the nearest place that there is.
common::SourceMark mark_of(const YamlNode& root, const Study& study, std::size_t key, std::size_t value) {
  const YamlNode* vary = root.find("vary");
  if (vary == nullptr || key >= vary->items.size()) return root.mark;
  const YamlNode* values = vary->items[key].find(name_of(study.vary[key].spread));
  const YamlNode* list = values == nullptr ? nullptr : values->find("value");
  return list == nullptr || value >= list->items.size() ? vary->items[key].mark : list->items[value].mark;
}

std::string option_beginning(const VariedKey& varied) { return "--set " + varied.key + "="; }

// What a scenario says of the first values, told at the key's entry here where it comes from here.
void tell_of_first(const Study& study, const YamlNode& root, InputProblems found, InputProblems& problems) {
  for (common::InputProblem& problem : found) {
    for (std::size_t i = 0; problem.where.line == 0 && i < study.vary.size(); ++i) {
      if (problem.where.file.text().starts_with(option_beginning(study.vary[i]))) problem.where = root.find("vary")->items.at(i).mark;
    }
    problems.push_back(std::move(problem));
  }
}

// What it says of another value, the rest being as it was.
void tell_of_value(const Study& study, const YamlNode& root, std::size_t key, std::size_t value, const InputProblems& found, InputProblems& problems) {
  const VariedKey& varied = study.vary[key];
  for (common::InputProblem problem : found) {
    if (!problem.where.file.text().starts_with(option_beginning(varied))) {
      problem.found = value_text(varied, varied.values[value]) + ", with which '" + problem.key + "' is " + problem.found;
    }
    problem.key = varied.key;
    problem.where = mark_of(root, study, key, value);
    problems.push_back(std::move(problem));
  }
}

void check_scenarios(const Study& study, const YamlNode& root, Tried tried, InputProblems& problems) {
  std::vector<Override> first;
  for (const VariedKey& varied : study.vary) {
    if (!varied.values.empty()) first.push_back({varied.key, value_text(varied, varied.values.front())});
  }
  for (const std::filesystem::path& file : study.scenarios) {
    const InputProblems of_first = problems_of(file, first, tried);
    tell_of_first(study, root, of_first, problems);
    for (std::size_t i = 0; tried == Tried::all && i < study.vary.size(); ++i) {
      const VariedKey& varied = study.vary[i];
      const std::size_t count = varied.spread == Spread::normal ? 1 : varied.values.size();  // a deviation is no value
      for (std::size_t k = 1; k < count; ++k) {
        std::vector<Override> changes = first;
        for (Override& change : changes) {
          if (change.key == varied.key) change.value = value_text(varied, varied.values[k]);
        }
        tell_of_value(study, root, i, k, new_among(problems_of(file, changes, tried), of_first), problems);
      }
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

namespace {

// Whether the value of {value, source} is the word.
bool is_word(YamlReader& reader, std::string_view key, std::string_view word) {
  const YamlNode* node = reader.raw(key);
  const YamlNode* value = node == nullptr ? nullptr : node->find("value");
  return value != nullptr && value->scalar == word;
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
  bool any_scenario = false;
  reader.each("scenarios", [&](YamlReader& each) {
    const std::filesystem::path file = each.file("file");
    if (!file.empty() && !std::filesystem::exists(file)) {
      each.report("file", "'" + file.string() + "', which is not there", "the name of a scenario's file");
    } else {
      study.scenarios.push_back(file);
    }
    any_scenario = true;
    each.finish();
  });
  if (!any_scenario) reader.report("scenarios", "none", "at least one: [{file: SCENARIO.yaml}]");
  if (reader.has("limits")) study.limits = reader.file("limits");
  study.draw = std::array{Draw::grid, Draw::random, Draw::latin_hypercube}[reader.choice("draw", {"grid", "random", "latin_hypercube"})];
  const bool is_grid = study.draw == Draw::grid && is_word(reader, "draw", "grid");
  for (const char* key : {"runs", "seed"}) {
    if (is_grid && reader.has(key)) reader.report(key, "it beside a grid", "no such key: a grid has one run for every combination of values");
  }
  if (study.draw != Draw::grid) {
    study.runs = reader.integer("runs", 1, kMostRuns);
    study.seed = reader.integer("seed", 0, kLargestSeed);
  } else if (!is_grid) {  // that there is no such draw is told
    reader.has("runs");
    reader.has("seed");
  }
  reader.each("vary", [&](YamlReader& each) { study.vary.push_back(read_varied(each, is_grid, study.vary)); });
  if (study.draw != Draw::grid && study.vary.empty()) reader.report("vary", "nothing", "at least one key to draw");
}

namespace {

Study read_and_try(const std::filesystem::path& file, const std::vector<Override>& overrides, Tried tried, InputProblems& problems) {
  Study study;
  const YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != YamlNode::Kind::map) return study;
  YamlReader reader(root, "", problems);
  read_study(reader, study);
  reader.finish();
  if (!problems.empty()) return study;
  check_scenarios(study, root, tried, problems);
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

}  // namespace

Study read_study_file(const std::filesystem::path& file, const std::vector<Override>& overrides, InputProblems& problems) {
  return read_and_try(file, overrides, Tried::all, problems);
}

Study load_study_file(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  InputProblems problems;
  Study study = read_and_try(file, overrides, Tried::first, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  return study;
}

}  // namespace slewlab::tools
