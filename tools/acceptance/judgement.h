#pragma once

// The verdict on a run's log: may it be judged, the checks (checks.h), and what the scenario itself says under `expect:`.

#include <filesystem>
#include <string>
#include <vector>

#include "sim/drive/scenario_file.h"
#include "tools/acceptance/checks.h"
#include "tools/acceptance/limits.h"

namespace slewlab::tools {

struct Judgement {
  std::vector<CheckResult> checks;
  AcceptedMachine machine;
  std::string no_verdict;            // why there is none; empty where there is one
  std::vector<std::string> remarks;  // what of the log could not be used
};

// What tells that the limits are another machine's, by its top speed and its motors' rated torque; empty where nothing does.
std::string why_of_another_machine(const sim::Scenario& scenario, const AcceptanceLimits& limits);

AcceptedMachine accepted_machine(const sim::Scenario& scenario);

// A check that fails by itself, without a limit: "run", "log".
CheckResult failed_check(const char* name, const std::string& reason);

// What is known of a log beside its messages.
struct LogOrigin {
  std::string written_digest{};  // that the run told of the log that it wrote; empty where nothing tells
  bool of_own_plant = false;     // the plant was none of slewlab's, and may leave telemetry out
};

// Another log than the one that was written is no evidence; where nothing tells which was, the log has to be whole by itself
// (whole_record.h). Throws msgs::LogError where the log cannot be read.
Judgement judge_log(const sim::Scenario& scenario, const std::filesystem::path& log, const AcceptanceLimits& limits, const LogOrigin& origin = {});

}  // namespace slewlab::tools
