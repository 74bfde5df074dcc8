// A record says of each requirement what its checks said, and forgets no failed check.

#include "tools/acceptance/record.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/input_error.h"
#include "tests/msgs/temporary_folder.h"
#include "tools/acceptance/judgement.h"

namespace slewlab::tools {
namespace {

CheckResult check(const char* name, Verdict verdict) {
  CheckResult result;
  result.name = name;
  result.verdict = verdict;
  result.reason = std::string("reason of ") + name;
  result.measured = 2.0;
  result.limit = 1.0;
  result.unit = "s";
  return result;
}

AcceptancePlan plan_of(std::vector<ShownBy> shown_by) {
  AcceptancePlan plan;
  plan.title = "Test <of> a controller";
  plan.tests = {{"slew", "", "slew.yaml"}, {"stop", "", "stop.yaml"}};
  plan.requirements = {{"R1", "It turns.", "chosen", std::move(shown_by)}};
  return plan;
}

std::vector<RecordedTest> runs(std::vector<CheckResult> slew, std::vector<CheckResult> stop) {
  RecordedTest first, second;
  first.test.name = "slew";
  first.checks = std::move(slew);
  second.test.name = "stop";
  second.checks = std::move(stop);
  return {first, second};
}

TEST(AcceptanceRecord, IsMetWhereEveryCheckThatShowsItPassed) {
  const AcceptancePlan plan = plan_of({{"slew", "direction"}, {"stop", "stop time"}});
  const auto tests = runs({check("direction", Verdict::pass)}, {check("stop time", Verdict::pass), check("sidelead", Verdict::not_applicable)});
  const AcceptanceRecord record = trace(plan, tests);
  EXPECT_EQ(record.requirements.at(0).state, RequirementState::met);
  EXPECT_TRUE(record.requirements[0].reasons.empty());
  EXPECT_TRUE(record.findings.empty());
  EXPECT_TRUE(record.accepted);
}

TEST(AcceptanceRecord, WhatDoesNotApplyOrWasNotAskedForShowsNothing) {
  const AcceptancePlan plan = plan_of({{"slew", "direction"}, {"stop", "stop time"}});
  for (const auto& stop : {std::vector<CheckResult>{check("stop time", Verdict::not_applicable)}, std::vector<CheckResult>{}}) {
    const AcceptanceRecord record = trace(plan, runs({check("direction", Verdict::pass)}, stop));
    EXPECT_EQ(record.requirements.at(0).state, RequirementState::not_shown);
    EXPECT_EQ(record.requirements[0].reasons.size(), 1u);
    EXPECT_FALSE(record.accepted);
  }
}

TEST(AcceptanceRecord, AFailureWeighsMoreThanWhatIsNotShownInWhateverOrder) {
  const AcceptancePlan plan = plan_of({{"slew", "direction"}, {"stop", "stop time"}});
  for (const auto& [first, second] : {std::pair{Verdict::fail, Verdict::not_applicable}, std::pair{Verdict::not_applicable, Verdict::fail}}) {
    const AcceptanceRecord record = trace(plan, runs({check("direction", first)}, {check("stop time", second)}));
    EXPECT_EQ(record.requirements.at(0).state, RequirementState::not_met);
    EXPECT_FALSE(record.accepted);
  }
}

TEST(AcceptanceRecord, AFailedCheckThatNoRequirementNamesIsAFinding) {
  const AcceptancePlan plan = plan_of({{"slew", "direction"}});
  const AcceptanceRecord record = trace(plan, runs({check("direction", Verdict::pass)}, {check("stop time", Verdict::fail)}));
  EXPECT_EQ(record.requirements.at(0).state, RequirementState::met);
  ASSERT_EQ(record.findings.size(), 1u);
  EXPECT_EQ(record.findings[0].test, "stop");
  EXPECT_FALSE(record.accepted);
}

TEST(AcceptanceRecord, AnAgreedDeviationIsAcceptedAndTold) {
  AcceptancePlan plan = plan_of({{"slew", "direction"}});
  plan.deviations = {{"R1", "a spare part is on its way", "the owner"}};
  const auto tests = runs({check("direction", Verdict::fail)}, {});
  const AcceptanceRecord record = trace(plan, tests);
  EXPECT_EQ(record.requirements.at(0).state, RequirementState::not_met);
  EXPECT_TRUE(record.accepted);
  EXPECT_NE(record_table(record).find("a spare part is on its way"), std::string::npos);
  const std::string junit = record_junit(plan, record, tests);
  EXPECT_NE(junit.find("<skipped message=\"not met; slew, direction: reason of direction; agreed deviation: a spare part"), std::string::npos) << junit;
  EXPECT_NE(junit.find("Test &lt;of&gt; a controller"), std::string::npos);
}

TEST(AcceptanceRecord, InJunitAFailedCheckIsSkippedWhereEveryRequirementThatItShowsDeviatesAsAgreed) {
  AcceptancePlan plan = plan_of({{"slew", "direction"}});
  plan.deviations = {{"R1", "a spare part is on its way", "the owner"}};
  const auto tests = runs({check("direction", Verdict::fail)}, {check("stop time", Verdict::pass)});
  const std::string agreed = record_junit(plan, trace(plan, tests), tests);
  EXPECT_EQ(agreed.find("<failure"), std::string::npos) << agreed;
  EXPECT_NE(agreed.find("<testsuite name=\"slew\" tests=\"1\" failures=\"0\" errors=\"0\" skipped=\"1\">"), std::string::npos) << agreed;
  EXPECT_NE(agreed.find("<skipped message=\"failed: reason of direction; agreed deviation from R1: a spare part is on its way\"/>"), std::string::npos);

  plan.requirements.push_back({"R2", "It turns as asked.", "chosen", {{"slew", "direction"}}});
  const std::string half = record_junit(plan, trace(plan, tests), tests);
  EXPECT_NE(half.find("<testsuite name=\"slew\" tests=\"1\" failures=\"1\""), std::string::npos) << half;

  const auto found = runs({check("direction", Verdict::fail), check("sidelead", Verdict::fail)}, {});
  EXPECT_NE(record_junit(plan, trace(plan, found), found).find("<failure message=\"reason of sidelead\"/>"), std::string::npos);
}

TEST(AcceptanceRecord, ADeviationFromWhatIsMetIsTold) {
  AcceptancePlan plan = plan_of({{"slew", "direction"}});
  plan.deviations = {{"R1", "a spare part is on its way", "the owner"}};
  const auto tests = runs({check("direction", Verdict::pass)}, {});
  const AcceptanceRecord record = trace(plan, tests);
  EXPECT_TRUE(record.accepted);
  EXPECT_EQ(record.requirements.at(0).deviation, nullptr);
  const std::string said = "the deviation from R1 (a spare part is on its way) is not needed: the requirement is met";
  EXPECT_EQ(record.warnings, std::vector<std::string>{said});
  EXPECT_NE(record_table(record).find("warning   " + said), std::string::npos);
  EXPECT_EQ(record_json(plan, record, tests, {})["warnings"][0], said);
}

TEST(AcceptanceRecord, JunitAndJsonNameRunHashSeedAndCommand) {
  const AcceptancePlan plan = plan_of({{"slew", "direction"}});
  auto tests = runs({check("direction", Verdict::pass)}, {});
  tests[0].configuration_hash = "0123456789abcdef";
  tests[0].log_digest = "fedcba9876543210";
  tests[0].seed = 7;
  tests[0].command = "slewlab accept slew.yaml";
  const AcceptanceRecord record = trace(plan, tests);
  const std::string junit = record_junit(plan, record, tests);
  for (const char* text : {"\"0123456789abcdef\"", "\"fedcba9876543210\"", "name=\"seed\" value=\"7\"", "\"slewlab accept slew.yaml\""}) {
    EXPECT_NE(junit.find(text), std::string::npos) << text << " in " << junit;
  }
  const auto json = record_json(plan, record, tests, {});
  EXPECT_EQ(json["tests"][0]["log_digest"], "fedcba9876543210");
  EXPECT_EQ(json["requirements"][0]["shown_by"][0]["check"], "direction");
}

TEST(AcceptancePlan, TheShippedOneUsesEveryShippedRunForARequirement) {
  const AcceptancePlan plan = load_acceptance_plan(SLEWLAB_SOURCE_DIR "/config/acceptance_plans/thesis.yaml");
  std::size_t faults = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SLEWLAB_SOURCE_DIR "/config/scenarios/faults")) {
    faults += entry.path().extension() == ".yaml" ? 1 : 0;
  }
  EXPECT_EQ(plan.tests.size(), 4 + faults);
  for (const PlannedTest& test : plan.tests) {
    bool used = false;
    for (const Requirement& requirement : plan.requirements) {
      for (const ShownBy& shown : requirement.shown_by) used = used || shown.test == test.name;
    }
    EXPECT_TRUE(used) << test.name << " shows nothing";
  }
}

TEST(AcceptancePlan, WhatIsWrongIsToldAtItsLine) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "plan.yaml";
  const auto said = [&](const std::string& shown_by, const std::string& more) {
    std::ofstream(file) << "kind: acceptance_plan\ntitle: t\nsystem: s\nlimits: " SLEWLAB_SOURCE_DIR "/config/acceptance/thesis.yaml\n"
                        << "tests:\n  - {name: slew, purpose: p, scenario: " SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml}\n"
                        << "requirements:\n  - name: R1\n    text: t\n    source: s\n    shown_by: [" << shown_by << "]\n" << more;
    try {
      load_acceptance_plan(file);
    } catch (const common::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(said("{test: slew, check: direction}", ""), "");
  EXPECT_NE(said("{test: slow, check: direction}", "").find("plan.yaml:11:23: key 'requirements.0.shown_by.0.test': found slow, expected 'slew'"), std::string::npos)
      << said("{test: slow, check: direction}", "");
  EXPECT_NE(said("{test: slew, check: sidelad}", "").find("'sidelead'"), std::string::npos);
  EXPECT_NE(said("", "").find("found nothing, expected at least one"), std::string::npos);
  EXPECT_NE(said("{test: slew, check: direction}", "deviations: [{requirement: R2, text: t, agreed_by: a}]\n").find("'R1'"), std::string::npos);
}

// The harbour crane turns at 1.2 rpm with motors of 120 N m, the thesis's at 0.05 rad/s with 250 N m (config/cranes).
TEST(AcceptanceRecord, LimitsOfAnotherMachineAreKnownByItsSpeedAndTorque) {
  const std::string config = SLEWLAB_SOURCE_DIR "/config/";
  const sim::Scenario thesis = sim::load_scenario_file(config + "scenarios/thesis_slew.yaml");
  EXPECT_EQ(why_of_another_machine(thesis, load_acceptance_limits(config + "acceptance/thesis.yaml")), "");
  EXPECT_EQ(why_of_another_machine(thesis, load_acceptance_limits(config + "acceptance/harbour_5t.yaml")),
            "the limits are for a machine of 0.126 rad/s and 120 N m per motor (top_speed, motor_torque_rated); this one has 0.05 rad/s and 250 N m per motor");
  sim::Scenario unknown = thesis;
  unknown.crane.parameters.drive.top_speed = unknown.crane.parameters.drive.rated_torque = 0.0;
  EXPECT_EQ(why_of_another_machine(unknown, load_acceptance_limits(config + "acceptance/harbour_5t.yaml")), "");
}

// Noise on the encoders counts until another fault begins.
TEST(AcceptanceRecord, NoiseOnTheEncodersIsThatOfTheScenario) {
  sim::Scenario scenario;
  scenario.controller_period = 5'000'000;
  EXPECT_FALSE(accepted_machine(scenario).encoder_noise);
  scenario.faults = {{.kind = sim::FaultKind::encoder_noisy, .from = 2'000'000'000, .until = 30'000'000'000},
                     {.kind = sim::FaultKind::message_lost, .from = 20'000'000'000}};
  const AcceptedMachine machine = accepted_machine(scenario);
  ASSERT_TRUE(machine.encoder_noise);
  EXPECT_EQ(machine.encoder_noise->from, 2.0);
  EXPECT_EQ(machine.encoder_noise->until, 20.0);
  EXPECT_EQ(machine.controller_period, 0.005);
}

}  // namespace
}  // namespace slewlab::tools
