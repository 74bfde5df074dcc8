#include "tools/acceptance/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slewlab::tools {
namespace {

using Json = nlohmann::ordered_json;

const CheckResult* find_check(const RecordedTest& test, const std::string& name) {
  const auto found = std::find_if(test.checks.begin(), test.checks.end(), [&](const CheckResult& check) { return check.name == name; });
  return found == test.checks.end() ? nullptr : &*found;
}

const Deviation* agreed_deviation(const AcceptancePlan& plan, const std::string& requirement) {
  const auto agreed = std::find_if(plan.deviations.begin(), plan.deviations.end(),
                                   [&](const Deviation& each) { return each.requirement == requirement; });
  return agreed == plan.deviations.end() ? nullptr : &*agreed;
}

TracedRequirement traced(const Requirement& requirement, const AcceptancePlan& plan, const std::vector<RecordedTest>& tests) {
  TracedRequirement result;
  result.requirement = requirement;
  result.state = RequirementState::met;
  for (const ShownBy& shown : requirement.shown_by) {
    const auto test = std::find_if(tests.begin(), tests.end(), [&](const RecordedTest& each) { return each.test.name == shown.test; });
    const CheckResult* check = test == tests.end() ? nullptr : find_check(*test, shown.check);
    if (check != nullptr && check->verdict == Verdict::pass) continue;
    const bool failed = check != nullptr && check->verdict == Verdict::fail;
    if (failed || result.state == RequirementState::met) result.state = failed ? RequirementState::not_met : RequirementState::not_shown;
    const std::string why = test == tests.end()         ? "the run was not made"
                            : check != nullptr          ? check->reason
                            : test->no_verdict.empty() ? "the limits do not ask for this check"
                                                        : "no verdict: " + test->no_verdict;
    result.reasons.push_back(shown.test + ", " + shown.check + ": " + why);
  }
  if (result.state != RequirementState::met) result.deviation = agreed_deviation(plan, requirement.name);
  return result;
}

bool shows(const Requirement& requirement, const std::string& test, const std::string& check) {
  return std::any_of(requirement.shown_by.begin(), requirement.shown_by.end(),
                     [&](const ShownBy& shown) { return shown.test == test && shown.check == check; });
}

// The agreed deviations of all requirements that a failed check shows, in words; empty where one of them has none, or it shows none.
std::string covering_deviations(const AcceptanceRecord& record, const std::string& test, const std::string& check) {
  std::string words;
  for (const TracedRequirement& each : record.requirements) {
    if (!shows(each.requirement, test, check)) continue;
    if (each.deviation == nullptr) return {};
    words += "; agreed deviation from " + each.requirement.name + ": " + each.deviation->text;
  }
  return words;
}

// The checks of a test as JUnit counts them: a failure that was agreed is none.
std::vector<CheckResult> counted_checks(const AcceptanceRecord& record, const RecordedTest& test) {
  std::vector<CheckResult> checks = test.checks;
  for (CheckResult& check : checks) {
    if (check.verdict != Verdict::fail) continue;
    const std::string agreed = covering_deviations(record, test.test.name, check.name);
    if (agreed.empty()) continue;
    check.verdict = Verdict::not_applicable;
    check.reason = "failed: " + check.reason + agreed;
  }
  return checks;
}

Json check_json(const CheckResult& check) {
  const bool has_number = std::isfinite(check.measured) && !check.unit.empty();
  return {{"name", check.name},
          {"verdict", verdict_name(check.verdict)},
          {"measured", has_number ? Json(check.measured) : Json(nullptr)},
          {"limit", check.unit.empty() ? Json(nullptr) : Json(check.limit)},
          {"unit", check.unit},
          {"time", check.time < 0.0 ? Json(nullptr) : Json(check.time)},
          {"reason", check.reason}};
}

}  // namespace

const char* requirement_state_name(RequirementState state) {
  switch (state) {
    case RequirementState::met: return "met";
    case RequirementState::not_met: return "not met";
    case RequirementState::not_shown: return "not shown";
  }
  return "";
}

AcceptanceRecord trace(const AcceptancePlan& plan, const std::vector<RecordedTest>& tests) {
  AcceptanceRecord record;
  record.accepted = true;
  for (const Requirement& requirement : plan.requirements) {
    record.requirements.push_back(traced(requirement, plan, tests));
    const TracedRequirement& result = record.requirements.back();
    record.accepted = record.accepted && (result.state == RequirementState::met || result.deviation != nullptr);
    if (const Deviation* agreed = agreed_deviation(plan, requirement.name); result.state == RequirementState::met && agreed != nullptr) {
      record.warnings.push_back("the deviation from " + requirement.name + " (" + agreed->text + ") is not needed: the requirement is met");
    }
  }
  for (const RecordedTest& test : tests) {
    for (const CheckResult& check : test.checks) {
      if (check.verdict != Verdict::fail) continue;
      const bool is_traced = std::any_of(plan.requirements.begin(), plan.requirements.end(), [&](const Requirement& requirement) {
        return shows(requirement, test.test.name, check.name);
      });
      if (!is_traced) record.findings.push_back({test.test.name, check.name, check.reason});
    }
  }
  record.accepted = record.accepted && record.findings.empty();
  return record;
}

Json record_json(const AcceptancePlan& plan, const AcceptanceRecord& record, const std::vector<RecordedTest>& tests, const RecordFacts& facts) {
  Json requirements = Json::array(), runs = Json::array(), findings = Json::array(), deviations = Json::array();
  for (const TracedRequirement& each : record.requirements) {
    Json shown_by = Json::array();
    for (const ShownBy& shown : each.requirement.shown_by) shown_by.push_back({{"test", shown.test}, {"check", shown.check}});
    requirements.push_back({{"name", each.requirement.name},
                            {"text", each.requirement.text},
                            {"source", each.requirement.source},
                            {"state", requirement_state_name(each.state)},
                            {"deviation", each.deviation == nullptr ? Json(nullptr) : Json(each.deviation->text)},
                            {"reasons", each.reasons},
                            {"shown_by", shown_by}});
  }
  for (const RecordedTest& each : tests) {
    Json checks = Json::array();
    for (const CheckResult& check : each.checks) checks.push_back(check_json(check));
    runs.push_back({{"name", each.test.name},
                    {"purpose", each.test.purpose},
                    {"case", each.is_failure_case ? "failure" : "normal operation"},
                    {"scenario", each.test.scenario.string()},
                    {"no_verdict", each.no_verdict},
                    {"configuration_hash", each.configuration_hash},
                    {"log_digest", each.log_digest},
                    {"seed", each.seed},
                    {"folder", each.folder},
                    {"command", each.command},
                    {"checks", checks}});
  }
  for (const Finding& each : record.findings) findings.push_back({{"test", each.test}, {"check", each.check}, {"reason", each.reason}});
  for (const Deviation& each : plan.deviations) {
    deviations.push_back({{"requirement", each.requirement}, {"text", each.text}, {"agreed_by", each.agreed_by}});
  }
  Json files = Json::array();
  for (const TestedFile& each : facts.files) files.push_back({{"of", each.of}, {"file", each.file}, {"sha256", each.sha256}});
  return {{"title", plan.title},
          {"system", plan.system},
          {"accepted", record.accepted},
          {"plan", {{"file", facts.plan_file}, {"digest", facts.plan_digest}}},
          {"limits", {{"file", facts.limits_file}, {"digest", facts.limits_digest}}},
          {"controller_command", facts.controller},
          {"plant_command", facts.plant},
          {"files", files},
          {"versions", facts.versions},
          {"time", facts.time},
          {"command", facts.command},
          {"requirements", requirements},
          {"tests", runs},
          {"deviations", deviations},
          {"findings", findings},
          {"warnings", record.warnings}};
}

std::string record_table(const AcceptanceRecord& record) {
  std::size_t widest = 0;
  for (const TracedRequirement& each : record.requirements) widest = std::max(widest, each.requirement.name.size());
  std::string text;
  for (const TracedRequirement& each : record.requirements) {
    text += fmt::format("{:<9} {:<{}} {}{}\n", requirement_state_name(each.state), each.requirement.name, widest, each.requirement.text,
                        each.deviation == nullptr ? "" : " (deviation agreed: " + each.deviation->text + ")");
    for (const std::string& reason : each.reasons) text += fmt::format("{:<9} {:<{}} {}\n", "", "", widest, reason);
  }
  for (const Finding& each : record.findings) text += fmt::format("finding   {}, {}: {}\n", each.test, each.check, each.reason);
  for (const std::string& each : record.warnings) text += fmt::format("warning   {}\n", each);
  return text;
}

std::string record_junit(const AcceptancePlan& plan, const AcceptanceRecord& record, const std::vector<RecordedTest>& tests) {
  std::vector<CheckResult> requirements;
  for (const TracedRequirement& each : record.requirements) {
    CheckResult result;
    result.name = each.requirement.name + " " + each.requirement.text;
    const bool agreed = each.deviation != nullptr;
    result.verdict = each.state == RequirementState::met ? Verdict::pass : agreed ? Verdict::not_applicable : Verdict::fail;
    result.reason = requirement_state_name(each.state);
    for (const std::string& reason : each.reasons) result.reason += "; " + reason;
    if (agreed) result.reason += "; agreed deviation: " + each.deviation->text;
    requirements.push_back(result);
  }
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  text += junit_suite(plan.title, requirements, {});
  for (const RecordedTest& each : tests) {
    text += junit_suite(each.test.name, counted_checks(record, each),
                        {{"scenario", each.test.scenario.string()},
                         {"configuration_hash", each.configuration_hash},
                         {"log_digest", each.log_digest},
                         {"seed", std::to_string(each.seed)},
                         {"command", each.command}});
  }
  return text + "</testsuites>\n";
}

}  // namespace slewlab::tools
