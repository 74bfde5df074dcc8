#include "tools/acceptance/plan.h"

#include <algorithm>
#include <utility>

#include "common/near_name.h"
#include "common/yaml_file.h"
#include "sim/drive/scenario_file.h"
#include "tools/acceptance/checks.h"
#include "tools/acceptance/limits.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::YamlNode;
using common::YamlReader;

template <class Entry>
std::vector<std::string> names_of(const std::vector<Entry>& entries) {
  std::vector<std::string> names;
  for (const Entry& entry : entries) names.push_back(entry.name);
  return names;
}

bool is_among(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// A name that is used as a folder's and in a table: no slashes, no blanks.
std::string read_name(YamlReader& reader, const std::vector<std::string>& before) {
  std::string name = reader.text("name");
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  if (name.find_first_not_of(kLetters) != std::string::npos || name.starts_with('.')) {
    reader.report("name", name, "letters, digits, _, - and . alone");
  } else if (!name.empty() && is_among(name, before)) {
    reader.report("name", name + " a second time", "each name once");
  }
  return name;
}

std::vector<ShownBy> read_shown_by(YamlReader& reader, const std::vector<std::string>& tests) {
  std::vector<ShownBy> shown_by;
  reader.each("shown_by", [&](YamlReader& each) {
    ShownBy one{each.text("test"), each.text("check")};
    if (!one.test.empty() && !is_among(one.test, tests)) each.report("test", one.test, common::known_names_text(one.test, tests));
    if (!one.check.empty() && !is_among(one.check, acceptance_check_names())) {
      each.report("check", one.check, common::known_names_text(one.check, acceptance_check_names()));
    }
    each.finish();
    shown_by.push_back(std::move(one));
  });
  if (shown_by.empty()) reader.report("shown_by", "nothing", "at least one {test: ..., check: ...}");
  return shown_by;
}

}  // namespace

AcceptancePlan read_acceptance_plan(YamlReader& reader) {
  AcceptancePlan plan;
  reader.heading("acceptance_plan");
  plan.title = reader.text("title");
  plan.system = reader.text("system");
  plan.limits = reader.file("limits");
  reader.each("tests", [&](YamlReader& each) {
    PlannedTest test;
    test.name = read_name(each, names_of(plan.tests));
    test.purpose = each.text("purpose");
    test.scenario = each.file("scenario");
    each.finish();
    plan.tests.push_back(std::move(test));
  });
  if (plan.tests.empty()) reader.report("tests", "none", "at least one run to be made");
  reader.each("requirements", [&](YamlReader& each) {
    Requirement requirement;
    requirement.name = read_name(each, names_of(plan.requirements));
    requirement.text = each.text("text");
    requirement.source = each.text("source");
    requirement.shown_by = read_shown_by(each, names_of(plan.tests));
    each.finish();
    plan.requirements.push_back(std::move(requirement));
  });
  if (plan.requirements.empty()) reader.report("requirements", "none", "at least one");
  reader.each("deviations", [&](YamlReader& each) {
    Deviation deviation{each.text("requirement"), each.text("text"), each.text("agreed_by")};
    const std::vector<std::string> known = names_of(plan.requirements);
    if (!deviation.requirement.empty() && !is_among(deviation.requirement, known)) {
      each.report("requirement", deviation.requirement, common::known_names_text(deviation.requirement, known));
    }
    each.finish();
    plan.deviations.push_back(std::move(deviation));
  });
  return plan;
}

AcceptancePlan read_acceptance_plan_file(const std::filesystem::path& file, InputProblems& problems) {
  AcceptancePlan plan;
  const YamlNode root = common::load_yaml_file(file, {}, problems);
  if (root.kind != YamlNode::Kind::map) return plan;
  YamlReader reader(root, "", problems);
  plan = read_acceptance_plan(reader);
  reader.finish();
  if (!problems.empty()) return plan;
  const auto collect = [&](const auto& load) {
    try {
      load();
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  };
  collect([&] { load_acceptance_limits(plan.limits); });
  for (const PlannedTest& test : plan.tests) {
    collect([&] { sim::load_scenario_file(test.scenario); });
  }
  return plan;
}

AcceptancePlan load_acceptance_plan(const std::filesystem::path& file) {
  InputProblems problems;
  AcceptancePlan plan = read_acceptance_plan_file(file, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  return plan;
}

}  // namespace slewlab::tools
