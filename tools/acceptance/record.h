#pragma once

// The record of an acceptance test by a plan (plan.h): which requirement each run showed, and which not.
//
// A requirement is met where every check that shows it passed; not shown where one of them did not apply or its run gave no
// verdict; not met where one failed. A failed check that no requirement names is a finding all the same. The record is
// accepted where every requirement is met, or deviates as was agreed, and there is no other finding.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/acceptance/checks.h"
#include "tools/acceptance/plan.h"

namespace slewlab::tools {

enum class RequirementState { met, not_met, not_shown };
const char* requirement_state_name(RequirementState state);  // "met", "not met", "not shown"

// What a run of the plan was and what came of it.
struct RecordedTest {
  PlannedTest test;
  bool is_failure_case = false;  // the scenario has faults on purpose
  std::vector<CheckResult> checks;
  std::string no_verdict;
  std::string warning;  // what has to be known of the verdict; mostly empty
  std::string configuration_hash;
  std::string log_digest;
  std::int64_t seed = 0;
  std::string command;  // that makes this run again
  std::string folder;   // of the run, relative to the record
};

struct TracedRequirement {
  Requirement requirement;
  RequirementState state = RequirementState::not_shown;
  std::vector<std::string> reasons;  // a line for each check that did not pass
  const Deviation* deviation = nullptr;  // agreed upon
};

struct Finding {
  std::string test, check, reason;
};

struct AcceptanceRecord {
  std::vector<TracedRequirement> requirements;
  std::vector<Finding> findings;  // failed checks that no requirement names
  std::vector<std::string> warnings;  // what an inspector has to know and does not count: a deviation for what is met
  bool accepted = false;
};

// `tests` in the plan's order.
AcceptanceRecord trace(const AcceptancePlan& plan, const std::vector<RecordedTest>& tests);

// A file that took part in the test: of the controller or of the plant.
struct TestedFile {
  std::string of, file, sha256;
};

// What identifies program, configuration and time of a record.
struct RecordFacts {
  std::string plan_file, plan_digest, limits_file, limits_digest;
  std::string controller, plant;  // in words: the command, or the FMU
  std::vector<TestedFile> files;  // that these two name
  std::string versions;  // a line each
  std::string time;      // UTC
  std::string command;   // that makes the whole record again
};

nlohmann::ordered_json record_json(const AcceptancePlan& plan, const AcceptanceRecord& record, const std::vector<RecordedTest>& tests,
                                   const RecordFacts& facts);

// A line per requirement, with why it is not met, and one per finding.
std::string record_table(const AcceptanceRecord& record);

// JUnit XML: a suite for the requirements and one for each test. A failed check counts as skipped, with the deviations' texts, where
// every requirement that it shows has an agreed deviation, so that an accepted record has no failures.
std::string record_junit(const AcceptancePlan& plan, const AcceptanceRecord& record, const std::vector<RecordedTest>& tests);

}  // namespace slewlab::tools
